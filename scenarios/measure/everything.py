"""All figures of one recording."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from inspect import signature
from pkgutil import walk_packages

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from runfiles.overlapping import Overlapping, gathered
from runfiles.record import Recording
from scenarios import measure as package
from scenarios.measure.known import Known
from scenarios.measure.overlap import INSIDE_JUDGED, residual_overlap, substep_overlap
from scenarios.measure.posture.smoothness import NEAR, contact_gap, smoothness
from scenarios.measure.posture.tracker_offset import tracker_offset
from scenarios.measure.value import Missing, Value, Values
from scenarios.scenario import Scenario

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Measured:
    """Figures by metric, remarks by metric, the overlap of every state shown (F+1,) [m] and the pairs that overlap; both empty
    without the judge."""

    values: dict[str, Value]
    notes: dict[str, str]
    overlap: Array
    overlapping: Overlapping = field(default_factory=lambda: gathered((), ()))


@cache
def measures() -> tuple[tuple[Callable[..., Values], tuple[str, ...]], ...]:
    """Return every function of the modules of this package that carries the mark `measure`, with the names of its parameters."""
    functions: list[Callable[..., Values]] = []
    for module in sorted(walk_packages(package.__path__, f"{package.__name__}."), key=lambda info: info.name):
        if not module.ispkg:
            exports = vars(import_module(module.name)).values()
            functions += [one for one in exports if getattr(one, "measures", False) and one.__module__ == module.name]
    return tuple((one, tuple(signature(one).parameters)) for one in functions)


def marked(recording: Recording, scenario: Scenario, scene: Scene) -> dict[str, Value]:
    """Return the values of every marked function."""
    given = {"recording": recording, "scenario": scenario, "scene": scene}
    values: dict[str, Value] = {}
    for function, names in measures():
        values |= function(**{name: given[name] for name in names})
    return values


def measured(recording: Recording, known: Known, most_inside: int | None = INSIDE_JUDGED) -> Measured:
    """Return every metric that applies to the scene. Without the judge's package its metrics are Missing, all others are kept."""
    scenario, scene = known.scenario, known.scene
    values = marked(recording, scenario, scene)
    try:
        judge = known.judge
    except ImportError as error:
        absent = Missing(f"the judge needs the package {error.name}, which is not installed", "package")
        values |= dict.fromkeys(("residual_overlap_max", "tracker_offset_rms_free", "chatter_frames"), absent)
        return Measured(values, {}, np.zeros(0))
    verdicts = judge.over_time(recording.positions, recording.orientations)
    shown = np.array([verdict.deepest for verdict in verdicts], dtype=np.float64)
    values |= residual_overlap(shown)
    values["substep_overlap_max"], note = substep_overlap(recording, judge.deepest, most_inside)
    free = known.free(recording)
    values |= tracker_offset(recording, scene, free)
    values |= smoothness(recording, scene, free, known.contact(recording))
    if scenario.everyday and scene.links:
        # of the scenes of the short tables only: the judge looks at all pairs of links once more
        values |= contact_gap(judge.link_gaps(recording.positions, recording.orientations, NEAR))
    notes = {"substep_overlap_max": note} if note else {}
    return Measured(values, notes, shown, gathered([verdict.pairs for verdict in verdicts], scene.names))
