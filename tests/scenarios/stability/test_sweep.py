"""The sweep: what is finished is kept, a torn line is asked again, the table says what was lost."""

import json
import math
from pathlib import Path

import pytest

from avatarsim.running.processes import Died
from runfiles.csv_rows import csv_text
from scenarios.__main__ import main as scenarios_main
from scenarios.stability import __main__ as command
from scenarios.stability import side_by_side
from scenarios.stability.finished import NAME, Finished, key_of
from scenarios.stability.outcome import ABSENT, CRASHED, NOT_A_NUMBER, SILENT, SURVIVED, TOO_LATE, Outcome, Task
from scenarios.stability.plan import Trial
from scenarios.stability.rows import LONG, Row, apart, rows, table
from scenarios.stability.rows import NAME as ROWS
from scenarios.stability.variation import Variation

PLAIN, START = Trial("plain", "as it is", Variation()), Trial("start", "1e-09 m", Variation(start=1e-9))
ONE, OTHER = (Task("stack_ten", 0.2, "avatarsim", "default", trial) for trial in (PLAIN, START))


def done(state: str = SURVIVED, x: float = 0.0, **figures: object) -> Outcome:
    return Outcome(**{"state": state, "frames": 12, "overlap": 1e-7, "energy": 0.0, "end": ((x, 0.0, 0.0),), **figures})


def test_what_is_finished_is_kept_and_a_torn_line_asked_again(tmp_path: Path) -> None:
    path = tmp_path / NAME
    kept = Finished(path, "stamp")
    kept.add(ONE, done())
    kept.add(OTHER, done(overlap=math.nan))
    again = Finished(path, "stamp")
    assert again.missing([ONE, OTHER]) == [] and math.isnan(again.of(OTHER).overlap)
    path.write_text(path.read_text()[:-20])
    torn = Finished(path, "stamp")
    assert torn.missing([ONE, OTHER]) == [OTHER]
    torn.add(OTHER, done())
    assert Finished(path, "stamp").missing([ONE, OTHER]) == []
    whole = path.read_bytes()
    path.write_bytes(whole + b"\xff\n" + b"[" * 100_000 + b"\n")
    assert Finished(path, "stamp").missing([ONE, OTHER]) == [] and path.read_bytes() == whole
    # what other sources made is neither believed nor kept
    assert Finished(path, "other sources").missing([ONE, OTHER]) == [ONE, OTHER] and path.read_text() == ""


def test_what_may_be_the_machines_fault_is_asked_again(tmp_path: Path) -> None:
    kept = Finished(tmp_path / NAME, "stamp")
    kept.add(ONE, done(TOO_LATE))
    kept.add(OTHER, done(ABSENT))
    assert kept.of(ONE).state == TOO_LATE and kept.missing([ONE, OTHER]) == []
    assert Finished(tmp_path / NAME, "stamp").missing([ONE, OTHER]) == [ONE, OTHER]


def test_rows_go_to_the_last_run_or_beside_what_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command, "OUT", tmp_path)
    assert command.run_of(None) == tmp_path / command.KEPT.name and command.run_of(tmp_path / "asked") == tmp_path / "asked"
    (tmp_path / "latest").mkdir()
    assert command.run_of(None) == tmp_path / "latest"


def test_rows_say_how_far_an_end_is_from_the_plain_one() -> None:
    found = rows({ONE: done(), OTHER: done(x=0.25)}, LONG)
    assert [row.moved for row in found] == [0.0, 0.25] and found[1].start == 1e-9
    assert math.isnan(apart(done(), None)) and math.isnan(apart(Outcome(CRASHED), done()))
    line = csv_text(found, Row).splitlines()[1]
    assert line.startswith("stack_ten,avatarsim/default,plain,as it is,0,0,0,0.0166667,1,0,survived,12,1e-07")


def test_the_table_counts_what_was_lost_and_leaves_out_who_was_not_asked() -> None:
    bad = Task("painleve", 0.2, "avatarsim", "default", START)
    quiet = Task("tumbling_box", 0.2, "avatarsim", "default", START)
    found = rows({ONE: done(), OTHER: done(x=0.25), bad: Outcome(NOT_A_NUMBER, 3, bad=2), quiet: Outcome(SILENT)}, LONG)
    [line] = [line for line in table(found).splitlines() if " start " in line]
    assert line.split() == ["avatarsim/default", "start", "1/2", "1", "1e-07", "0", "0.25", "0.25"]


def test_the_command_goes_on_where_it_was_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Task] = []

    def outcome(task: Task) -> Outcome:
        asked.append(task)
        if len(asked) == 3:
            raise KeyboardInterrupt
        return done()

    monkeypatch.setattr(side_by_side, "outcome", outcome)
    folders = ["--run", str(tmp_path), "--kept", str(tmp_path)]
    words = [*folders, "--engine", "avatarsim", "--filter", "stack_ten", "--draws", "0", "--jobs", "0"]
    assert command.main(words) == 130
    assert len((tmp_path / NAME).read_text().splitlines()) == 2
    assert command.main(words) == 0
    lines = (tmp_path / ROWS).read_text().splitlines()
    # the third was asked twice, and no other
    assert len(asked) == len(set(asked)) + 1 == len(lines)
    assert command.main(words) == 0 and len(asked) == len(lines)
    assert command.main([*words[:-1], "-1"]) == 2 and command.main([*words, "--engine", "abacus"]) == 2
    assert scenarios_main(["stability", *words, "--filter", "nothing"]) == 5


def test_a_process_that_dies_costs_its_trial_only(site: Path) -> None:
    tasks = [Task("stack_ten", 0.1, engine, "default", trial) for trial in (PLAIN, START) for engine in ("frozen", "dies")]
    found = [(task.engine, end.state, end.note) for task, end in side_by_side.answers(tasks, 1)]
    assert sorted(found) == [("dies", CRASHED, "its process was killed by signal 9")] * 2 + [("frozen", SURVIVED, "")] * 2
    assert side_by_side.died(Died("no answer within 3 s")).state == TOO_LATE


@pytest.mark.parametrize("changed", [{"end": [[10**400]]}, {"frames": "36"}, {"note": None}, {"end": 3}, {"state": ["survived"]}])
def test_a_line_that_holds_something_else_is_asked_again(tmp_path: Path, changed: dict[str, object]) -> None:
    path = tmp_path / NAME
    path.write_text(json.dumps({"stamp": "stamp", "key": key_of(ONE), "outcome": Outcome("survived", 36).as_json() | changed}))
    assert Finished(path, "stamp").missing([ONE]) == [ONE] and path.read_text() == ""
