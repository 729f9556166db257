"""Two recordings of one scene, compared where the second is good enough to be compared with."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from reference.judging.judge import Judge
from runfiles.record import Recording
from scenarios.measure.posture.limits import joint_limit_excess, least_angles, reach_cone_excess
from scenarios.measure.posture.tracker_offset import angle_offsets, body_offsets, offsets, rms
from scenarios.measure.side import outside
from scenarios.scenario import Scenario

Array = NDArray[np.float64]

LEFT = 1e-3
"""Overlap [m] up to which a frame of the other engine counts: more than that is not a posture to be compared with."""
BENT = float(np.radians(1e-3))
"""Excess [rad] up to which a joint is within its limits: what the table of all engines calls equal."""
ALIKE = 0.01
"""[m] how far apart a loose body may be in two recordings that are still of one and the same world: less than a finger's width.
More, and a hand that holds a mug would be compared with one that has let it fall."""
SAME = 1e-6
"""Figures [m, degrees] closer than this are the same: both are the user's, to rounding."""


@dataclass(frozen=True)
class Among:
    """Root mean square distance from the user over some frames, ours and theirs: `offset` [m] of link origins, `angle` [deg] of
    joints; nan over none."""

    frames: int
    offset: float
    their_offset: float
    angle: float
    their_angle: float

    @property
    def winner(self) -> tuple[str, str]:
        """Which is nearer in offset, and which in angle: "ours", "theirs", "same", or "-" where there is nothing to compare."""
        return _nearer(self.offset, self.their_offset), _nearer(self.angle, self.their_angle)


@dataclass(frozen=True)
class Beside:
    """One scene: frames run, those of the other engine with at most LEFT of overlap on the legal side, and over these the root
    mean square distance from the user, ours and theirs: `offset` [m] of link origins, `angle` [deg] of joints, `body` [m] of the
    points of all links. nan where no frame counts. `least_angle` [deg]: no posture within the joints' limits has less there.

    The first two again over those of these frames in which the other engine's joints are within their limits too, `kept`, and in
    which all loose bodies are where they are in ours, `alike`. `unsaid`: what of the scene the other engine has no words for."""

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
    kept: Among
    alike: Among
    unsaid: str

    @property
    def winner(self) -> tuple[str, str]:
        """Which is nearer in offset, and which in angle: "ours", "theirs", "same", or "-" where there is nothing to compare."""
        return _nearer(self.offset, self.their_offset), _nearer(self.angle, self.their_angle)

    @property
    def body_winner(self) -> str:
        """The same by the distance of all points of the links."""
        return _nearer(self.body, self.their_body)


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
    alike = good & same_world(ours, theirs, scene)[:frames]
    least = _rms(np.degrees(least_angles(ours, scene))[:frames][good])
    unsaid = theirs.meta.get("cannot_say")
    return Beside(
        scenario.name, frames, int(good.sum()), offset, their_offset, angle, their_angle, least, body, their_body,
        _among(each, kept), _among(each, alike), "; ".join(sorted(unsaid)) if isinstance(unsaid, dict) else "",
    )


def within_limits(recording: Recording, scene: Scene) -> NDArray[np.bool_]:
    """(F,) frames advanced in which no joint is farther beyond its limits than BENT. nan is not within."""
    turns, angles = recording.orientations[1:, recording.links], recording.angles[1:]
    excess = np.maximum(joint_limit_excess(scene, turns, angles), reach_cone_excess(scene, turns))
    return np.asarray(excess <= BENT)


def same_world(ours: Recording, theirs: Recording, scene: Scene) -> NDArray[np.bool_]:
    """(F,) frames advanced by both in which no loose body is farther than ALIKE from where it is in the other; nan is."""
    loose = [k for k, body in enumerate(scene.bodies) if body.role is Role.SIMULATED]
    frames = min(ours.frames, theirs.frames)
    here, there = (recording.positions[1 : frames + 1, loose] for recording in (ours, theirs))
    return np.asarray((np.linalg.norm(there - here, axis=-1) <= ALIKE).all(axis=1))


def _among(each: Sequence[tuple[Array, Array, Array]], chosen: NDArray[np.bool_]) -> Among:
    """Offsets and angles of both over the chosen frames."""
    (offset, angle), (their_offset, their_angle) = [[_rms(v[chosen]) for v in one[:2]] for one in each]
    return Among(int(chosen.sum()), offset, their_offset, angle, their_angle)


def _distances(recording: Recording, scene: Scene, frames: int) -> tuple[Array, Array, Array]:
    """Offsets [m], angles [deg] and body offsets [m] of the first frames."""
    found = offsets(recording), np.degrees(angle_offsets(recording, scene)), body_offsets(recording, scene)
    return found[0][:frames], found[1][:frames], found[2][:frames]


def _rms(values: Array) -> float:
    """Root mean square; of nothing nan."""
    return rms(values) if values.size else math.nan
