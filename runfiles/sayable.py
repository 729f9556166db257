"""Which figures would judge an engine by what it has no words for? One rule for ranking, losses, sweep, cheapest and profile.

Each engine says of every scene what it cannot express (`Engine.cannot_say`), and a run keeps that per scene and preset. A figure
that measures just that is not ranked for the engine, neither for it nor against it: it is no loss of ours, no case and no error.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

LIMITS, CONES = ("joint_limit_excess_max",), ("reach_cone_excess_max",)
BOUNCES = ("restitution_error_max", "apex_error_max", "bounce_time_error_max", "zeno_end_error_max")
STOPS = ("stop_distance_error_max", "stop_direction_error_max")


@dataclass(frozen=True)
class Silence:
    """What cannot be judged where an engine lacks words for a feature: `metrics`. `of` names engines or runs ("engine/preset") to
    which that is confined: a feature that one preset lacks and another has is said by the engine in both."""

    metrics: tuple[str, ...]
    of: tuple[str, ...] = ()


SILENT: Mapping[str, Silence] = {
    "twist limits": Silence(LIMITS),
    "ball limits": Silence(LIMITS),
    "reach cones": Silence(CONES),
    # the one course that a closed form gives in scenes with the coupling is that of equation 6; so is the sag of a loaded hand
    "virtual coupling": Silence(("course_error_max", "sag_error_max")),
    # MuJoCo's default contact does not bounce and its tuned one does; PyBullet says it where its factors miss a pair
    "restitution": Silence(BOUNCES, ("mujoco/default", "pybullet")),
    "friction": Silence(STOPS, ("pybullet",)),
}
"""Feature, as engines name it in `cannot_say` -> what it leaves unjudged. What is approximated rather than lacked (hulls in
single precision, ellipsoids as hulls) is judged: a reader sees the approximation as error."""


class Note(Protocol):
    """What one engine with one preset said of one scene."""

    @property
    def scenario(self) -> str: ...
    @property
    def run(self) -> str: ...
    @property
    def cannot_say(self) -> Mapping[str, str]: ...


def unsaid(metric: str, run: str, cannot_say: Mapping[str, str]) -> str:
    """Why `metric` does not judge `run` ("engine/preset") in a scene of which the engine says `cannot_say`: the feature and what
    the engine says of it; "" where the metric judges it."""
    names = {run, run.partition("/")[0]}
    for feature, said in cannot_say.items():
        silence = SILENT.get(feature)
        if silence is not None and metric in silence.metrics and (not silence.of or names & set(silence.of)):
            return f"cannot say {feature}: {said}"
    return ""


class Unsaid:
    """The rule over all notes of a run."""

    def __init__(self, notes: Iterable[Note]) -> None:
        self._said: dict[tuple[str, str], dict[str, str]] = {}
        for note in notes:
            self._said.setdefault((note.scenario, note.run), {}).update(note.cannot_say)

    def why(self, scenario: str, run: str, metric: str) -> str:
        """Why `metric` does not judge `run` in `scenario`; "" where it does, or where the engine left no note."""
        return unsaid(metric, run, self._said.get((scenario, run), {}))
