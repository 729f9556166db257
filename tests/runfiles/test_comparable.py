"""Figures that compare engines, and reasons why others do not."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import pandas as pd
import pytest

from runfiles.comparable import ASLEEP, AVATAR_METRIC, AVATAR_TIME, FEW_FRAMES, Note, reasons, silenced_metrics
from scenarios import catalog
from scenarios.engines import opened

Line = tuple[str, str, str, float]


@dataclass(frozen=True)
class Said:
    """Report of an engine on itself in a scene."""

    scenario: str
    run: str
    unsupported: Mapping[str, str] = field(default_factory=dict)
    settings: Mapping[str, tuple[str, str]] = field(default_factory=dict)


def why(lines: Sequence[Line], notes: Sequence[Note] = (), said: str = "3 x 200 frames, 30 warm-up frames") -> list[str]:
    """Return reasons of rows (scene, run, metric, value)."""
    rows = pd.DataFrame(lines, columns=["scenario", "run", "metric", "value"]).assign(note=said)
    return [str(one) for one in reasons(rows, notes)]


def test_an_avatar_makes_times_incomparable_in_its_scene_alone() -> None:
    metrics = ("frame_time_p50", "residual_overlap_max")
    lines = [(scene, "mujoco/tuned", metric, 1.0) for scene in ("a", "b") for metric in metrics]
    assert why([*lines, ("a", "tracker/default", AVATAR_METRIC, 0.0)]) == [AVATAR_TIME, "", "", "", ""]


@pytest.mark.parametrize(("said", "compares"), [
    ("1 x 200 frames", False), ("3 x 45 frames", False), ("2 x 200 frames", True), ("", True),
])
def test_a_slow_end_needs_frames_and_repeats(said: str, compares: bool) -> None:
    lines = [("a", "mujoco/tuned", metric, 1.0) for metric in ("frame_time_p95", "frame_time_max", "frame_time_p50")]
    assert why(lines, said=said) == ["" if compares else FEW_FRAMES] * 2 + [""]


@pytest.mark.parametrize(("rests", "metrics"), [
    (49.0, ()), (50.0, ("p50",)), (95.0, ("p50", "p95")), (100.0, ("p50", "p95", "p99")),
])
def test_times_of_sleepers_do_not_compare(rests: float, metrics: Sequence[str]) -> None:
    lines = [("a", "pybullet/tuned", f"frame_time_{name}", 1.0) for name in ("p50", "p95", "p99")]
    found = why([*lines, ("a", "avatarsim/default", "resting_frames", rests)])
    assert found[:3] == [ASLEEP if name in metrics else "" for name in ("p50", "p95", "p99")]


@pytest.mark.parametrize(("setting", "sleeps"), [("True", True), ("1", True), ("False", False), ("0", False), ("", False)])
def test_a_setting_tells_whether_an_engine_sleeps(setting: str, sleeps: bool) -> None:
    lines = [("a", "mujoco/sleeping", "resting_frames", 90.0), ("a", "mujoco/sleeping", "frame_time_p50", 1.0)]
    settings = {"sleep": (setting, "")} if setting else {}
    assert bool(why(lines, [Said("a", "mujoco/sleeping", settings=settings)])[1]) == sleeps


def test_a_feature_that_is_not_set_up_takes_out_its_metrics_only() -> None:
    notes = [Said("a", "mujoco/tuned", {"reach cones": "ignored"})]
    lines = [
        (scene, run, metric, 1.0)
        for scene, run in (("a", "mujoco/tuned"), ("a", "pybullet/tuned"), ("b", "mujoco/tuned"))
        for metric in ("reach_cone_excess_max", "joint_limit_excess_max")
    ]
    assert [bool(one) for one in why(lines, notes)] == [True] + [False] * 5


def test_presets_that_lack_a_feature_are_told_apart() -> None:
    assert silenced_metrics("mujoco/default", ["restitution"]) and not silenced_metrics("mujoco/tuned", ["restitution"])
    assert silenced_metrics("mujoco/tuned", ["no such feature"]) == silenced_metrics("newcomer/default", ["restitution"]) == {}


@pytest.mark.parametrize(("scenario", "metric", "silent", "judged"), [
    ("coupling_sweep", "course_error_max", ("mujoco/tuned", "mujoco/default", "pybullet/tuned"), ("avatarsim/default",)),
    ("mocap_punch_wall", "joint_limit_excess_max", ("mujoco/tuned", "pybullet/default"), ("avatarsim/default",)),
    ("mocap_punch_wall", "reach_cone_excess_max", ("mujoco/sleeping", "pybullet/tuned"), ("avatarsim/paper",)),
    ("mocap_punch_wall", "residual_overlap_max", (), ("mujoco/tuned", "pybullet/tuned", "avatarsim/default")),
    ("ball_drop", "apex_error_max", ("mujoco/default",), ("mujoco/tuned", "pybullet/tuned", "avatarsim/default")),
])
def test_the_engines_own_words_decide(scenario: str, metric: str, silent: Sequence[str], judged: Sequence[str]) -> None:
    scene = catalog.get(scenario).as_run(False).build()
    for run in (*silent, *judged):
        engine = opened(run.partition("/")[0])
        try:
            features = engine.unsupported(scene)
        finally:
            engine.close()
        assert (metric in silenced_metrics(run, features)) == (run in silent), run


def test_what_one_engine_refuses_compares_no_other() -> None:
    lines = [("a", "avatarsim/default", "run", 0.0), *((scene, "mujoco/tuned", "residual_overlap_max", 0.2) for scene in "ab")]
    rows = pd.DataFrame(lines, columns=["scenario", "run", "metric", "value"]).assign(note="", status=["refused", "info", "info"])
    _, in_refused, elsewhere = reasons(rows, ())
    assert "avatarsim" in in_refused and elsewhere == ""
