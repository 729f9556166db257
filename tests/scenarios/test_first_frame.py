"""The command that holds the first frame after `load` against the median frame."""

import json
from dataclasses import asdict, replace

import pytest

from scenarios import first_frame
from scenarios.first_frame import Found, alone, main, measured, summary, table

GOOD = Found("ball_drop", "default", 0.5, 30.0, 20.0, 6.0, 7.5, 0.25, 0, "impacts 2 (0)")


def test_a_scene_is_run_in_a_process_of_its_own() -> None:
    found = alone("ball_drop", "default", 20)
    assert isinstance(found, Found) and (found.scene, found.preset, found.late) == ("ball_drop", "default", 0)
    assert found.load > 0.0 < found.median and found.own > 0.0 < found.awake and found.times == found.first / found.median


def test_a_scene_whose_start_is_refused_has_no_first_frame() -> None:
    assert measured("start_inside", "default", 3) is None


def test_a_scene_that_cannot_run_is_named() -> None:
    assert "preset of engine avatarsim is 'printed'" in str(alone("ball_drop", "printed", 3))


@pytest.mark.parametrize(("found", "code"), [
    (GOOD, 0), (replace(GOOD, first=60.0), 0), (replace(GOOD, first=60.1), 1), (replace(GOOD, late=1), 1),
    (replace(GOOD, first=float("nan")), 1), (replace(GOOD, first=100.0, own=90.0), 1),
])
def test_a_long_first_frame_is_a_fault_whatever_the_reason(
    found: Found, code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(first_frame, "alone", lambda scene, preset, frames: found)
    assert main(["--filter", "ball_drop"]) == code
    assert f"1 scenes; in {code} the first frame takes more than 10 medians" in capsys.readouterr().out


@pytest.mark.parametrize(("found", "reason"), [
    (GOOD, ""), (replace(GOOD, first=100.0, own=90.0, late=2), "2 kernels loaded"),
    (replace(GOOD, first=100.0, own=50.0), "its own work: impacts 2 (0); 25 % of the frames sleep"),
    (replace(GOOD, first=100.0, own=50.0, asleep=0.0), "its own work"), (replace(GOOD, first=100.0, own=49.0), "left by load"),
])
def test_a_reader_sees_why(found: Found, reason: str) -> None:
    assert found.reason.startswith(reason) and bool(found.reason) == bool(reason)
    said = summary([found])
    assert found.reason in said and f"longest first frame: {found.first:.0f} us" in said and "above 1 ms: 0" in said


def test_frames_awake_are_told_from_those_asleep() -> None:
    """A heap at rest sleeps in most frames, a body that flies in none; an avatar without simulated bodies never does."""
    heap, flies, avatar = (measured(name, "default", 240) for name in ("rest_ten_minutes", "free_flight", "hand_in_corner"))
    assert heap and flies and avatar
    assert 0.5 < heap.asleep < 1.0 and "contacts 4 (0)" in heap.counted
    assert flies.asleep == avatar.asleep == 0.0 and flies.median == flies.awake


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
