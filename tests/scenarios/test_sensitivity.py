"""Sensitivity of the posture solver to its tuned numbers: which there are, how one is changed, and what the table says."""

import shutil
from pathlib import Path

import pytest

from scenarios import sensitivity
from scenarios.sensitivity import FIGURES, ROOT, Number, changed, main, numbers, told, write_changed


def test_settings_and_constants_are_found_where_they_stand() -> None:
    found = {(number.path, number.name): number for number in numbers()}
    steps = found["avatarsim/settings.py", "steps"]
    assert steps.whole and steps.value == 2
    radius = found["avatarsim/ik/objective.py", "LOSS_RADIUS"]
    line = (ROOT / radius.path).read_text(encoding="utf-8").split("\n")[radius.line]
    assert float(line[radius.first : radius.last]) == radius.value
    # of one line with several names each has its own place
    sweeps = [found["avatarsim/ik/qp.py", name] for name in ("FIRST_SWEEPS", "SWEEPS_MOST")]
    assert sweeps[0].line == sweeps[1].line and sweeps[0].last < sweeps[1].first


def test_what_counts_changes_by_one_at_least() -> None:
    assert changed(Number("", "n", 2, 0, 0, 1), 0.8) == 1 and changed(Number("", "n", 2, 0, 0, 1), 1.2) == 3
    assert changed(Number("", "n", 100, 0, 0, 1), 1.2) == 120
    assert changed(Number("", "x", 0.5, 0, 0, 1), 1.2) == pytest.approx(0.6)


def test_every_number_can_be_changed_in_a_copy_and_nothing_else_is(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "avatarsim", tmp_path / "avatarsim", ignore=shutil.ignore_patterns("__pycache__"))
    for number in numbers():
        before = (tmp_path / number.path).read_text(encoding="utf-8")
        write_changed(tmp_path, number, changed(number, 1.2))
        after = (tmp_path / number.path).read_text(encoding="utf-8")
        differing = [k for k, (a, b) in enumerate(zip(before.split("\n"), after.split("\n"), strict=True)) if a != b]
        assert differing == [number.line]
        compile(after, number.path, "exec")
        (tmp_path / number.path).write_text(before, encoding="utf-8")


def test_changes_are_told_in_percent_of_what_was(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    base = dict.fromkeys(FIGURES, 2.0)
    assert told({**base, "chatter": 3.0}, base).split(" | ")[0] == "+50"
    assert told({**base, "chatter": 0.25}, {**base, "chatter": 0.0}).split(" | ")[0] == "0.25"
    seen: list[tuple[str, float] | None] = []

    def figures(change: tuple[Number, float] | None, words: object, kernels: object) -> dict[str, float]:
        seen.append(None if change is None else (change[0].name, change[1]))
        return dict.fromkeys(FIGURES, 1.0 if change is None else 1.5)

    monkeypatch.setattr(sensitivity, "measured", figures)
    assert main(["--only", "steps", "--seed", "1"]) == 0
    assert seen[0] is None and seen[2:] == [("steps", 1), ("steps", 3)]
    rows = capsys.readouterr().out.splitlines()
    assert rows[-1].startswith("| steps | 2 to 3 | +50 | +50")


def test_a_number_that_is_not_there_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--only", "luck"]) == 2
    assert "luck" in capsys.readouterr().err
    assert main(["--seeds", "0"]) == 2
    assert main(["--list", "--only", "steps"]) == 0
    assert "1 numbers, 1 of them settings" in capsys.readouterr().out
