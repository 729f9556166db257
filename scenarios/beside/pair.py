"""Two recordings of one scene, compared where the second is good enough to be compared with."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from reference.judge import Judge
from scenarios.measure.body_offset import body_offsets
from scenarios.measure.least_angle import least_angles
from scenarios.measure.limits import joint_limit_excess, reach_cone_excess
from scenarios.measure.side import outside
from scenarios.measure.tracker_offset import angle_offsets, offsets, rms
from scenarios.record import Recording
from scenarios.scenario import Scenario

Array = NDArray[np.float64]

LEFT = 1e-3
"""Overlap [m] up to which a frame of the other engine counts: more than that is not a posture to be compared with."""
BENT = float(np.radians(1e-3))
"""Excess [rad] up to which a joint is within its limits: what the table of all engines calls equal."""
SAME = 1e-6
"""Figures [m, degrees] closer than this are the same: both are the user's, to rounding."""


@dataclass(frozen=True)
class Beside:
    """One scene: frames run, those of the other engine with at most LEFT of overlap on the legal side, and over these the root
    mean square distance from the user, ours and theirs: `offset` [m] of link origins, `angle` [deg] of joints, `body` [m] of the
    points of all links. nan where no frame counts. `least_angle` [deg]: no posture within the joints' limits has less there.

    The first two again over those of these frames, `kept` many, in which the other engine's joints are within their limits too.
    `unsaid`: what of the scene the other engine has no words for."""

    scenario: str
    frames: int
    counted: int
    offset: float
    their_offset: float
    angle: float
    their_angle: float
    least_angle: float
    body: float
    their_body: float
    kept: int
    kept_offset: float
    kept_their_offset: float
    kept_angle: float
    kept_their_angle: float
    unsaid: str

    @property
    def winner(self) -> tuple[str, str]:
        """Who is nearer in offset, and who in angle: "ours", "theirs", "same", or "-" where there is nothing to compare."""
        return _nearer(self.offset, self.their_offset), _nearer(self.angle, self.their_angle)

    @property
    def body_winner(self) -> str:
        """Who is nearer with all of the body."""
        return _nearer(self.body, self.their_body)

    @property
    def kept_winner(self) -> tuple[str, str]:
        """`winner` over the frames in which the other engine keeps the limits."""
        return _nearer(self.kept_offset, self.kept_their_offset), _nearer(self.kept_angle, self.kept_their_angle)


def _nearer(ours: float, theirs: float) -> str:
    if not (math.isfinite(ours) and math.isfinite(theirs)):
        return "-"
    return "same" if abs(ours - theirs) <= SAME else "ours" if ours < theirs else "theirs"


def good_frames(recording: Recording, scenario: Scenario, scene: Scene, judge: Judge) -> NDArray[np.bool_]:
    """(F,) frames advanced that leave at most LEFT of overlap and have everything on the legal side. nan is not good."""
    wrong = outside(recording.positions, scenario.regions, scene.names)
    # a frame counts as a whole: what was outside at a sub-step was outside
    inside = outside(recording.inside_positions, scenario.regions, scene.names)
    wrong[recording.inside_frame[inside]] = True
    good = ~wrong
    good[good] = judge.depths(recording.positions[good], recording.orientations[good]) <= LEFT
    return np.asarray(good[1:])


def compared(ours: Recording, theirs: Recording, scenario: Scenario, scene: Scene, judge: Judge) -> Beside:
    """Both over the same frames: those in which theirs is good. A recording that ended early is compared as far as it goes."""
    frames = min(ours.frames, theirs.frames)
    good = good_frames(theirs, scenario, scene, judge)[:frames]
    kept = good & within_limits(theirs, scene)[:frames]
    each = [_distances(recording, scene, frames) for recording in (ours, theirs)]
    (offset, angle, body), (their_offset, their_angle, their_body) = [[_rms(v[good]) for v in one] for one in each]
    (o, a), (their_o, their_a) = [[_rms(v[kept]) for v in one[:2]] for one in each]
    least = _rms(np.degrees(least_angles(ours, scene))[:frames][good])
    unsaid = theirs.meta.get("cannot_say")
    return Beside(
        scenario.name, frames, int(good.sum()), offset, their_offset, angle, their_angle, least, body, their_body,
        int(kept.sum()), o, their_o, a, their_a, "; ".join(sorted(unsaid)) if isinstance(unsaid, dict) else "",
    )


def within_limits(recording: Recording, scene: Scene) -> NDArray[np.bool_]:
    """(F,) frames advanced in which no joint is farther beyond its limits than BENT. nan is not within."""
    turns, angles = recording.orientations[1:, recording.links], recording.angles[1:]
    excess = np.maximum(joint_limit_excess(scene, turns, angles), reach_cone_excess(scene, turns))
    return np.asarray(excess <= BENT)


def _distances(recording: Recording, scene: Scene, frames: int) -> tuple[Array, Array, Array]:
    """Offsets [m], angles [deg] and body offsets [m] of the first frames."""
    found = offsets(recording), np.degrees(angle_offsets(recording, scene)), body_offsets(recording, scene)
    return found[0][:frames], found[1][:frames], found[2][:frames]


def _rms(values: Array) -> float:
    """Root mean square; of nothing nan."""
    return rms(values) if values.size else math.nan
