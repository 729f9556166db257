"""A compiled model as avatar, room, moving and loose bodies: one link a body, pieces of colliding geoms, pairs that never touch.

Pairs are left out as MuJoCo does (geoms of one weld, of a weld and its parent, excluded pairs, masks), and also those that
overlap at the reference already (`overlaps`): an avatar with them could not be shown at all.
"""

from collections.abc import Container, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets import caps
from avatarsim.assets.models.compiled import Compiled, EqualityKind, GeomKind, JointKind, compiled
from avatarsim.assets.models.coordinates import Coordinates
from avatarsim.assets.models.laws import Laws
from avatarsim.assets.models.links_of_tree import UNTURNED, JointOptions, Skeleton, Tree, skeleton_of, tree_of, trees
from avatarsim.assets.models.masses import Masses
from avatarsim.assets.models.mesh_files import PLATE
from avatarsim.assets.models.model import Model, Visuals, without_pairs
from avatarsim.assets.models.pairs import Filter, Part
from avatarsim.assets.models.pieces_of_geoms import Frames, Geoms, MeshOptions, Visual, quaternion_of, vector_of
from avatarsim.assets.models.preflight import COLLIDE
from avatarsim.assets.models.spec_scale import LARGEST, SMALLEST
from avatarsim.assets.models.start import start_pose
from avatarsim.assets.models.urdf_visuals import visuals_of_urdf
from avatarsim.assets.models.welds import attaching_welds
from avatarsim.errors import InvalidFile, InvalidInput, InvalidScene, InvalidShape, UnknownName
from avatarsim.scene.avatar import PLAUSIBLE_SIZE, Avatar
from avatarsim.scene.body import Body, Role, fixed, simulated
from avatarsim.scene.checks import within
from avatarsim.scene.joint import axes_of
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import EARTH
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

UNNAMED = "MuJoCo Model"
"""MuJoCo's name for a model that has none."""

LIMIT_ROUNDING = 1e-3
"""[rad, m] Excess over a limit at the start that is not reported: files round both."""

WORLD = "world"
"""Name of a part of the world whose geom has no name."""


_SHAPES = {
    "collision": 'at least 1: <collision> of a URDF link; contype or conaffinity of an MJCF geom, or a pair that names it; '
                 'collide="visual" takes the shapes that are to be looked at',
    "visual": 'at least 1: <visual> or <collision> of a URDF link, a geom of MJCF',
}
"""Valid numbers of shapes for errors, by `Options.collide`."""


@dataclass(frozen=True)
class Options:
    """User options for a model file; see `load.load_avatar`.
    `driven`: an avatar is required, or excluded, or, for None, a tree with joints becomes one where there is any."""

    avatar: str | tuple[str, ...] | None = None
    driven: bool | None = True
    folder: str | Path | None = None
    joints: JointOptions = field(default_factory=JointOptions)
    pieces: MeshOptions = field(default_factory=MeshOptions)
    leave: tuple[str, ...] = ()
    masks: bool = True
    materials: tuple[str, str] = ("human", "wood")
    size_range: tuple[float, float] = PLAUSIBLE_SIZE
    scale: float = 1.0
    collide: str = "collision"
    keyframe: str | int | None = None
    exclude: tuple[tuple[str, str], ...] = ()


def model_of_file(path: Path, options: Options) -> Model:
    """Return avatar, room and loose bodies of an MJCF or URDF file. Raises InvalidFile for unsupported features, by name."""
    if options.collide not in COLLIDE:
        raise UnknownName("collide", str(options.collide), COLLIDE)
    scale = within(f"metres a unit of length of {path.name}", options.scale, SMALLEST, LARGEST, InvalidInput)
    try:
        return _Reading(compiled(path, options.folder, scale, options.collide), path, options).model()
    except (InvalidScene, InvalidShape) as error:
        # a number of the file that a scene rejects
        raise InvalidFile(f"{error.thing} in {path.name}", error.value, error.valid) from error


class _Reading:
    """Conversion of one model from numbers to bodies."""

    def __init__(self, model: Compiled, path: Path, options: Options) -> None:
        self._m, self._path, self._file, self._options = model, path, path.name, options
        self._notes: list[str] = []
        self._names = _distinct([name or f"body {k}" for k, name in enumerate(model.body_name)])
        self._masses = Masses(model, self._names)
        self._title = model.model_name.strip() if model.model_name not in ("", UNNAMED) else path.stem
        self._laws = Laws(model, path.name)
        self._pose = start_pose(model, options.keyframe, path.name)
        roots = [self._pose.root(bodies[0])[0] for bodies in trees(model) if np.isin(model.jnt_bodyid, bodies).any()]
        if not roots or options.driven is False:
            # the avatar of a room comes from another file
            roots.append(np.zeros(3))
        self._geoms = Geoms(model, options.pieces, options.leave, np.array(roots))
        self._filter = Filter(model, options.masks)
        self._parts: dict[str, Part] = {}
        self._moving: list[Avatar] = []
        self._visuals: dict[str, tuple[Visual, ...]] = {}
        self._frames: dict[str, Frames] = {}

    def model(self) -> Model:
        """Return the whole model."""
        forest = trees(self._m)
        chosen = self._avatar_tree(forest) if self._options.driven is not False else None
        tree = skeleton = avatar = start = None
        if chosen is not None:
            tree = self._tree(chosen)
            skeleton = skeleton_of(tree, self._names, self._geoms, self._masses, self._material_of_link)
            avatar = Avatar(self._title, skeleton.links, size_range=self._options.size_range, couplings=skeleton.couplings)
            avatar = replace(avatar, ignore=self._ignored(tree, skeleton))
            start = self._start(tree, avatar, skeleton.coordinates)
            for b, name in self._scene_names(tree, avatar).items():
                self._frames[name] = {b: (-skeleton.centres[b], UNTURNED)}
        bodies = [*self._world(), *(body for bodies in forest if bodies[0] not in (chosen or ()) for body in self._body(bodies))]
        exclude = self._excluded(tree, avatar)
        welds = self._welds(tree, avatar, start, bodies)
        self._note_equalities(welds)
        self._notes += [*self._pose.notes(), *self._geoms.notes(), *self._masses.notes(), *self._laws.notes()]
        if self._m.plate_name:
            self._notes.append(f"flat meshes are plates, {PLATE:g} of their size thick: {', '.join(self._m.plate_name)}")
        if self._m.plugin_name:
            self._notes.append(f"plugins are left out: {', '.join(self._m.plugin_name)}")
        if self._m.unread_name:
            self._notes.append(f"left out, though the file states it: {', '.join(self._m.unread_name)}")
        gravity = vector_of(self._m.gravity)
        if gravity != EARTH:
            self._notes.append(f"gravity is {', '.join(f'{g:g}' for g in gravity)} m/s^2, as in the file")
        found = Model(
            avatar, None if skeleton is None else skeleton.coordinates, tuple(bodies), (), exclude, start,
            moving=tuple(self._moving), attached=tuple(welds.values()), gravity=gravity,
            frictions=self._laws.frictions(), visuals=self._page_visuals(),
        )
        if not (found.room if avatar is None else any(link.pieces for link in avatar.links)):
            of = "" if avatar is None else f"avatar {avatar.name} in "
            raise InvalidFile(f"shapes of {of}{self._file} that collide", 0, _SHAPES[self._options.collide])
        if self._options.exclude:
            found = without_pairs(found, self._options.exclude)
        notes: tuple[str, ...] = ()
        if avatar is not None or any(body.role is Role.SIMULATED for body in bodies):
            # the engine's compiler, which is not needed for a room alone
            from avatarsim.assets.models.overlaps import freed

            found, notes = freed(found, tree is not None and tree.is_free)
        return replace(found, notes=(*self._notes, *notes))

    def _page_visuals(self) -> Mapping[str, tuple[Visual, ...]]:
        """Return parts that pages draw in place of pieces; visuals of URDF are read when a page needs them."""
        drawn = self._visuals | {name: self._geoms.visuals(frames) for name, frames in self._frames.items()}
        own = {name: parts for name, parts in drawn.items() if parts}
        if not self._m.is_urdf or self._options.collide == "visual":
            return own
        options = self._options
        return Visuals(partial(
            visuals_of_urdf, self._path.absolute(), options.folder, options.scale, self._m.body_name, self._frames, own,
        ))

    def _avatar_tree(self, forest: list[tuple[int, ...]]) -> tuple[int, ...] | None:
        """Return the tree of the avatar: the named one, or the one with the most joints.

        A free joint makes a body loose, so it does not count unless the file has one tree and nothing else to drive."""
        requested = self._options.avatar
        if requested is not None:
            chosen = {self._tree_with(name, forest) for name in ((requested,) if isinstance(requested, str) else requested)}
            if chosen:
                return tuple(sorted(b for bodies in chosen for b in bodies))
        jointed = self._m.jnt_bodyid[self._m.jnt_type != JointKind.FREE]
        counts = [int(np.isin(jointed, bodies).sum()) for bodies in forest]
        if any(shaped := [count > 0 and any(map(self._geoms.of, bodies)) for count, bodies in zip(counts, forest, strict=True)]):
            # points of deformable bodies have joints and no shapes
            counts = [count * has_shapes for count, has_shapes in zip(counts, shaped, strict=True)]
        if max(counts, default=0) == 0 and self._options.driven is None:
            return None
        loose = [k for k, bodies in enumerate(forest) if np.isin(self._m.jnt_bodyid, bodies).any()]
        if max(counts, default=0) == 0 and len(loose) == 1:
            return forest[loose[0]]
        if not forest or (max(counts) == 0 and not self._free_root()):
            valid = (
                'at least 1 besides those of loose bodies; load_room reads a room, avatar="name" takes a loose body, root="free" '
                'lets a body without joints go where its user goes'
            )
            raise InvalidFile(f"joints of {self._file}", 0, valid)
        # of trees with equally many joints the one with a free root
        everything = [int(np.isin(self._m.jnt_bodyid, bodies).sum()) for bodies in forest]
        return forest[max(range(len(forest)), key=lambda k: (counts[k], everything[k]))]

    def _tree_with(self, name: str, forest: list[tuple[int, ...]]) -> tuple[int, ...]:
        """Return the tree that has a body of this name."""
        for bodies in forest:
            if name in {self._names[b] for b in bodies}:
                return bodies
        known = [name for b, name in self._names.items() if b > 0]
        raise UnknownName(f"body of {self._file} to be the avatar", name, known)

    def _free_root(self) -> bool:
        """Return True if a root without a joint is free.
        It is in URDF, which cannot state it, unless the file or the user fixes it."""
        root = self._options.joints.root
        return root == "free" or (root == "file" and self._m.free_root)

    def _tree(self, bodies: tuple[int, ...]) -> Tree:
        if len(bodies) > caps.LINKS:
            raise InvalidFile(f"bodies of the avatar in {self._file}", len(bodies), f"up to {caps.LINKS}")
        wanted = self._options.joints
        if self._free_root():
            wanted = replace(wanted, root="free")
        tree = tree_of(self._m, bodies, wanted, self._file)
        self._notes += tree.notes
        if self._m.body_mocapid[tree.root] >= 0 and not tree.is_free:
            self._notes.append(f'{self._names[tree.root]} is a mocap body and stays where it is; root="free" lets it go')
        return tree

    def _start(self, tree: Tree, avatar: Avatar, coordinates: Coordinates) -> TrackerSample:
        """Return the start posture, each hinge and slide within its limits."""
        own = [j for j in range(len(self._m.jnt_name)) if self._m.jnt_bodyid[j] in tree.bodies]
        widths = {JointKind.FREE: 7, JointKind.BALL: 4}
        addresses = [(int(self._m.jnt_qposadr[j]), widths.get(JointKind(int(self._m.jnt_type[j])), 1)) for j in own]
        row = [self._pose.qpos[first : first + width] for first, width in addresses]
        if tree.is_free and not any(self._m.jnt_type[j] == JointKind.FREE for j in own):
            row = [*self._pose.root(tree.root), *row]
        posture = coordinates.motion(np.concatenate([np.zeros(0), *row])[None], np.zeros(1)).sample(0)
        axes = [axis for link in avatar.links for axis in axes_of(link.joint)]
        angles = [min(max(angle, axis.lower), axis.upper) for angle, axis in zip(posture.angles, axes, strict=True)]
        if beyond := int((np.abs(angles - posture.angles) > LIMIT_ROUNDING).sum()):
            self._notes.append(f"{beyond} joints start at their limits, beyond which the file has them at the start")
        return replace(posture, angles=avatar.with_followers(np.array(angles, dtype=np.float64)))

    def _material_of_link(self, body: int) -> str:
        """Return the material of the link that carries a body."""
        return self._laws.material(self._names[body], self._geoms.of(body) if body else (), self._options.materials[0])

    def _world(self) -> list[Body]:
        """Return a fixed body for each geom of the world."""
        found = []
        for geom in self._geoms.of(0):
            name = self._own_name(self._m.geom_name[geom] or f"{WORLD} {geom}")
            pieces = self._geoms.pieces(geom, np.zeros(3), UNTURNED)
            self._visuals[name] = self._geoms.visuals({0: (np.zeros(3), UNTURNED)}, (geom,))
            found.append(fixed(name, pieces, self._laws.material(name, (geom,), self._options.materials[1])))
            self._parts[name] = Part(name, (0,), (geom,), 0)
        return found

    def _body(self, bodies: tuple[int, ...]) -> list[Body]:
        """Return a tree that no user drives, rigid in its reference posture: loose if its root is free, else fixed.

        A mocap body becomes a moving one."""
        geoms = [g for b in bodies for g in self._geoms.of(b)]
        joints = [int(j) for j in np.flatnonzero(np.isin(self._m.jnt_bodyid, bodies))]
        is_loose = any(self._m.jnt_type[j] == JointKind.FREE for j in joints)
        held = sum(self._m.jnt_type[j] != JointKind.FREE for j in joints)
        if held and np.isin(self._m.geom_bodyid, bodies).any():
            named = self._names[bodies[0]]
            self._notes.append(f"{named} is no avatar: its {held} joints stay at the reference{self._driven_too(bodies)}")
        if not geoms:
            return []
        name = self._own_name(self._names[bodies[0]])
        poses = {bodies[0]: (np.zeros(3), UNTURNED)}
        for b in bodies[1:]:
            origin, frame = poses[int(self._m.body_parentid[b])]
            poses[b] = origin + rotation.rotate(frame, self._m.body_pos[b]), rotation.multiply(frame, self._m.body_quat[b])
        pieces = tuple(p for b in bodies for g in self._geoms.of(b) for p in self._geoms.pieces(g, *poses[b]))
        place, frame = self._pose.root(bodies[0])
        at, turn = vector_of(place), quaternion_of(frame)
        self._frames[name] = poses
        self._parts[name] = Part(name, bodies, tuple(geoms), bodies[0] if is_loose else 0)
        material = self._laws.material(name, geoms, self._options.materials[1])
        if self._m.body_mocapid[bodies[0]] >= 0:
            mass = self._masses.of(bodies, poses, pieces).mass
            self._moving.append(moving(name, pieces, material, position=at, orientation=turn, mass=mass))
            self._notes.append(f"{name} is a mocap body: it goes where its pose is given, as a moving body")
            return []
        if is_loose:
            return [simulated(name, pieces, material, self._masses.of(bodies, poses, pieces), at, turn)]
        return [fixed(name, pieces, material, at, turn)]

    def _driven_too(self, bodies: tuple[int, ...]) -> str:
        """Return the option that makes one avatar of all trees that joints move, for one of them; none where roots are free."""
        # points of deformable bodies have joints and no geoms
        moved = [own for own in trees(self._m)
                 if np.isin(self._m.jnt_bodyid, own).any() and np.isin(self._m.geom_bodyid, own).any()]
        free = self._m.jnt_bodyid[self._m.jnt_type == JointKind.FREE]
        fixed = [self._names[own[0]] for own in moved if not np.isin(free, own).any()]
        if self._options.driven is False or self._m.is_urdf or self._names[bodies[0]] not in fixed or len(fixed) < 2:
            return ""
        listed = ", ".join(f'"{name}"' for name in fixed)
        return f"; avatar=({listed}) drives all of them"

    def _own_name(self, name: str) -> str:
        """Return a name that no other part of the room has."""
        found, k = name, 2
        while found in self._parts or found == self._title:
            found, k = f"{name} {k}", k + 1
        return found

    def _ignored(self, tree: Tree, skeleton: Skeleton) -> tuple[tuple[str, str], ...]:
        """Return pairs of links that never touch, besides parent and child: by welds, by exclusions of the file, by masks."""
        parent = {link.name: link.parent for link in skeleton.links}
        parts = self._link_parts(tree, self._names)
        found, masked, adjacent = [], 0, 0
        excluded = set(self._filter.excluded_pairs(parts))
        for k, two in enumerate(parts):
            for j, one in enumerate(parts[:k]):
                apart = self._filter.apart(one, two)
                adjacent += self._filter.states(one, two) and (apart or parent[two.name] == one.name)
                if parent[two.name] != one.name and (apart or (j, k) in excluded):
                    found.append((one.name, two.name))
                    masked += not apart
        if masked:
            self._notes.append(f"{masked} pairs of links never touch, as the file has it (exclude, contype, conaffinity)")
        if adjacent:
            self._notes.append(f"{adjacent} pairs of links never touch, though the file states them: a joint or a weld has both")
        return tuple(found)

    def _link_parts(self, tree: Tree, names: dict[int, str]) -> list[Part]:
        """Return the links that collide, as parts."""
        return [
            Part(names[b], (b,), tuple(self._geoms.of(b)), tree.weld[b], self._above(tree, tree.weld[b]))
            for b in tree.bodies if self._geoms.of(b)
        ]

    def _above(self, tree: Tree, weld: int) -> int:
        """Return the weld that a weld of the tree is jointed to; for a free one none."""
        if weld == 0 or (weld == tree.root and tree.is_free):
            return -1
        return tree.weld[int(self._m.body_parentid[weld])]

    def _excluded(self, tree: Tree | None, avatar: Avatar | None) -> tuple[tuple[str, str], ...]:
        """Return pairs of parts, not two links, that never touch: a fixed link and the room, and exclusions of the file."""
        room = list(self._parts.values())
        names = {} if tree is None or avatar is None else self._scene_names(tree, avatar)
        links = [] if tree is None else self._link_parts(tree, names)
        parts, first = [*room, *links], len(room)
        found = [(one.name, two.name) for two in links if two.weld == 0 for one in room if one.weld == 0]
        masked = [(parts[i].name, parts[j].name) for i, j in self._filter.excluded_pairs(parts) if i < first]
        if masked:
            self._notes.append(f"{len(masked)} pairs with bodies never touch, as the file has it (exclude, contype, conaffinity)")
        return (*found, *masked)

    def _scene_names(self, tree: Tree, avatar: Avatar) -> dict[int, str]:
        """Return the scene names of the links that carry bodies."""
        alone = len(avatar.links) == 1
        return {b: avatar.name if alone else f"{avatar.name}/{self._names[b]}" for b in tree.bodies}

    def _welds(
        self, tree: Tree | None, avatar: Avatar | None, start: TrackerSample | None, bodies: list[Body]
    ) -> dict[int, tuple[str, str]]:
        """Return loose bodies and the links or moving bodies that welds attach them to, by the number of the equality.

        None at a keyframe that is not the reference, where welded bodies are apart."""
        if self._pose.key >= 0 and not np.allclose(self._pose.qpos, self._m.qpos0, rtol=0.0, atol=1e-6):
            return {}
        loose = {body.name for body in bodies if body.role is Role.SIMULATED}
        carried = {part.bodies[0]: name for name, part in self._parts.items() if name in loose}
        carrying = {self._parts[one.name].bodies[0]: one.name for one in self._moving}
        if tree is not None and avatar is not None and start is not None and not start.angles.any():
            carrying |= self._scene_names(tree, avatar)
        return attaching_welds(self._m, carried, carrying)

    def _note_equalities(self, welds: Container[int]) -> None:
        """Report equalities other than joint couplings and deformable bodies, which are left out, and planes."""
        left = [
            self._m.eq_name[k] or f"{EqualityKind(int(kind)).name.lower()} {k}"
            for k, kind in enumerate(self._m.eq_type)
            if kind != EqualityKind.JOINT and self._m.eq_active0[k] and k not in welds
        ]
        if left:
            self._notes.append(f"equalities of bodies and tendons are left out, loops stay open: {', '.join(left)}")
        if self._m.flexes:
            self._notes.append(f"{self._m.flexes} deformable bodies are left out")
        planes = int((self._m.geom_type[self._geoms.touching] == GeomKind.PLANE).sum())
        if planes:
            boxes = "plane is a box" if planes == 1 else "planes are boxes"
            wide, _, deep = self._geoms.plane
            self._notes.append(f"{planes} {boxes} of {wide:.0f} m by {wide:.0f} m, {deep:.0f} m deep")


def _distinct(names: list[str]) -> dict[int, str]:
    """Make names unique, by number."""
    found: dict[int, str] = {}
    seen: set[str] = set()
    for k, name in enumerate(names):
        own, count = name, 2
        while own in seen:
            own, count = f"{name} {count}", count + 1
        seen.add(own)
        found[k] = own
    return found
