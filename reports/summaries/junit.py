"""`junit.xml`: one test case per scene and bound of the gate, and one for each run that crashed or was not measured."""

from xml.etree import ElementTree

from reports.deciding.verdict import WAIVED, Verdict
from reports.reading.load import Row
from reports.words.wording import limit, quantity


def junit(verdict: Verdict) -> str:
    """The document as text. Failed checks are failures, crashes errors; skipped is what was waived, not measured, or cannot be
    said. A waived check has the status `waived`, and its message says so."""
    outcomes = (
        *(("", row.status, row) for row in verdict.passed), *(("skipped", WAIVED, row) for row in verdict.waived),
        *(("failure", row.status, row) for row in verdict.failed),
        *(("error", row.status, row) for row in verdict.crashed), *(("skipped", row.status, row) for row in verdict.unmeasured),
        *(("" if row.status == "refused" else "skipped", row.status, row) for row in verdict.neutral),
    )
    suite = ElementTree.Element("testsuite", {
        "name": "avatarsim", "tests": str(len(outcomes)),
        **{f"{kind}{'' if kind == 'skipped' else 's'}": str(sum(kind == outcome for outcome, *_ in outcomes))
           for kind in ("failure", "error", "skipped")},
    })
    for kind, status, row in outcomes:
        case = ElementTree.SubElement(suite, "testcase", {"classname": f"{row.scenario}.{row.run}", "name": _name(row)})
        if status == WAIVED:
            case.set("status", WAIVED)
        if kind:
            ElementTree.SubElement(case, kind, {"message": _message(row, status)})
    ElementTree.indent(suite)
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"


def _name(row: Row) -> str:
    name = row.metric or "run"
    return f"{name} <= {limit(row.limit, row.unit)} (seed {row.seed})" if row.limit is not None else f"{name} (seed {row.seed})"


def _message(row: Row, status: str) -> str:
    text = status
    if status in ("pass", "fail"):
        text = f"{row.metric} is {quantity(row.value, row.unit)}, limit {limit(row.limit, row.unit)}"
    elif status == WAIVED:
        return (f"{WAIVED}: {row.metric} is {quantity(row.value, row.unit)}, bound {limit(row.bound, row.unit)}, waived up to "
                f"{limit(row.limit, row.unit)}")
    return f"{text}: {row.note}" if row.note else text
