"""Time series of one recording: every measure of a posture frame by frame, so that percentiles of many runs can be pooled."""

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from runfiles.record import Recording
from runfiles.visible_motion import reversals, shaking
from scenarios.measure.known import Known
from scenarios.measure.posture.jumps import beyond_user
from scenarios.measure.posture.limits import joint_limit_excess, reach_cone_excess
from scenarios.measure.posture.smoothness import free_awhile, silent_frames, third_differences
from scenarios.measure.posture.tracker_offset import angle_offsets, offsets
from scenarios.measure.side import outside

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Series:
    """F frames advanced, the k-th in place k - 1.

    overlap [m]; limits: excess over joint limits and reach cones [deg]; wrong: something outside its region; contact; shakes;
    reversal: largest of a link [m]; jerk: third difference of a link origin beyond the target's largest [m], at its last frame;
    turn [deg] and way [m]: largest of a joint and of a root beyond the user's largest;
    owed: the target has been free for half a second; farthest: link origin from its target's [m]; silent: see `silent_frames`;
    offset [m] of link origins and angle [deg] of joints: root mean square over the links, over the joints. Flags are 0 and 1.
    """

    overlap: Array
    limits: Array
    wrong: Array
    contact: Array
    shakes: Array
    reversal: Array
    jerk: Array
    turn: Array
    way: Array
    owed: Array
    farthest: Array
    silent: Array
    offset: Array
    angle: Array

    def told(self) -> dict[str, list[float]]:
        """What goes into a file."""
        return {entry.name: getattr(self, entry.name).tolist() for entry in fields(self)}


def series_from(told: Mapping[str, list[float | str]]) -> Series:
    """What `told` gave, out of a file, where numbers that are none are words."""
    return Series(**{entry.name: np.array([float(v) for v in told[entry.name]]) for entry in fields(Series)})


def series_of(recording: Recording, known: Known) -> Series:
    """All series of a recording of at least one frame that the judge has judged, of a scene with links."""
    scenario, scene = known.scenario, known.scene
    free, contact = known.free(recording), known.contact(recording)
    shown, target = recording.positions[:, recording.links], recording.raw_positions
    turns = recording.orientations[:, recording.links]
    limits = np.maximum(joint_limit_excess(scene, turns, recording.angles), reach_cone_excess(scene, turns))
    reversed_by, (turn, way) = reversals(shown, target), beyond_user(recording, scene)
    wrong = outside(recording.positions, scenario.regions, scene.names)
    wrong[recording.inside_frame[outside(recording.inside_positions, scenario.regions, scene.names)]] = True
    distance = offsets(recording)
    return Series(
        overlap=recording.overlap[1:], limits=np.degrees(limits[1:]), wrong=_numbers(wrong[1:]), contact=_numbers(contact[1:]),
        shakes=_numbers(shaking(reversed_by, recording.dt)), reversal=reversed_by.max(axis=1), jerk=_jerk(shown, target),
        turn=np.degrees(turn), way=way, owed=_numbers(free_awhile(free, recording.dt)),
        farthest=distance.max(axis=1), silent=_numbers(silent_frames(recording, free)), offset=_rms_each(distance),
        angle=_rms_each(np.degrees(angle_offsets(recording, scene))),
    )


def _numbers(flags: Flags) -> Array:
    return flags.astype(np.float64)


def _rms_each(values: Array) -> Array:
    """(F,) root mean square over the second axis; 0 where it is empty, as for a hand without joints."""
    return np.sqrt(np.mean(values**2, axis=1)) if values.shape[1] else np.zeros(len(values))


def _jerk(shown: Array, target: Array) -> Array:
    """(F,) largest third difference [m] of a link origin less that of a target's; 0 in frames that have none."""
    found = np.zeros(len(shown) - 1)
    if len(shown) > 3:
        found[2:] = third_differences(shown).max(axis=1) - third_differences(target).max(axis=1)
    return found
