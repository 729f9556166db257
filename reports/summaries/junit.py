"""`junit.xml`: a test case per check of the gated engine, and one for each run without figures."""

from typing import Any
from xml.etree import ElementTree

import pandas as pd

from reports.tables.checks import Checks
from reports.tables.figures import quantity

WAIVED = "waived"


def junit(checks: Checks) -> str:
    """Return the document. Failed checks are failures, crashes errors; waived and missing ones are skipped."""
    suite = ElementTree.Element("testsuite", {"name": "avatarsim"})
    for rows, kind, status in (
        (checks.passed, "", "pass"), (checks.waived, "skipped", WAIVED), (checks.failed, "failure", "fail"),
        (checks.crashed, "error", "crashed"), (checks.unmeasured, "skipped", "not measured"), (checks.refused, "", "refused"),
    ):
        for row in rows.itertuples():
            _case(suite, row, kind, status)
    for name, part in (("tests", "."), ("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(name, str(len(suite.findall(f"testcase/{part}"))))
    ElementTree.indent(suite)
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"


def _case(suite: ElementTree.Element, row: Any, kind: str, status: str) -> None:
    metric, limit = row.metric, row.waiver if pd.notna(row.waiver) else row.bound
    within = f" <= {quantity(limit, row.unit)}" if pd.notna(limit) else ""
    name = f"{metric}{within} (seed {row.seed})"
    case = ElementTree.SubElement(suite, "testcase", {"classname": f"{row.scenario}.{row.run}", "name": name})
    if status == WAIVED:
        case.set("status", WAIVED)
    if kind:
        figure = f"{metric} is {quantity(row.value, row.unit)}, limit {quantity(row.bound, row.unit)}"
        text = f"{status}: {figure if pd.notna(row.bound) else row.note}"
        ElementTree.SubElement(case, kind, {"message": text})
