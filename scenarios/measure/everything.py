"""All figures of one recording: asks each family in turn."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from runfiles.overlapping import Overlapping, gathered
from runfiles.record import Recording
from scenarios.measure.bodies.bounce import bounce_times, bounces, zeno_ends
from scenarios.measure.bodies.closed_form import course_errors, flips, pivots, stops, tops
from scenarios.measure.bodies.conserved import conserved
from scenarios.measure.bodies.energy import energy
from scenarios.measure.bodies.grips import carried, pressed, sags
from scenarios.measure.bodies.standing import at_rest, piles, towers
from scenarios.measure.bodies.time_kept import time_kept
from scenarios.measure.bodies.waves import waves
from scenarios.measure.bodies.whereabouts import escapes, grasp, travel
from scenarios.measure.frames import halts, not_finite, work
from scenarios.measure.known import Known
from scenarios.measure.overlap import INSIDE_JUDGED, residual_overlap, substep_overlap
from scenarios.measure.posture.jumps import jumps
from scenarios.measure.posture.limits import limit_excess
from scenarios.measure.posture.smoothness import NEAR, contact_gap, smoothness
from scenarios.measure.posture.stillness import still_frames
from scenarios.measure.posture.tracker_offset import tracker_offset
from scenarios.measure.side import wrong_side
from scenarios.measure.value import Missing, Value
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


def motion_figures(recording: Recording, scenario: Scenario, scene: Scene) -> dict[str, Value]:
    """Closed forms and invariants of motion and impact, each only if the scenario expects it."""
    found: dict[str, Value] = {**halts(recording, scene), **time_kept(recording, scene)}
    for family in (bounce_times, zeno_ends, course_errors, at_rest, conserved, stops, flips, pivots, tops, escapes, towers, piles,
                   waves, carried, pressed, sags):
        found |= family(recording, scenario, scene)
    return found


def measured(recording: Recording, known: Known, most_inside: int | None = INSIDE_JUDGED) -> Measured:
    """Every metric that applies to the scene. Without the judge's package its metrics are Missing, all others stand."""
    scenario, scene = known.scenario, known.scene
    values: dict[str, Value] = {
        **not_finite(recording), **wrong_side(recording, scenario, scene), **limit_excess(recording, scene),
        **still_frames(recording), **jumps(recording, scene), **energy(recording, scene),
        **bounces(recording, scenario, scene), **travel(recording, scenario, scene), **grasp(recording, scenario, scene),
        **work(recording),
        **motion_figures(recording, scenario, scene),
    }
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
