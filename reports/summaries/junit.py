"""`junit.xml`: one test case per scene and bound of the gate, and one for each run that crashed or was not measured."""

from xml.etree import ElementTree

from reports.deciding.verdict import Verdict
from reports.reading.load import Row
from reports.words.wording import limit, quantity


def junit(verdict: Verdict) -> str:
    """The document as text. Failed bounds are failures, crashes errors, what was not measured or cannot be said skipped."""
    outcomes = (
        *(("", row) for row in verdict.held), *(("system-out", row) for row in verdict.ceiling),
        *(("failure", row) for row in verdict.failed),
        *(("error", row) for row in verdict.crashed), *(("skipped", row) for row in verdict.unmeasured),
        *(("" if row.status == "refused" else "skipped", row) for row in verdict.neutral),
    )
    suite = ElementTree.Element("testsuite", {
        "name": "avatarsim", "tests": str(len(outcomes)),
        **{f"{kind}{'' if kind == 'skipped' else 's'}": str(sum(kind == outcome for outcome, _ in outcomes))
           for kind in ("failure", "error", "skipped")},
    })
    for kind, row in outcomes:
        case = ElementTree.SubElement(suite, "testcase", {"classname": f"{row.scenario}.{row.run}", "name": _name(row)})
        if kind == "system-out":
            ElementTree.SubElement(case, kind).text = f"above the bound {limit(row.bound, row.unit)}, within the ceiling"
        elif kind:
            ElementTree.SubElement(case, kind, {"message": _message(row)})
    ElementTree.indent(suite)
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"


def _name(row: Row) -> str:
    name = row.metric or "run"
    return f"{name} <= {limit(row.limit, row.unit)} (seed {row.seed})" if row.limit is not None else f"{name} (seed {row.seed})"


def _message(row: Row) -> str:
    if row.status in ("pass", "fail"):
        text = f"{row.metric} is {quantity(row.value, row.unit)}, limit {limit(row.limit, row.unit)}"
    else:
        text = row.status
    return f"{text}: {row.note}" if row.note else text
