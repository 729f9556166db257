"""Content of one file of a robot, a hand or a room."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.assets.models.coordinates import WIDTHS, Coordinates
from avatarsim.assets.models.laws import Frictions
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body, fixed
from avatarsim.scene.carried import Carried
from avatarsim.scene.checks import Vector, finite_array, parts, require_near
from avatarsim.scene.motion import Motion
from avatarsim.scene.moving import with_moving
from avatarsim.scene.scene import EARTH, Scene
from avatarsim.scene.tracker import TrackerSample, link_poses, rest

if TYPE_CHECKING:
    from avatarsim.assets.models.pieces_of_geoms import Visual

Array = NDArray[np.float64]


class Visuals(Mapping[str, "tuple[Visual, ...]"]):
    """Parts that pages draw, by names, which `read` returns at the first access."""

    def __init__(self, read: Callable[[], Mapping[str, "tuple[Visual, ...]"]]) -> None:
        self._read = read

    @cached_property
    def _parts(self) -> Mapping[str, "tuple[Visual, ...]"]:
        return self._read()

    def __getitem__(self, name: str) -> "tuple[Visual, ...]":
        return self._parts[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._parts)

    def __len__(self) -> int:
        return len(self._parts)


@dataclass(frozen=True, eq=False)
class Model:
    """An avatar, the bodies around it, or both.

    avatar       the driven tree of links; None for a file that is only a room
    coordinates  the avatar's generalized coordinates in the file's own order; None without an avatar
    bodies       the fixed room and loose bodies
    moving       bodies with given poses: MJCF's mocap bodies; they belong into `Scene.avatars`
    attached     loose bodies and the link or moving body that each is welded to, by their names in a scene
    notes        sentences for the user: what was excluded, fixed, guessed
    exclude      pairs of names that never touch, in addition to those of the avatar itself, as in `Scene.exclude`
    start        the avatar's posture at the file's reference, within limits, where it is free; None without an avatar
    gravity      [m/s^2]
    frictions    of the file's geoms, whose materials bodies and links have
    at_rest      pairs that overlap at `start` and may be no deeper, in addition to those of the avatar, as in `Scene.at_rest`
    visuals      parts that pages draw in place of the pieces, by the names that links and bodies have in a scene; no scene has
                 them, and no engine reads them"""

    avatar: Avatar | None
    coordinates: Coordinates | None
    bodies: tuple[Body, ...]
    notes: tuple[str, ...]
    exclude: tuple[tuple[str, str], ...] = ()
    start: TrackerSample | None = None
    at_rest: tuple[tuple[str, str, float], ...] = ()
    moving: tuple[Avatar, ...] = ()
    attached: tuple[tuple[str, str], ...] = ()
    gravity: Vector = EARTH
    frictions: Frictions = field(default_factory=Frictions)
    visuals: Mapping[str, "tuple[Visual, ...]"] = field(default_factory=dict)

    def scene(self, name: str = "model", room: "Model | None" = None) -> Scene:
        """Return a scene of the model at its start, in a room."""
        if room is not None:
            return in_room(self, room).scene(name)
        avatars = self.moving if self.avatar is None else (self.avatar, *self.moving)
        start = self.start
        if start is not None and self.moving:
            start = with_moving(avatars, start, {}, rest(avatars))
        return Scene(
            name, self.bodies, avatars, self.frictions.table(), self.gravity, start=start, exclude=self.exclude,
            attached=self.attached, at_rest=self.at_rest,
        )

    def pose(self, q: Array) -> dict[str, tuple[Array, Array]]:
        """Return the position (3,) [m] of each link's joint and the link's orientation (4,) in the world at q (width,).

        Raises InvalidInput for a model without avatar, for another width and for numbers that are not finite."""
        avatar, coordinates = self._driven()
        row = finite_array("generalized coordinates", q, (coordinates.width,), InvalidInput)
        places, turns = link_poses((avatar,), coordinates.motion(row[None], np.zeros(1)).sample(0))
        return {link.name: (places[k], turns[k]) for k, link in enumerate(avatar.links)}

    def at(self, joints: Mapping[str, ArrayLike], start: Array | None = None) -> Array:
        """Return coordinates (width,) with the given values of the named joints, and those of `start` for all others.

        Names are those of `coordinates.names`. A hinge has its angle [rad], a slide its displacement [m], a ball a quaternion
        (w, x, y, z), a free joint a position [m] and a quaternion as seven numbers. Without `start` from the model's own.

        Raises InvalidInput as `pose` does and for values that do not fit, UnknownName for names of no joint that moves
        by itself, such as fixed and following ones. It lists similar names."""
        avatar, coordinates = self._driven()
        following = {one.follower for one in avatar.couplings}
        q, places, first = self._row(self._begin(start)), dict[str, slice](), 0
        for slot in coordinates.slots:
            if slot.kind != "fixed" and slot.hinge not in following:
                places[slot.name] = slice(first, first + WIDTHS[slot.kind])
            first += WIDTHS[slot.kind]
        for name, value in joints.items():
            if name not in places:
                raise UnknownName("joint to pose", str(name), places)
            own = places[name]
            q[own] = finite_array(f"value of joint {name}", parts(value), (own.stop - own.start,), InvalidInput)
        sample = coordinates.motion(q[None], np.zeros(1)).sample(0)
        return self._row(replace(sample, angles=avatar.with_followers(sample.angles)))

    def reach(self, goals: Mapping[str, ArrayLike], start: Array | None = None) -> Array:
        """Return coordinates (width,) within limits, near `start`, that bring links' joints to `goals`, or as near as is found.
        `goals` are places (3,) [m] by the links' names. A free root stays; obstacles are ignored: the Shield avoids them.

        Without `start` from the model's own. Raises InvalidInput as `pose` does and for goals that are no places,
        UnknownName for names that are no links."""
        from avatarsim.assets.models.reach import Limb

        avatar, _ = self._driven()
        names = {link.name: k for k, link in enumerate(avatar.links)}
        wanted: dict[int, Array] = {}
        for name, goal in goals.items():
            if name not in names:
                raise UnknownName("link to reach with", str(name), names)
            wanted[names[name]] = finite_array(f"goal of link {name} [m]", goal, (3,), InvalidInput)
            require_near(f"goal of link {name}", wanted[names[name]], InvalidInput)
        return self._row(Limb(avatar, wanted).reach(self._begin(start)))

    def _begin(self, start: Array | None) -> TrackerSample:
        """Return the sample of coordinates to start from, by default the model's own."""
        avatar, coordinates = self._driven()
        if start is None:
            return rest((avatar,)) if self.start is None else self.start
        row = finite_array("generalized coordinates to start from", start, (coordinates.width,), InvalidInput)
        return coordinates.motion(row[None], np.zeros(1)).sample(0)

    def _row(self, sample: TrackerSample) -> Array:
        """Return the coordinates (width,) of a sample."""
        motion = Motion(np.zeros(1), sample.positions[None], sample.rotations[None], sample.angles[None])
        return np.asarray(self._driven()[1].rows(motion)[0])

    def _driven(self) -> tuple[Avatar, Coordinates]:
        if self.avatar is None or self.coordinates is None:
            raise InvalidInput("avatar of the model", None, "one: a file of a robot, a hand or a skeleton")
        return self.avatar, self.coordinates

    @property
    def room(self) -> tuple[Body, ...]:
        """Return the bodies of the room: fixed and loose ones, and moving ones fixed at their first poses."""
        return (*self.bodies, *(standing(one) for one in self.moving))


def without_pairs(model: Model, pairs: Sequence[tuple[str, str]]) -> Model:
    """Return the model in which these pairs never touch, by the names of links and bodies, or by those of its scene.

    Raises UnknownName for other names."""
    avatar, own, others = model.avatar, list[tuple[str, str]](), list[tuple[str, str]]()
    known = {name: name for name in model.scene().names}
    links = {} if avatar is None else {f"{avatar.name}/{link.name}": link.name for link in avatar.links}
    known = {short: name for name, short in links.items()} | known
    for pair in pairs:
        for name in pair:
            if name not in known:
                raise UnknownName("link or body in exclude", str(name), list(known))
        a, b = (known[name] for name in pair)
        if a in links and b in links:
            own.append((links[a], links[b]))
        else:
            others.append((a, b))
    if avatar is not None and own:
        avatar = replace(avatar, ignore=(*avatar.ignore, *own))
    return replace(model, avatar=avatar, exclude=(*model.exclude, *others))


def in_room(model: Model, room: Model) -> Model:
    """Return a model in a room. Names of the room that the model has too get the prefix "room_".

    Gravity is the model's, that of the room where the model's is the Earth's.
    """
    taken = {body.name for body in model.room}
    if model.avatar is not None:
        taken |= {model.avatar.name}
    names = dict[str, str]()
    for body in room.room:
        name = body.name
        while name in taken:
            name = f"room_{name}"
        names[body.name] = name
        taken.add(name)
    bodies = tuple(replace(body, name=names[body.name]) for body in room.bodies)
    moving = tuple(replace(one, name=names[one.name]) for one in room.moving)
    exclude, attached = (
        tuple((names.get(a, a), names.get(b, b)) for a, b in pairs) for pairs in (room.exclude, room.attached)
    )
    at_rest = tuple((names.get(a, a), names.get(b, b), depth) for a, b, depth in room.at_rest)
    return replace(
        model, bodies=(*model.bodies, *bodies), moving=(*model.moving, *moving), exclude=(*model.exclude, *exclude),
        at_rest=(*model.at_rest, *at_rest), attached=(*model.attached, *attached),
        gravity=room.gravity if model.gravity == EARTH else model.gravity, frictions=model.frictions | room.frictions,
        visuals=Visuals(partial(_both_visuals, model.visuals, room.visuals, names)),
    )


def _both_visuals(
    own: "Mapping[str, tuple[Visual, ...]]", others: "Mapping[str, tuple[Visual, ...]]", names: Mapping[str, str]
) -> "Mapping[str, tuple[Visual, ...]]":
    return {**own, **{names[name]: parts for name, parts in others.items() if name in names}}


def with_carried(model: Model, carried: Sequence[Carried]) -> Model:
    """Return a model with carried bodies as the first of its moving ones, at their first poses."""
    taken = {body.name for body in model.room}
    for one in carried:
        if one.body.name in taken:
            raise InvalidInput("name of what is carried", one.body.name, f"another one than those of {sorted(taken)}")
    return replace(model, moving=(*(one.body for one in carried), *model.moving))


def followed_by(motion: Motion, moving: Sequence[Avatar]) -> Motion:
    """Return a motion of an avatar and of moving bodies that stay at their first poses."""
    if not moving:
        return motion
    first = rest(moving)
    columns = ((motion.positions, first.positions), (motion.rotations, first.rotations), (motion.angles, first.angles))
    both = [np.concatenate((own, np.repeat(still[None], len(motion), axis=0)), axis=1) for own, still in columns]
    return Motion(motion.times, *both)


def standing(moving: Avatar) -> Body:
    """Return a moving body as a fixed one at its first pose."""
    link = moving.links[0]
    return fixed(moving.name, link.pieces, link.material, link.anchor, link.orientation)
