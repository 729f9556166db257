"""A document for CI has one case per check and the counts of the table of checks."""

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from xml.etree import ElementTree

from hypothesis import given, settings
from hypothesis import strategies as st

from reports.summaries.junit import junit
from reports.tables.checks import checks
from reports.tables.run import read
from runfiles.table import Row, Status
from tests.reports.small_runs import MUJOCO, OURS, OVERLAP, figure, run_of

Json = dict[str, object]
Write = Callable[[object], Path]
STATUSES = ("pass", "waived", "fail", "crashed", "not-measured", "refused", "info")
TAGS = {"failures": "failure", "errors": "error", "skipped": "skipped"}


def some(status: Status, k: int, note: str = "") -> Row:
    """Return a row of each status."""
    value = {"pass": 0.5, "waived": 1.5, "fail": 9.0, "info": 0.0}.get(status)
    bound, ceiling = (1.0, 2.0) if status in ("pass", "waived", "fail") else (None, None)
    metric = OVERLAP if value is not None else "run"
    run = MUJOCO if k % 3 == 2 and status == "crashed" else OURS
    return figure(f"s{k}", run, metric, value, status, bound, ceiling, note=note)


@given(st.lists(st.sampled_from(STATUSES), min_size=1, max_size=12))
def test_counts_are_those_of_the_checks(statuses: Sequence[Status]) -> None:
    found = checks(run_of([some(status, k) for k, status in enumerate(statuses)]))
    suite = ElementTree.fromstring(junit(found))
    parts = Counter(part.tag for case in suite for part in case)
    assert {name: int(suite.attrib[name]) for name in TAGS} == {name: parts[tag] for name, tag in TAGS.items()}
    assert int(suite.attrib["failures"]) == len(found.failed) and int(suite.attrib["errors"]) == len(found.crashed)
    assert int(suite.attrib["skipped"]) == len(found.waived) + len(found.unmeasured)
    others = sum(len(part) for part in (found.crashed, found.unmeasured, found.refused))
    assert int(suite.attrib["tests"]) == len(suite) == found.total + others


def test_each_case_is_named_by_its_scene_and_run() -> None:
    suite = ElementTree.fromstring(junit(checks(run_of([some("pass", 0), some("fail", 1), some("crashed", 2)]))))
    outcomes = {case.attrib["classname"]: [part.tag for part in case] for case in suite}
    assert outcomes == {f"s0.{OURS}": [], f"s1.{OURS}": ["failure"], f"s2.{MUJOCO}": ["error"], f"s2.{OURS}": ["skipped"]}


@settings(max_examples=30)
@given(st.text(alphabet=st.characters(blacklist_categories=("Cs", "Cc")), max_size=60))
def test_notes_of_any_text_leave_well_formed_xml(note: str) -> None:
    suite = ElementTree.fromstring(junit(checks(run_of([some("crashed", 0, note)]))))
    [part] = suite.iter("error")
    assert part.attrib["message"].endswith(note)


def test_signs_that_xml_forbids_are_gone_once_a_run_is_read(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    note = "\x00\x1b[31m\ud800\ufffe red"
    changed = [{**one, "note": note} if one["status"] in ("crashed", "fail") else one for one in rows]
    suite = ElementTree.fromstring(junit(checks(read(run_dir(results | {"rows": changed})))))
    assert any("red" in part.attrib["message"] for part in suite.iter("error"))
