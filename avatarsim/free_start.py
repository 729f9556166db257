"""Starts that overlap: the nearest postures and places without overlap, and how far each avatar and loose body was moved.

Loose bodies are avatars of one free link while they are looked for, so that one search serves both (`ik.nearest_free`). Avatars
come first, as if there were no loose bodies; then loose bodies go out of one another, of avatars and of the room; where that
cannot be, both together.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import Moved
from avatarsim.errors import StartOverlaps
from avatarsim.ik.nearest_free import aim, is_free_at, make_free_search, search_from, value_of_posture
from avatarsim.jit.arena import pack
from avatarsim.model.geometry import Poses, place
from avatarsim.model.skeleton import BALL, FREE, HINGES, SLIDE, Posture
from avatarsim.model.world import World, build, posture_of
from avatarsim.pose_queries import overlapping_pairs
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, Role
from avatarsim.scene.joint import Free, Rigid
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation
from avatarsim.tolerances import NOTHING, POSTURE_GAP

Array = NDArray[np.float64]

LIFTS = tuple(1e-2 * 2.0**k for k in range(10))
"""[m] how far roots are moved where no nearer posture is found, to 5 m: a doubling finds a place of any size in as many looks."""

AXES = tuple(axis / np.linalg.norm(axis) for axis in np.indices((3, 3, 3)).reshape(3, -1).T - 1.0 if axis.any())
"""Directions in which roots are moved: along axes, and between them, since a corner is left along its diagonal."""

REACH = 4.0
"""Factor by which a root is moved farther than the best posture so far. Larger: more looks; smaller: places around a corner are
not found."""

WORK = 9_000
"""Work, in units of about a microsecond, after which no search begins any more once a posture is found; counted, so that results
repeat. Less: postures that are farther away than they need be; more: time."""

LOOSE = 0.01
"""Weight of the heaviest loose body relative to a link of an avatar, where both have to be moved. Larger: avatars make way for
furniture; smaller: the QP is worse conditioned."""

WEDGED = 2.0
"""Multiple of the deepest overlap that a loose body is moved before avatars make way with it. Larger: bodies leave slots
that they were put in; smaller: avatars are moved by bodies in piles."""

MOST_LOOSE = 128
"""Most loose bodies that are moved together where those that overlap find no place alone; of more, the scene is refused."""

NEAREST = 4
"""Most of these moved postures from which a search begins."""

SHARES = (0.5, 1.0)
"""Shares of the way to rest at which a search begins as well: folded limbs come apart, and out of narrow places."""


class Postures:
    """Search for the free posture that is nearest to a given one, of avatars of a world; the world's posture is its memory."""

    def __init__(self, world: World, weights: Array | None = None) -> None:
        self.world, count = world, len(world.scene.avatars)
        self.words, own = pack(make_free_search(world, np.ones(count) if weights is None else weights))
        self.best, self.is_solved, self.is_seen = own.best, own.is_solved, own.is_seen
        self.avatar_of = own.avatars.avatar
        self.farthest = inf
        self.is_solved[:] = [not avatar.moves for avatar in world.scene.avatars]
        self.rest = posture_of(world.skeleton, world.hinges, rest(world.scene.avatars))

    def nearest(self, target: Posture, margin: float, is_strict: bool = False) -> bool:
        """Put the world at the nearest free posture that is found; return False, and back at `target`, where none is.

        margin     [m] gap that pairs which overlap get
        is_strict  whether all pairs get it
        """
        self._put(target)
        aim(self.world.words, self.words)
        if is_free_at(self.world.words, self.words, margin, is_strict):
            self.farthest = 0.0
            return True
        least, found, spent, self.farthest = inf, None, 0, inf
        for start in self._starts(target, margin, is_strict):
            if found is not None and spent > WORK:
                break
            self._put(start)
            value, work = search_from(self.world.words, self.words, margin, is_strict, least)
            spent += work
            if value < least:
                least, found = value, copied(self.best)
                self.farthest = self._moved(target, found)
        self.show(target if found is None else found)
        return found is not None

    def show(self, posture: Posture) -> None:
        """Put the world at a posture."""
        self._put(posture)
        is_free_at(self.world.words, self.words, 0.0, False)

    def _moved(self, one: Posture, other: Posture) -> float:
        """Return the largest distance [m] of a link origin between two postures."""
        places = []
        for posture in (one, other):
            self.show(posture)
            places.append(self.world.poses.position[self.world.skeleton.first :].copy())
        return float(np.linalg.norm(places[1] - places[0], axis=1).max())

    def _put(self, posture: Posture) -> None:
        for into, of in zip(self.world.posture, posture, strict=True):
            into[...] = of

    def _starts(self, target: Posture, margin: float, is_strict: bool) -> Iterator[Posture]:
        """Return postures to search from."""
        yield target
        kind, is_solved = self.world.skeleton.kind, self.is_solved[self.avatar_of] > 0
        if (is_solved & np.isin(kind, (HINGES, BALL, SLIDE))).any():
            yield from (self._mixed(target, share) for share in SHARES)
        roots = np.flatnonzero((kind == FREE) & is_solved)
        for share in (0.0, 1.0) if len(roots) else ():
            given = self._mixed(target, share)
            lifted = [found for axis in AXES if (found := self._lifted(given, roots, axis, margin, is_strict))]
            yield from [posture for _, posture in sorted(lifted, key=lambda one: one[0])][:NEAREST]
            if self.farthest < inf:
                break

    def _mixed(self, target: Posture, share: float) -> Posture:
        """Return the posture at a share of the way to rest, with roots where they are."""
        skel, mixed = self.world.skeleton, copied(target)
        mixed.angle[:] += share * (self.rest.angle - target.angle)
        for link in np.flatnonzero(skel.kind == BALL):
            turn = rotation.to_rotation_vector(rotation.from_matrix(target.turn[link].T @ self.rest.turn[link]))
            mixed.turn[link] = target.turn[link] @ rotation.to_matrix(rotation.from_rotation_vector(share * turn))
        return mixed

    def _lifted(
        self, target: Posture, roots: NDArray[np.int64], axis: Array, margin: float, is_strict: bool
    ) -> tuple[float, Posture] | None:
        """Return a free posture with roots moved along an axis, of several avatars each farther than the last, and its f."""
        far = np.arange(1.0, len(roots) + 1.0)[:, None] * axis
        for lift in LIFTS:
            if lift > REACH * self.farthest:
                break
            lifted = copied(target)
            lifted.root[roots] += lift * far
            self._put(lifted)
            if is_free_at(self.world.words, self.words, margin, is_strict):
                return value_of_posture(self.world.words, self.words), lifted
        return None


def copied(posture: Posture) -> Posture:
    """Return a copy of a posture."""
    return Posture(*(array.copy() for array in posture))


def move_apart(world: World) -> tuple[Moved, ...]:
    """Put the avatars and loose bodies of a world at the nearest places without overlap; return who was moved, how far and why.

    Raises StartOverlaps, and leaves the world as it was, where none is found."""
    overlaps = overlapping_pairs(world)
    if not overlaps:
        return ()
    posture, poses = copied(world.posture), Poses(*(array.copy() for array in world.poses))
    deepest = max(depth for _, _, depth in overlaps)
    for search in searches(world, {name for pair in overlaps for name in pair[:2]}, deepest):
        if search() and not overlapping_pairs(world):
            return moved_of(world, posture, poses, overlaps)
        for arrays, kept in ((world.posture, posture), (world.poses, poses)):
            for array, before in zip(arrays, kept, strict=True):
                array[...] = before
    raise StartOverlaps(overlaps, "no free place was found near it: start from a pose that is nearer to one")


def searches(world: World, in_overlap: set[str], depth: float) -> Iterator[Callable[[], bool]]:
    """Return searches that write free places into a world: with the loose bodies that overlap, then with all of them."""
    carried = carried_by(world.scene)
    loose = {body.name for body in world.scene.bodies if body.role is Role.SIMULATED}
    if not loose:
        yield lambda: Postures(world).nearest(copied(world.posture), POSTURE_GAP)
        return
    every = loose - set(carried)
    yield Apart(world, every & in_overlap, depth).is_found
    if every - in_overlap and len(every) <= MOST_LOOSE:
        yield Apart(world, every, depth).is_found


def carried_by(scene: Scene) -> dict[str, str]:
    """Return the link that each attached body moves with, of avatars that do not move by themselves."""
    standing = {name for avatar in scene.avatars if avatar.moves for name in avatar.link_names}
    return {body: link for body, link in scene.attached if link not in standing}


class Apart:
    """A scene whose loose bodies `loose` are avatars of one free link, about their centres of mass, and whose attached bodies are
    rigid links; and the places found in it, written into its world. `depth` [m]: of the deepest overlap."""

    def __init__(self, world: World, loose: set[str], depth: float) -> None:
        self.world, self.depth, scene = world, depth, world.scene
        self.number = {name: b for b, name in enumerate(scene.names)}
        self.carried = carried_by(scene)
        self.loose = [body for body in scene.bodies if body.name in loose]
        self.named = dict[str, str]()
        avatars = [self._with_carried(avatar) for avatar in scene.avatars]
        freed = [one_link(body) for body in self.loose]
        standing = [
            body if body.role is Role.FIXED else replace(
                body, role=Role.FIXED, mass=None, velocity=(0.0, 0.0, 0.0), angular_velocity=(0.0, 0.0, 0.0)
            )
            for body in scene.bodies if body.name not in loose and body.name not in self.carried
        ]
        rename = self.named.get
        self.built = build(Scene(
            scene.name, tuple(standing), (*avatars, *freed), scene.materials, start=self._start(),
            exclude=tuple((rename(a, a), rename(b, b)) for a, b in scene.exclude), narrow=scene.narrow,
            at_rest=tuple((rename(a, a), rename(b, b), depth) for a, b, depth in scene.at_rest),
        ))
        heaviest = max((body.mass.mass for body in self.loose if body.mass), default=1.0)
        weights = [LOOSE * body.mass.mass / heaviest for body in self.loose if body.mass]
        self.search = Postures(self.built, np.array([*np.ones(len(avatars)), *weights]))

    def is_found(self) -> bool:
        """Move avatars, then loose bodies, then both together if need be; the world has the places if they are found."""
        search, loose = self.search, len(self.loose)
        own = len(search.is_solved) - loose
        moves = search.is_solved.copy()
        first = copied(self.built.posture)
        # loose bodies are the last ones
        seen = np.ones(len(search.is_seen), dtype=np.int64)
        unseen = seen.copy()
        unseen[len(seen) - loose :] = 0
        free = moves.copy()
        free[own:] = 0
        if not self._solve(first, free, unseen):
            return False
        if loose and not self._loose_found(first, moves - free, moves, seen):
            return False
        self._write()
        return True

    def _loose_found(
        self, first: Posture, alone: NDArray[np.int64], together: NDArray[np.int64], seen: NDArray[np.int64]
    ) -> bool:
        """Move loose bodies, or avatars with them where a body is wedged: where it would go much farther than it is deep."""
        far, found = inf, None
        if self._solve(copied(self.built.posture), alone, seen):
            far, found = self.search.farthest, copied(self.built.posture)
            if far <= WEDGED * self.depth:
                return True
        if self._solve(first, together, seen) and self.search.farthest < far:
            return True
        if found is None:
            return False
        self.search.show(found)
        return True

    def _solve(self, target: Posture, solved: NDArray[np.int64], seen: NDArray[np.int64]) -> bool:
        self.search.is_solved[:], self.search.is_seen[:] = solved, seen
        return not solved.any() or self.search.nearest(target, POSTURE_GAP)

    def _with_carried(self, avatar: Avatar) -> Avatar:
        """Return the avatar with its attached bodies as rigid links; their names in the scene change."""
        names = avatar.link_names
        more = [(body, names.index(link)) for body, link in self.carried.items() if link in names]
        if not more:
            return avatar
        links = [*avatar.links, *(self._rigid(body, avatar.links[k].name, names[k]) for body, k in more)]
        changed = replace(avatar, links=tuple(links), size_range=(0.0, inf))
        self.named |= dict(zip((*names, *(body for body, _ in more)), changed.link_names, strict=True))
        return changed

    def _rigid(self, name: str, parent: str, link: str) -> Link:
        """Return an attached body as a rigid link, about its centre of mass, where it is relative to its link."""
        poses, b, k = self.world.poses, self.number[name], self.number[link]
        body, turn = self.world.scene.bodies[b], poses.rotation[k].T
        x, y, z = (turn @ (poses.position[b] - poses.position[k])).tolist()
        q, r, s, t = rotation.from_matrix(turn @ poses.rotation[b]).tolist()
        return replace(one_link(body).links[0], parent=parent, joint=Rigid(), anchor=(x, y, z), orientation=(q, r, s, t))

    def _start(self) -> TrackerSample:
        """Return the first posture, with rows of attached and of loose bodies."""
        scene, given, first = self.world.scene, self.world.scene.first_sample, 0
        positions, turns = list[Array](), list[Array]()
        for avatar in scene.avatars:
            more = sum(link in avatar.link_names for link in self.carried.values())
            last = first + len(avatar.links)
            positions += [given.positions[first:last], np.zeros((more, 3))]
            turns += [given.rotations[first:last], np.tile(rotation.IDENTITY, (more, 1))]
            first = last
        own = [self.number[body.name] for body in self.loose]
        positions.append(self.world.poses.position[own])
        turns.append(rotation.from_matrix(self.world.poses.rotation[own]).reshape(-1, 4))
        return TrackerSample(0.0, np.concatenate(positions), np.concatenate(turns), given.angles)

    def _write(self) -> None:
        """Write poses of the moved bodies, and the posture of the avatars, into the world."""
        back = {new: old for old, new in self.named.items()}
        first, world = len(self.built.scene.bodies), self.world
        for k, name in enumerate(self.built.scene.names[first:], start=first):
            b = self.number[back.get(name, name)]
            world.poses.position[b], world.poses.rotation[b] = self.built.poses.position[k], self.built.poses.rotation[k]
            place(world.geometry, world.poses, b)
            link = b - world.skeleton.first
            if link >= 0:
                world.posture.root[link] = self.built.posture.root[k - first]
                world.posture.turn[link] = self.built.posture.turn[k - first]
        world.posture.angle[world.hinges] = self.built.posture.angle[self.built.hinges]


def one_link(body: Body) -> Avatar:
    """Return a loose body as an avatar of one free link, whose frame is at the centre of mass."""
    mass = body.mass
    assert mass is not None
    x, y, z = mass.centre
    pieces = tuple(
        replace(piece, position=(piece.position[0] - x, piece.position[1] - y, piece.position[2] - z)) for piece in body.pieces
    )
    link = Link(body.name, None, Free(), pieces, mass, body.material)
    return Avatar(body.name, (link,), size_range=(0.0, inf))


def moved_of(world: World, posture: Posture, poses: Poses, overlaps: list[tuple[str, str, float]]) -> tuple[Moved, ...]:
    """Return avatars and loose bodies that are elsewhere than at `posture` and `poses`."""
    turned = np.swapaxes(poses.rotation, 1, 2) @ world.poses.rotation
    angle = np.linalg.norm(rotation.to_rotation_vector(rotation.from_matrix(turned)), axis=1)
    far = np.linalg.norm(world.poses.position - poses.position, axis=1)
    groups: list[tuple[str, tuple[int, ...]]] = [(body.name, (b,)) for b, body in enumerate(world.scene.bodies)]
    first = len(groups)
    for avatar in world.scene.avatars:
        groups.append((avatar.name, tuple(range(first, first + len(avatar.links)))))
        first += len(avatar.links)
    found = []
    for name, numbers in groups:
        distance, turn = max(float(far[b]) for b in numbers), max(float(angle[b]) for b in numbers)
        if distance > NOTHING or turn > NOTHING:
            names = {world.scene.names[b] for b in numbers}
            own = sorted((pair for pair in overlaps if names & set(pair[:2])), key=lambda pair: -pair[2])
            found.append(Moved(name, distance, turn, tuple(own)))
    return tuple(found)
