"""Queries of recorded postures: motion segments proved free, nearest pairs, limits. On arrays of their own.

The kernels, the method and its source are those of `avatarsim.ik.motion_ccd`.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.load import load_room
from avatarsim.assets.models.model import Model
from avatarsim.cleaning.result import Options
from avatarsim.errors import InvalidInput
from avatarsim.ik.clip_posture import clip_posture
from avatarsim.ik.motion_ccd import free_until, make_motion_segment, nearest_at, pair_gaps
from avatarsim.jit.arena import pack
from avatarsim.model.conversion import mix_samples
from avatarsim.model.skeleton import BALL, FREE
from avatarsim.model.world import build, sample_arrays
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body, ContactLaw, PairTable, Role
from avatarsim.scene.carried import Carried
from avatarsim.scene.checks import instance, listed
from avatarsim.scene.joint import Rigid
from avatarsim.scene.motion import Motion
from avatarsim.scene.moving import with_moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Pair = tuple[str, str]
Named = TypeVar("Named", Body, Avatar)


class Chords:
    """Queries of postures of the avatars of `scene`, whose bodies are all fixed.

    Moving bodies are avatars in it: they move as free roots do, on straight lines and by slerp. free_roots, turning: links of the
    others with free roots, and with free roots or balls; given: links of moving bodies, whose poses no query changes."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.world = scene, build(scene)
        self.words, self.parts = pack(make_motion_segment(self.world))
        self._owner, self._hinges = self.world.geometry.body, self.world.hinges
        kinds = self.world.skeleton.kind
        moves = np.repeat([avatar.moves for avatar in scene.avatars], [len(avatar.links) for avatar in scene.avatars])
        self.moving, is_free = np.flatnonzero(moves), (kinds == FREE) & ~moves
        self.free_roots, self.turning = np.flatnonzero(is_free), np.flatnonzero(is_free | ((kinds == BALL) & ~moves))

    def free_until(self, before: TrackerSample, after: TrackerSample, least: float = 0.0) -> tuple[float, Pair | None]:
        """Return the share of the motion segment between two postures over which all pairs are proved apart, and a pair.
        They are at least `least` [m] apart from its start up to there; the pair ends it. The samples must fit the avatars."""
        arrays = (*sample_arrays(before), *sample_arrays(after))
        share, a, b = free_until(self.world.words, self.words, *arrays, least)
        return share, self._pair(a, b)

    def nearest(self, sample: TrackerSample, within: float) -> tuple[float, Pair | None]:
        """Return the smallest signed distance [m] of all pairs that must not overlap, negative where they do, and the pair.
        The distance is some number above `within` [m] where none is as near."""
        gap, a, b = nearest_at(self.world.words, self.words, *sample_arrays(sample), within)
        return gap, self._pair(a, b)

    def clipped(self, sample: TrackerSample) -> tuple[TrackerSample, tuple[float, float]]:
        """Return the posture with each joint at the nearest place within its limits, and the excesses.
        These are the largest of the joints [rad] and of the slides [m]."""
        beyond = clip_posture(self.world.words, self.words, *sample_arrays(sample))
        if beyond == (0.0, 0.0):
            return sample, beyond
        end = self.parts.end
        clipped = TrackerSample(sample.time, end.root.copy(), rotation.from_matrix(end.turn), end.angle[self._hinges])
        return self.with_moving_bodies(clipped, sample), beyond

    def with_moving_bodies(self, sample: TrackerSample, other: TrackerSample) -> TrackerSample:
        """Return the posture with moving bodies at their poses in another one."""
        if not self.moving.size:
            return sample
        positions, rotations = sample.positions.copy(), sample.rotations.copy()
        positions[self.moving], rotations[self.moving] = other.positions[self.moving], other.rotations[self.moving]
        return TrackerSample(sample.time, positions, rotations, sample.angles)

    def gaps(self, sample: TrackerSample, pairs: NDArray[np.int64]) -> Array:
        """Return signed distances (m,) [m] of pairs (m, 2) of bodies by number, some positive number where they are apart."""
        found = np.zeros(len(pairs))
        pair_gaps(self.world.words, self.words, *sample_arrays(sample), pairs, found)
        return found

    def _pair(self, a: int, b: int) -> Pair | None:
        if a < 0:
            return None
        names, (first, second) = self.scene.names, sorted((int(self._owner[a]), int(self._owner[b])))
        return names[first], names[second]


def between(before: TrackerSample, after: TrackerSample, share: float) -> TrackerSample:
    """Return the posture at `share` (0 to 1) of the motion from one to the next, as a player shows it.
    Equals `scene.tracker.between` up to rounding; compiled, since a motion is cleaned in many small parts."""
    first, last = sample_arrays(before), sample_arrays(after)
    mixed = tuple(np.empty_like(array) for array in first)
    mix_samples(*first, *last, float(share), *mixed)
    return TrackerSample(before.time + share * (after.time - before.time), *mixed)


def difference(chords: Chords, one: TrackerSample, other: TrackerSample) -> float:
    """Return the largest difference of two postures in any joint or root [rad, m].
    Of turns, which are small where it matters, it is the chord's."""
    a, b = one.rotations[chords.turning], other.rotations[chords.turning]
    turns = 2.0 * np.minimum(np.abs(a - b), np.abs(a + b))
    parts = (turns, one.positions[chords.free_roots] - other.positions[chords.free_roots], one.angles - other.angles)
    return max([float(np.abs(part).max()) for part in parts if part.size], default=0.0)


class Certified(NamedTuple):
    """Proof of the F-1 motion segments of a motion: until (F-1,) the proved share, pair the pair that ends it."""

    until: Array
    pair: tuple[Pair | None, ...]


def certified(chords: Chords, motion: Motion, least: float = 0.0) -> Certified:
    """Find the motion segments between neighbouring postures over which all pairs keep at least `least` [m] apart."""
    samples = [motion.sample(frame) for frame in range(len(motion))]
    found = [chords.free_until(a, b, least) for a, b in zip(samples, samples[1:], strict=False)]
    return Certified(np.array([share for share, _ in found], dtype=np.float64), tuple(pair for _, pair in found))


Room = Sequence[Body] | Model | str
"""Bodies, the model that `load_room` returns, or what it reads."""


def scene_of(model: Model, room: Room, options: Options, carried: Sequence[Carried] = ()) -> Scene:
    """Return the scene in which a model's avatar is cleaned: its own bodies, the room's and the carried ones.
    Loose bodies are fixed where they are or left out.

    Raises InvalidInput for a model without avatar, and for objects that are not bodies."""
    instance("model to clean with", model, Model, "a Model, as load_avatar gives", InvalidInput)
    instance("options of cleaning", options, Options, "Options(margin, blend, ...)", InvalidInput)
    room = load_room(room) if isinstance(room, str) else room
    room = room.bodies if isinstance(room, Model) else room
    for body in listed(room):
        instance("body of the room", body, Body, "a Body, or a room as load_room gives", InvalidInput)
    for one in listed(carried):
        instance("what is carried", one, Carried, "Carried(body, motion)", InvalidInput)
    avatar = model.avatar
    if not isinstance(avatar, Avatar):
        raise InvalidInput("avatar of the model", avatar, "one: a file of a robot, a hand or a skeleton")
    own, others = ([standing(body) for body in bodies if takes_part(body, options)] for bodies in (model.room, room))
    links = avatar.links
    taken = {avatar.name} if len(links) == 1 else {f"{avatar.name}/{link.name}" for link in links}
    named, known = with_own_names((*own, *others), taken), taken | {body.name for body in own}
    exclude = tuple(pair for pair in model.exclude if known.issuperset(pair))
    exclude += tuple((body.name, link) for body in named[len(own) :] for link in bolted(avatar))
    at_rest = tuple(entry for entry in model.at_rest if known.issuperset(entry[:2]))
    moving = with_own_names((one.body for one in carried), taken | {body.name for body in named})
    avatars = (avatar, *moving)
    # the material of bodies matters only to impacts, of which there are none
    made_of = sorted({body.material for body in named} | {link.material for one in avatars for link in one.links})
    law = ContactLaw(0.0, 0.0)
    materials = PairTable({(one, other): law for one in made_of for other in made_of})
    start = model.start
    if start is not None and moving:
        start = with_moving(avatars, start, {}, rest(avatars))
    return Scene("clean", named, avatars, materials, start=start, exclude=exclude, at_rest=at_rest)


def bolted(avatar: Avatar) -> tuple[str, ...]:
    """Return the names in a scene of links that no joint moves: the base of an arm may touch the floor on which it stands."""
    found = set[str]()
    for link in avatar.links:
        if isinstance(link.joint, Rigid) and (link.parent is None or link.parent in found):
            found.add(link.name)
    return tuple(name for link, name in zip(avatar.links, avatar.link_names, strict=True) if link.name in found)


def takes_part(body: Body, options: Options) -> bool:
    """Return True if a body takes part: loose ones may be left out."""
    return body.role is Role.FIXED or not options.loose


def standing(body: Body) -> Body:
    """Return the body, fixed where it is."""
    return replace(body, role=Role.FIXED, mass=None, velocity=(0.0, 0.0, 0.0), angular_velocity=(0.0, 0.0, 0.0))


def with_own_names(bodies: Iterable[Named], taken: set[str]) -> tuple[Named, ...]:
    """Return the bodies, with a number appended to names that are taken or repeated."""
    known, found = set(taken), list[Named]()
    for body in bodies:
        name, count = body.name, 1
        while name in known:
            count += 1
            name = f"{body.name} ({count})"
        known.add(name)
        found.append(body if name == body.name else replace(body, name=name))
    return tuple(found)
