"""Parts of an outcome that are stored."""

from scenarios.job import Job, Outcome
from scenarios.measure.value import Missing, Value
from scenarios.studies.settings.measure import entry_of


def test_entries_keep_figures_step_rest_and_unsupported_features() -> None:
    about = {"settings": {"dt": [0.002, "a reason"]}, "unsupported": {"reach cones": "ignored"}}
    values: dict[str, Value] = {"a": 1.0, "b": Missing("no occasion", "scene")}
    job = Job("stop_distance", "mujoco", "tuned")
    found = entry_of(Outcome(job, "measured", frames=3, values=values, about=about, resting=(True, False)))
    assert found["values"] == {"a": 1.0} and found["missing"] == {"b": "no occasion"} and found["frames"] == 3
    assert (found["step"], found["resting"], found["unsupported"]) == (0.002, [1, 0], {"reach cones": "ignored"})
    assert entry_of(Outcome(Job("stop_distance", "avatarsim", "default"), "measured"))["step"] is None
