"""The command that holds the first frame after `load` against the median frame."""

import json
from dataclasses import asdict, replace

import pytest

from scenarios import first_frame
from scenarios.first_frame import Found, alone, main, measured, table

GOOD = Found("ball_drop", "default", 0.5, 30.0, 20.0, 6.0, 0)


def test_a_scene_is_run_in_a_process_of_its_own() -> None:
    found = alone("ball_drop", "default", 20)
    assert isinstance(found, Found) and (found.scene, found.preset, found.late) == ("ball_drop", "default", 0)
    assert found.load > 0.0 < found.median and found.warm > 0.0 and found.times == found.first / found.median


def test_a_scene_whose_start_is_refused_has_no_first_frame() -> None:
    assert measured("start_inside", "default", 3) is None


def test_a_scene_that_cannot_run_is_named() -> None:
    assert "preset of engine avatarsim is 'printed'" in str(alone("ball_drop", "printed", 3))


@pytest.mark.parametrize(("found", "code"), [
    (GOOD, 0), (replace(GOOD, first=60.0), 0), (replace(GOOD, first=60.1), 1), (replace(GOOD, late=1), 1),
    (replace(GOOD, first=float("nan")), 1), (replace(GOOD, first=100.0, warm=50.0), 0),
    (replace(GOOD, first=100.0, warm=49.0), 1), (replace(GOOD, first=100.0, warm=90.0, late=1), 1),
])
def test_what_is_left_for_the_first_frame_is_a_fault(
    found: Found, code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(first_frame, "alone", lambda scene, preset, frames: found)
    assert main(["--filter", "ball_drop"]) == code
    assert f"in {code} the first frame loads something" in capsys.readouterr().out


def test_a_long_first_frame_is_asked_again_and_a_kernel_that_came_late_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    answers = ["[60.5, 0]", "[40.0, 0]", "[70.0, 1]", "[1.0, 0]"]

    class Ended:
        returncode, stderr = 0, ""

        def __init__(self, command: list[str], **options: object) -> None:
            first, late = json.loads(answers.pop(0))
            self.stdout = json.dumps(asdict(replace(GOOD, first=first, late=late)))

    monkeypatch.setattr("subprocess.run", Ended)
    again, late = alone("s", "default", 3), alone("s", "default", 3)
    assert isinstance(again, Found) and isinstance(late, Found)
    assert again.first == 40.0 and late.late == 1 and not late.good


@pytest.mark.parametrize(("said", "code"), [(first_frame.REFUSED, 0), ("ImportError: no such data", 3)])
def test_a_scene_without_a_first_frame_is_refused_or_lost(said: str, code: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(first_frame, "alone", lambda scene, preset, frames: said)
    assert main(["--filter", "ball_drop"]) == code


def test_the_worst_come_first() -> None:
    lines = table([GOOD, replace(GOOD, scene="slow", first=600.0), replace(GOOD, scene="late", late=2)]).splitlines()
    assert [line.split()[0] for line in lines[1:]] == ["late", "slow", "ball_drop"]


def test_patterns_and_frames_that_mean_nothing_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--filter", "no_such_scene"]) == 2 and main(["--frames", "1"]) == 2
    assert "--frames is 1" in capsys.readouterr().err
