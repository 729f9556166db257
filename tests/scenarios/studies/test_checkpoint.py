"""Checkpoints: results survive, an incomplete line is computed again, results of other sources are dropped."""

import json
import math
from pathlib import Path

import pytest

from scenarios.job import Job
from scenarios.studies.checkpoint import Checkpoint, key_of


def test_answers_are_kept_and_a_torn_line_is_asked_again(tmp_path: Path) -> None:
    path = tmp_path / "study.jsonl"
    kept = Checkpoint(path, "stamp")
    kept.put("one", {"state": "measured", "values": {"a": 1.5}})
    kept.put("other", {"state": "measured", "values": {"a": math.nan}})
    again = Checkpoint(path, "stamp")
    assert again.get("one") == kept.get("one") and math.isnan(float(again.known["other"]["values"]["a"]))
    path.write_text(path.read_text()[:-20])
    torn = Checkpoint(path, "stamp")
    assert torn.get("one") and torn.get("other") is None
    whole = path.read_bytes()
    path.write_bytes(whole + b"\xff\n" + b"[" * 100_000 + b"\n")
    assert list(Checkpoint(path, "stamp").known) == ["one"] and path.read_bytes() == whole
    assert not Checkpoint(path, "other sources").known and path.read_text() == ""


@pytest.mark.parametrize("line", ["3", "[]", '{"stamp": "stamp"}', '{"stamp": "stamp", "key": "k", "check": "", "answer": {}}'])
def test_a_line_that_holds_something_else_is_asked_again(tmp_path: Path, line: str) -> None:
    path = tmp_path / "study.jsonl"
    path.write_text(line + "\n")
    assert not Checkpoint(path, "stamp").known


def test_without_a_file_it_is_kept_in_memory(tmp_path: Path) -> None:
    kept = Checkpoint()
    kept.put("one", {"a": 1})
    assert kept.get("one") == {"a": 1} and list(tmp_path.iterdir()) == []


def test_a_key_depends_on_every_part() -> None:
    job = Job("stack_ten", "mujoco", "tuned", options={"dt": 0.001})
    keys = {key_of("a", job), key_of("b", job), key_of("a", job, 240), key_of("a", Job("stack_ten", "mujoco", "tuned"))}
    assert len(keys) == 4 and key_of("a", job) == key_of("a", json.loads(json.dumps(vars(job))))
