"""What an engine has no words for does not judge it: by the words that the engines themselves use, and no further."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import pytest

from runfiles.metrics import METRICS
from runfiles.sayable import SILENT, Unsaid, unsaid
from scenarios import catalog
from scenarios.engines import opened


@dataclass(frozen=True)
class Note:
    scenario: str
    run: str
    cannot_say: Mapping[str, str] = field(default_factory=dict)


def said(engine: str, scenario: str) -> Mapping[str, str]:
    one = opened(engine)
    try:
        return one.cannot_say(catalog.get(scenario).as_run(False).build())
    finally:
        one.close()


@pytest.mark.parametrize(("scenario", "metric", "silent", "judged"), [
    ("coupling_sweep", "course_error_max", ("mujoco/tuned", "mujoco/default", "pybullet/tuned"), ("avatarsim/default",)),
    ("mocap_punch_wall", "joint_limit_excess_max", ("mujoco/tuned", "pybullet/default"), ("avatarsim/default",)),
    ("mocap_punch_wall", "reach_cone_excess_max", ("mujoco/sleeping", "pybullet/tuned"), ("avatarsim/paper",)),
    ("mocap_punch_wall", "residual_overlap_max", (), ("mujoco/tuned", "pybullet/tuned", "avatarsim/default")),
    ("ball_drop", "apex_error_max", ("mujoco/default",), ("mujoco/tuned", "pybullet/tuned", "avatarsim/default")),
    ("slide_to_roll", "course_error_max", (), ("mujoco/default", "pybullet/tuned", "avatarsim/default")),
])
def test_the_engines_own_words_decide(scenario: str, metric: str, silent: tuple[str, ...], judged: tuple[str, ...]) -> None:
    for run in (*silent, *judged):
        assert bool(unsaid(metric, run, said(run.partition("/")[0], scenario))) == (run in silent), run


def test_every_silence_is_of_a_metric_that_exists() -> None:
    assert all(metric in METRICS for silence in SILENT.values() for metric in silence.metrics)


def test_the_reason_is_the_engines() -> None:
    why = unsaid("course_error_max", "m/tuned", {"virtual coupling": "no spring"})
    assert why == "cannot say virtual coupling: no spring"


def test_notes_of_a_run_answer_by_scene_and_preset() -> None:
    found = Unsaid([Note("a", "m/tuned", {"reach cones": "ignored"}), Note("b", "m/tuned"), Note("a", "n/tuned")])
    assert found.why("a", "m/tuned", "reach_cone_excess_max") and not found.why("a", "m/tuned", "joint_limit_excess_max")
    for scenario, run in (("b", "m/tuned"), ("a", "n/tuned"), ("a", "m/default"), ("c", "m/tuned")):
        assert not found.why(scenario, run, "reach_cone_excess_max")
