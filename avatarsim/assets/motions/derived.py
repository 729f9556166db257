"""Numbers of a trajectory file that follow from its pose: poses of bodies by forward kinematics, speeds by central differences.

A file with another motion needs new ones. A file does not state its convention for a pose or a speed, so each is
first computed from the recorded motion: where that equals the recorded numbers, new ones are computed likewise; otherwise the
entry is left out, since a wrong one is worse than none.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.archive import AnyArray, Archive, narrowed
from avatarsim.scene.motion import Motion
from avatarsim.scene.tracker import poses_of_links
from avatarsim.spatial import rotation
from avatarsim.spatial.rotation import Array

BODY_NAMES = ("body_names", "link_names")
PLACES = ("body_pos_w", "body_positions", "body_pos")
TURNS = ("body_quat_w", "body_rotations", "body_quat")
SPEEDS = ("body_lin_vel_w", "body_linear_velocities", "body_lin_vel")
SPINS = ("body_ang_vel_w", "body_angular_velocities", "body_ang_vel")
"""Entries (F, bodies, 3 or 4): places [m], quaternions w first, speeds [m/s] and spins [rad/s] in the world."""

RATES = {
    "joint_vel": "joint_pos", "dof_vel": "dof_pos", "dof_velocities": "dof_positions", "qvel": "qpos", "root_vel": "root_pos",
    "root_lin_vel": "root_pos",
}
"""Entries that are time derivatives of others [1/s]."""

OTHERS = ("local_body_pos", "qacc", "joint_acc", "xpos", "xquat", "cvel", "site_xpos", "subtree_com", "root_ang_vel")
"""Entries that follow from the pose in conventions that differ between tools: left out with another motion."""

ALL = (*PLACES, *TURNS, *SPEEDS, *SPINS, *RATES, *OTHERS)

STRAYS = 0.02
"""Distance [m] by which a recorded body may stray in the frame of the link that it is fixed to, a turn counted at 0.1 m.
Robots of one name differ so between versions of their model: the waist of a G1 by 10 mm."""

LIKE = 0.1
"""Share of its own root mean square by which a recorded speed may differ from the computed one. One-sided and central differences
of a recording differ by a few hundredths; another frame of reference, by the whole."""

EQUAL = 1e-4
"""Distance [m] within which links are equally good carriers of a body: the error of float32 and rounding. In a clip in which an
arm stays still, all its links are."""

SAMPLED = 16
"""Frames in which a body is compared with every link, before the nearest that carry it are compared in all."""


@dataclass(frozen=True, eq=False)
class Poses:
    """Places (F, bodies, 3) [m] and quaternions (F, bodies, 4)."""

    places: Array
    turns: Array


def links_of(model: Model, motion: Motion) -> Poses:
    """Return poses of the avatar's links, and of the world as the last of them."""
    assert model.avatar is not None
    places, turns = poses_of_links((model.avatar,), motion.positions, motion.rotations, motion.angles)
    frames = len(motion)
    world = np.tile(np.array(rotation.IDENTITY), (frames, 1, 1))
    return Poses(np.concatenate([places, np.zeros((frames, 1, 3))], axis=1), np.concatenate([turns, world], axis=1))


def relative(links: Poses, link: int, places: Array, turns: Array) -> tuple[Array, Array]:
    """Return poses (F, 3), (F, 4) in the frame of a link."""
    back = rotation.conjugate(links.turns[:, link])
    return rotation.rotate(back, places - links.places[:, link]), rotation.multiply(back, turns)


def strays(places: Array, turns: Array) -> float:
    """Return the largest distance of poses (F, 3), (F, 4) from their first one [m], a turn counted at 0.1 m."""
    turned = np.linalg.norm(rotation.to_rotation_vector(rotation.multiply(rotation.conjugate(turns[:1]), turns)), axis=-1)
    return float((np.linalg.norm(places - places[0], axis=1) + 0.1 * turned).max())


def carrier(links: Poses, places: Array, turns: Array) -> int | None:
    """Return the link, or the world, in whose frame a body strays least, of equal ones the nearest; None if it strays in all."""
    few = np.unique(np.linspace(0, len(places) - 1, SAMPLED).astype(np.int64))
    sampled = Poses(links.places[few], links.turns[few])
    ways = np.array([strays(*relative(sampled, link, places[few], turns[few])) for link in range(links.places.shape[1])])
    equal = np.flatnonzero(ways <= ways.min() + EQUAL)
    link = int(equal[np.argmin(np.linalg.norm(links.places[0, equal] - places[0], axis=-1))])
    return link if strays(*relative(links, link, places, turns)) <= STRAYS else None


def bodies(archive: Archive, places: Array, turns: Array, model: Model, before: Motion, after: Motion) -> Poses | None:
    """Return the file's bodies for another motion; None if one of them is fixed to no link of the avatar.

    A body keeps its recorded pose against its link, frame by frame: where the link stays, the body does."""
    assert model.avatar is not None
    links, new = links_of(model, before), links_of(model, after)
    names = [link.name for link in model.avatar.links]
    key = archive.first(BODY_NAMES)
    listed = archive.words(key) if key else ()
    nearest = np.abs(np.searchsorted(before.times, after.times - 1e-9)).clip(0, len(before) - 1)
    moved = Poses(np.empty((len(after), places.shape[1], 3)), np.empty((len(after), places.shape[1], 4)))
    for body in range(places.shape[1]):
        name = listed[body] if body < len(listed) else ""
        link = names.index(name) if name in names else carrier(links, places[:, body], turns[:, body])
        if link is None or strays(*relative(links, link, places[:, body], turns[:, body])) > STRAYS:
            return None
        place, turn = relative(links, link, places[:, body], turns[:, body])
        moved.places[:, body] = new.places[:, link] + rotation.rotate(new.turns[:, link], place[nearest])
        moved.turns[:, body] = rotation.multiply(new.turns[:, link], turn[nearest])
    return moved


def speeds(values: Array, times: Array) -> Array:
    """Return the change (F, ...) a second of values (F, ...), by central differences."""
    return np.asarray(np.gradient(values, times, axis=0)) if len(values) > 1 else np.zeros_like(values)


def spins(turns: Array, times: Array) -> Array:
    """Return angular velocities (F, ..., 3) [rad/s] in the world of rotations (F, ..., 4), by central differences."""
    if len(turns) == 1:
        return np.zeros((*turns.shape[:-1], 3))
    after, before = np.minimum(np.arange(len(turns)) + 1, len(turns) - 1), np.maximum(np.arange(len(turns)) - 1, 0)
    step = rotation.to_rotation_vector(rotation.multiply(turns[after], rotation.conjugate(turns[before])))
    return np.asarray(step / (times[after] - times[before]).reshape(-1, *(1,) * (step.ndim - 1)))


def is_like(computed: Array, recorded: AnyArray) -> bool:
    """Return True if a computed speed equals the recorded one."""
    if computed.shape != recorded.shape or recorded.dtype.kind != "f" or not np.isfinite(recorded).all():
        return False
    scale = float(np.sqrt((recorded.astype(np.float64) ** 2).mean()))
    return bool(np.sqrt(((computed - recorded) ** 2).mean()) <= LIKE * scale + 1e-6)


def written_anew(
    archive: Archive, model: Model, before: Motion, after: Motion, was: Mapping[str, Array], now: Mapping[str, Array]
) -> dict[str, AnyArray]:
    """Return the derived entries that can be recomputed, for the motion `after` instead of `before`.

    `was` and `now` are entries of the pose, recorded and new. Derived entries missing here are to be left out of the file."""
    found: dict[str, AnyArray] = {}

    def keep(key: str, recorded: tuple[Array, ...], new: tuple[Array, ...]) -> None:
        like = archive.arrays[key]
        fitting = [values for computed, values in zip(recorded, new, strict=True) if is_like(computed, like)]
        if fitting:
            found[key] = narrowed(fitting[0], like)

    for key, of in RATES.items():
        if key in archive.arrays and of in was:
            like = archive.arrays[key]
            keep(key, _changes(was[of], before.times, like), _changes(now[of], after.times, like))
    placed, turned = archive.first(PLACES), archive.first(TURNS)
    if placed is None or turned is None:
        return found
    places, turns = archive.numbers(placed), archive.numbers(turned)
    frames = len(before)
    if places.ndim != 3 or places.shape[2] != 3 or turns.shape != (*places.shape[:2], 4) or len(places) != frames:
        return found
    if not (np.linalg.norm(turns, axis=-1) > 0.5).all():
        return found
    turns = rotation.normalised(turns)
    new = bodies(archive, places, turns, model, before, after)
    if new is None:
        return found
    found[placed], found[turned] = narrowed(new.places, archive.arrays[placed]), narrowed(new.turns, archive.arrays[turned])
    for keys, of_recorded, of_new in (
        (SPEEDS, (speeds(places, before.times),), (speeds(new.places, after.times),)),
        (SPINS, (spins(turns, before.times),), (spins(new.turns, after.times),)),
    ):
        for key in keys:
            if key in archive.arrays:
                keep(key, of_recorded, of_new)
    return found


def _changes(values: Array, times: Array, like: AnyArray) -> tuple[Array, ...]:
    """Return changes a second of coordinates (F, n), in each convention that the recorded speeds (F, m) may have.

    m = n - 1: the coordinates begin with a root, whose quaternion has three numbers in the speeds: its angular velocity in the
    world, or in its own frame, as MuJoCo's qvel has it."""
    if like.ndim != 2 or values.ndim != 2 or like.shape[1] != values.shape[1] - 1 or values.shape[1] < 7:
        return (speeds(values, times),)
    turns = rotation.normalised(values[:, 3:7])
    in_world = spins(turns, times)
    moved, others = speeds(values[:, :3], times), speeds(values[:, 7:], times)
    own = rotation.rotate(rotation.conjugate(turns), in_world)
    return tuple(np.concatenate([moved, turning, others], axis=1) for turning in (in_world, own))
