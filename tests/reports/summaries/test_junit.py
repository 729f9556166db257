"""One test case per bound of the gate; what crashed is an error, what was not measured is skipped."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

from reports.deciding.verdict import verdict
from reports.reading.load import load
from reports.summaries.junit import junit

Json = dict[str, object]
Write = Callable[[object], Path]


def test_cases_and_counts(run_dir: Write, results: Json) -> None:
    suite = ElementTree.fromstring(junit(verdict(load(run_dir(results)))))
    assert suite.attrib == {"name": "avatarsim", "tests": "5", "failures": "1", "errors": "1", "skipped": "2"}
    outcomes = {case.attrib["classname"]: [part.tag for part in case] for case in suite}
    assert outcomes == {
        "arm_wall.avatarsim/default": [], "hand_over_table.avatarsim/default": ["skipped"],
        "ball_drop.avatarsim/default": ["failure"], "ball_drop.mujoco/default": ["error"], "ball_drop.mujoco/tuned": ["skipped"],
    }
    assert {case.attrib["classname"]: case.attrib["status"] for case in suite if "status" in case.attrib} == {
        "hand_over_table.avatarsim/default": "waived"}
    messages = [part.attrib["message"] for part in suite.iter() if part.tag in ("failure", "error", "skipped")]
    assert messages[0].startswith("waived: residual_overlap_max") and messages[1:] == [
        "restitution_error_max is 0.3, limit 0.01: pair wood-metal", "crashed: ValueError: <mesh> & volume",
        "not-measured: not installed",
    ]


def test_control_characters_do_not_break_the_document(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    noisy = [row | {"note": "\x1b[31mred\x00 \ud800" if row["status"] == "crashed" else ""} for row in rows]
    text = junit(verdict(load(run_dir(results | {"rows": noisy}))))
    assert "[31mred" in next(e.attrib["message"] for e in ElementTree.fromstring(text).iter("error"))
    text.encode()


def test_nothing_measured_gives_an_empty_suite(run_dir: Write, results: Json) -> None:
    suite = ElementTree.fromstring(junit(verdict(replace(load(run_dir(results)), rows=()))))
    assert suite.attrib["tests"] == "0" and len(suite) == 0
