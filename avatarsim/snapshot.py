"""Checkpoint and restart: the state of a world between two frames as bytes, back, and into a world of other bodies.

State that the parts of a frame keep from one frame to the next is written, constants and working memory are not: they are those
of the engine that reads the bytes, which has loaded the same scene with the same settings. Bytes are not trusted: nothing in them
is run or looked up by name, no length in them is believed before it is compared, and every whole number, which might be a place
in memory, is checked against the range of its field. Nothing is written before all is valid.

Layout, little endian: a head (see `HEAD`), the bytes of all arrays one after another as zlib has them, and the BLAKE2b of all
bytes before it.
"""

import hashlib
import math
import struct
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.coupling.coupled_bodies import link_together
from avatarsim.errors import AvatarsimError, InvalidSnapshot
from avatarsim.frame import Frames
from avatarsim.jit.kept import Sizes, hints_of, is_kept, kept_names, whole_of
from avatarsim.jit.layout import unmarked
from avatarsim.lower_loop import IkLoop
from avatarsim.model.dynamics import DriveState
from avatarsim.model.geometry import place
from avatarsim.model.skeleton import Posture
from avatarsim.model.world import World
from avatarsim.paper.method import PaperLoop
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Role
from avatarsim.scene.joint import axes_of
from avatarsim.scene.scene import Scene

MAGIC = b"avatarsim\r\n\0"
"""First bytes of a snapshot; the line's end shows files that were sent as text."""

FORMAT = 1
"""Number of this layout. A change of the data or of their order takes the next one."""

DIGEST = 16
"""Bytes of a BLAKE2b. Its use is to find damage and mistakes, not to keep out forgers: the ranges do that."""

HEAD = struct.Struct(f"<{len(MAGIC)}sI{DIGEST}s{DIGEST}s{DIGEST}sdQ")
"""Magic, format, digests of scene, settings and fields, time [s], bytes of all arrays."""

COMPRESSION = 1
"""Level of zlib. Most of a world's memory is room that is not in use; higher levels take several times as long for little."""

Bits = NDArray[np.generic]


class Identity(NamedTuple):
    """Origin of a snapshot: digests of the scene, of the settings in force, and of the fields that are kept."""

    scene: bytes
    settings: bytes
    fields: bytes


class Field(NamedTuple):
    """One array that is kept, by its dotted name, and the least and largest value that its whole numbers may have."""

    name: str
    array: Bits
    least: int
    most: int


def retained_fields(frames: Frames) -> list[Field]:
    """Return the fields that the parts of a frame keep from one to the next, in order. One of whole numbers without a range is
    an error."""
    world = frames.world
    sizes = Sizes(len(world.centres), len(world.geometry.body), len(world.scene.avatars))
    return [field for part in frames.parts() for field in _retained(type(part).__name__, part.retained_state(), None, sizes)]


def _retained(path: str, value: object, annotation: Any, sizes: Sizes, inherited: bool = True) -> Iterator[Field]:
    """Yield arrays in nested named tuples, and columns of tables; numbers are constants, and records working memory."""
    kept = is_kept(annotation, inherited)
    if isinstance(value, np.ndarray) and value.dtype.names is None:
        if kept:
            yield Field(path, value, *_range(path, value, annotation, sizes))
    elif isinstance(value, np.ndarray):
        for column in value.dtype.names if kept else ():
            yield from _retained(f"{path}.{column}", value[column], hints_of(unmarked(annotation))[column], sizes)
    elif isinstance(value, tuple):
        names: Iterable[str] = getattr(value, "_fields", map(str, range(len(value))))
        for name, one in zip(names, value, strict=True):
            yield from _retained(f"{path}.{name}", one, hints_of(type(value)).get(name), sizes, kept)


def _range(path: str, array: Bits, annotation: Any, sizes: Sizes) -> tuple[int, int]:
    if array.dtype == np.bool_:
        return 0, 1
    if array.dtype == np.float64:
        return 0, 0
    if whole := whole_of(annotation):
        return whole.range_for(sizes._replace(rows=len(array)))
    raise AvatarsimError(f"no range is stated for the whole numbers in {path}: this is a defect")


def identity(scene: object, settings: object, retained: Sequence[Field]) -> Identity:
    """Return the identity of a snapshot of these fields. A scene's start is no part of it: the fields have the poses."""
    layout = tuple((field.name, field.array.dtype.str, *field.array.shape) for field in retained)
    return Identity(*map(digest_of, (scene, settings, layout)))


def digest_of(value: object) -> bytes:
    """Return a digest of nested descriptions: equal if and only if they describe the same."""
    digest = hashlib.blake2b(digest_size=DIGEST)
    for piece in _encoded(value):
        digest.update(struct.pack("<Q", len(piece)) + piece)
    return digest.digest()


def _encoded(value: object) -> Iterator[bytes]:
    """Yield a description as bytes, each with its kind before it, so that different ones never have equal bytes."""
    if is_dataclass(value) and not isinstance(value, type):
        yield type(value).__name__.encode()
        for field in fields(value):
            if field.compare:
                yield from _encoded(getattr(value, field.name))
    elif isinstance(value, np.ndarray):
        yield f"array {value.dtype.str} {value.shape}".encode()
        yield value.tobytes()
    elif isinstance(value, Mapping):
        yield f"mapping {len(value)}".encode()
        for key in sorted(value):
            yield from _encoded(key)
            yield from _encoded(value[key])
    elif isinstance(value, tuple):
        yield f"tuple {len(value)}".encode()
        for part in value:
            yield from _encoded(part)
    elif isinstance(value, int | float | np.number) and not isinstance(value, bool):
        # 1 and 1.0 describe the same
        yield f"number {float(value).hex()}".encode()
    elif value is None or isinstance(value, str | bool | Enum):
        yield f"{type(value).__name__} {value}".encode()
    else:
        raise AvatarsimError(f"a {type(value).__name__} in a scene has no digest: this is a defect")


def written(of: Identity, time: float, retained: Sequence[Field]) -> bytes:
    """Return the state that `retained` holds at `time` [s]."""
    packed = zlib.compressobj(COMPRESSION)
    body = [packed.compress(field.array.tobytes()) for field in retained]
    body.append(packed.flush())
    size = sum(field.array.nbytes for field in retained)
    whole = b"".join((HEAD.pack(MAGIC, FORMAT, *of, time, size), *body))
    return whole + hashlib.blake2b(whole, digest_size=DIGEST).digest()


def read(data: object, of: Identity, retained: Sequence[Field]) -> tuple[float, list[Bits]]:
    """Return the time [s] and new values of the `retained` arrays; InvalidSnapshot unless `data` is a whole snapshot of `of`."""
    if not isinstance(data, bytes | bytearray | memoryview):
        raise InvalidSnapshot("snapshot", data, "the bytes that engine.snapshot() returned")
    try:
        whole = bytes(data)
    except ValueError:
        raise InvalidSnapshot("snapshot", data, "bytes in memory that has not been released") from None
    if len(whole) < HEAD.size + DIGEST:
        raise InvalidSnapshot("length of the snapshot", len(whole), f"at least {HEAD.size + DIGEST} bytes: it is cut off")
    magic, layout, scene, settings, names, time, size = HEAD.unpack_from(whole)
    if magic != MAGIC:
        raise InvalidSnapshot("beginning of the snapshot", magic, f"{MAGIC!r}: these bytes are something else")
    if layout != FORMAT:
        raise InvalidSnapshot("format of the snapshot", layout, f"{FORMAT}: it is of another version of avatarsim")
    if hashlib.blake2b(whole[:-DIGEST], digest_size=DIGEST).digest() != whole[-DIGEST:]:
        raise InvalidSnapshot("checksum of the snapshot", whole[-DIGEST:].hex(), "that of its bytes: it is damaged or cut off")
    for part, found, wanted, why in (
        ("scene", scene, of.scene, "that of the scene that is loaded"),
        ("settings", settings, of.settings, "that of the preset and the options that are loaded"),
        ("fields", names, of.fields, "that of this version of avatarsim"),
    ):
        if found != wanted:
            raise InvalidSnapshot(f"digest of the {part} of the snapshot", found.hex(), f"{wanted.hex()}, {why}")
    if not 0.0 <= time < math.inf:
        raise InvalidSnapshot("time of the snapshot [s]", time, "a finite number from 0")
    return time, _arrays(_unpacked(whole[HEAD.size : -DIGEST], size, retained), retained)


def _unpacked(packed: bytes, size: int, retained: Sequence[Field]) -> bytes:
    wanted = sum(field.array.nbytes for field in retained)
    if size != wanted:
        raise InvalidSnapshot("size of the snapshot's arrays", size, f"{wanted} bytes")
    unpacking = zlib.decompressobj()
    try:
        # no more than is needed, however much is packed into it
        found = unpacking.decompress(packed, wanted + 1)
    except zlib.error as error:
        raise InvalidSnapshot("arrays of the snapshot", str(error), "bytes that zlib can unpack") from None
    if len(found) != wanted or not unpacking.eof or unpacking.unused_data:
        raise InvalidSnapshot("arrays of the snapshot", len(found), f"{wanted} bytes, and nothing behind them")
    return found


def _arrays(body: bytes, retained: Sequence[Field]) -> list[Bits]:
    found, at = [], 0
    for field in retained:
        kind: np.dtype[Any] = np.dtype(np.uint8) if field.array.dtype == np.bool_ else field.array.dtype
        array = np.frombuffer(body, kind, field.array.size, at).reshape(field.array.shape)
        at += field.array.nbytes
        if kind == np.float64:
            if np.isnan(array).any():
                raise InvalidSnapshot(f"{field.name} of the snapshot", math.nan, "numbers")
        elif array.size and not (field.least <= array.min() and array.max() <= field.most):
            spread = int(array.min()), int(array.max())
            raise InvalidSnapshot(f"range of {field.name} in the snapshot", spread, f"from {field.least} to {field.most}")
        found.append(array)
    return found


Rows = NDArray[np.int64]


# Carry-over of state from one world into another that shares bodies and avatars by name: how bodies come and go between frames.
# The new world is built as at a load, by the same checks. Of what both have, the new one takes poses and velocities to the bit,
# of avatars also the last targets of their users and the offsets that collisions have left (eq. 6). State that is found anew
# within a frame or two is not carried: sleep, warm starts of the solvers, and the search for a path.

class Shared(NamedTuple):
    """Places in the old and in the new world of all that both have, (n, 2) each: simulated bodies, avatars, links, degrees."""

    bodies: Rows
    avatars: Rows
    links: Rows
    degrees: Rows


def shared(old: World, new: World) -> Shared:
    """Return the common parts of two worlds: simulated bodies of one name; avatars of one name with equal links and joints."""
    found = {body.name: b for b, body in enumerate(old.scene.bodies) if body.role is Role.SIMULATED}
    bodies = [
        (found[body.name], b) for b, body in enumerate(new.scene.bodies) if body.role is Role.SIMULATED and body.name in found
    ]
    known = {avatar.name: (a, avatar, link) for a, (avatar, link) in enumerate(first_links(old.scene))}
    avatars: list[tuple[int, int]] = []
    links: list[tuple[int, int]] = []
    degrees: list[tuple[int, int]] = []
    for a, (avatar, link) in enumerate(first_links(new.scene)):
        before = known.get(avatar.name)
        if before is None or tree_of(before[1]) != tree_of(avatar):
            continue
        avatars.append((before[0], a))
        count, one, other = len(avatar.links), old.skeleton.first_dof[before[2] :], new.skeleton.first_dof[link:]
        links += [(before[2] + k, link + k) for k in range(count)]
        degrees += [(int(one[0]) + k, int(other[0]) + k) for k in range(int(other[count] - other[0]))]
    return Shared(*(np.array(rows, dtype=np.int64).reshape(-1, 2) for rows in (bodies, avatars, links, degrees)))


def first_links(scene: Scene) -> list[tuple[Avatar, int]]:
    """Return each avatar and the place of its first link among all."""
    firsts = np.cumsum([0, *(len(avatar.links) for avatar in scene.avatars)]).tolist()
    return list(zip(scene.avatars, firsts[:-1], strict=True))


def tree_of(avatar: Avatar) -> list[tuple[object, ...]]:
    """Return the data that fix the posture of an avatar, limits aside: names and parents of links, joint axes, couplings."""
    links = [
        (link.name, link.parent, type(link.joint), link.anchor, link.orientation,
         tuple(axis.axis for axis in axes_of(link.joint)))
        for link in avatar.links
    ]
    return [*links, avatar.couplings]


def copy_rows(into: NDArray[np.generic], of: NDArray[np.generic], rows: Rows) -> None:
    """Copy rows of one array into rows of another."""
    into[rows[:, 1]] = of[rows[:, 0]]


def take_posture(into: Posture, of: Posture, both: Shared) -> None:
    """Copy the posture of avatars that both worlds have."""
    copy_rows(into.root, of.root, both.links)
    copy_rows(into.turn, of.turn, both.links)
    copy_rows(into.angle, of.angle, both.degrees)


def carry_poses(old: World, new: World, both: Shared) -> None:
    """Carry poses and velocities of bodies, and postures of avatars: before the loops of the new world are made, and once more
    after that, since to make them places the links by their postures, which rounds."""
    links = both.links + (old.skeleton.first, new.skeleton.first)
    take_posture(new.posture, old.posture, both)
    for rows in (both.bodies, links):
        copy_rows(new.poses.position, old.poses.position, rows)
        copy_rows(new.poses.rotation, old.poses.rotation, rows)
        if new.scene.effects.dynamics:
            copy_rows(new.velocities.linear, old.velocities.linear, rows)
            copy_rows(new.velocities.angular, old.velocities.angular, rows)
    for a, b in both.bodies.tolist():
        if (old.centres[a] != new.centres[b]).any():
            # another centre of mass in the same body: the body's frame stays
            arm = new.poses.rotation[b] @ (new.centres[b] - old.centres[a])
            new.poses.position[b] += arm
            new.velocities.linear[b] += np.cross(new.velocities.angular[b], arm)
    for b in (*both.bodies[:, 1].tolist(), *links[:, 1].tolist()):
        place(new.geometry, new.poses, b)


def carry_loops(old: Frames, new: Frames, both: Shared) -> None:
    """Carry the time, and of the avatars the last targets of their users and the coupling's state; after the loops are made."""
    carry_poses(old.world, new.world, both)
    new.time = old.time
    if new.driven:
        new.lower.resume(False)
    if not (old.driven and new.driven):
        return
    take_posture(new.target.posture, old.target.posture, both)
    carry_given(old, new, both)
    one, other = old.lower, new.lower
    if isinstance(one, PaperLoop) and isinstance(other, PaperLoop):
        copy_rows(other.memory.tracked, one.memory.tracked, both.links)
        copy_rows(other.memory.velocity, one.memory.velocity, both.links)
    if isinstance(one, IkLoop) and isinstance(other, IkLoop):
        take_posture(other.state.target_before, one.state.target_before, both)
        take_posture(other.state.tracker_before, one.state.tracker_before, both)
        copy_rows(other.state.tracking.speed, one.state.tracking.speed, both.avatars)
        carry_coupling(old, new, one, other, both)


def carry_given(old: Frames, new: Frames, both: Shared) -> None:
    """Carry poses of moving bodies that both have, as they were last given."""
    if not (old.moves and new.moves):
        return
    for into, of in zip(new.given[:2], old.given[:2], strict=True):
        copy_rows(into, of, both.links)
    places = {degree: k for k, degree in enumerate(old.world.hinges.tolist())}
    hinge = {degree: k for k, degree in enumerate(new.world.hinges.tolist())}
    for before, now in both.degrees.tolist():
        if now in hinge:
            new.given[2][hinge[now]] = old.given[2][places[before]]


def carry_attached(old: World, new: World, both: Shared) -> None:
    """Attach bodies to links again, where both worlds have the two."""
    links = dict((both.links + (old.skeleton.first, new.skeleton.first)).tolist())
    for before, now in both.bodies.tolist():
        carrier = links.get(int(old.drive.carrier[before]), -1)
        if carrier >= 0:
            new.drive.carrier[now], new.drive.tied[now] = carrier, new.drive.tied[carrier]
            # places are of centres of mass, which another body of the name may have elsewhere
            turn, shift = old.drive.attached_turn[before], new.centres[now] - old.centres[before]
            new.drive.attached_place[now], new.drive.attached_turn[now] = old.drive.attached_place[before] + turn @ shift, turn
    link_together(new.drive, new.skeleton)


def carry_coupling(old: Frames, new: Frames, one: IkLoop, other: IkLoop, both: Shared) -> None:
    """Carry the state of the coupling, and tracked poses of the last frame, from which velocities are counted."""
    carry_attached(old.world, new.world, both)
    if min(one.trackers.turn[0], other.trackers.turn[0]) < 0:
        return
    links = both.links + (old.world.skeleton.first, new.world.skeleton.first)
    other.trackers.turn[:] = one.trackers.turn
    for into, of in ((other.trackers.one, one.trackers.one), (other.trackers.other, one.trackers.other)):
        copy_rows(into.position, of.position, links)
        copy_rows(into.rotation, of.rotation, links)
    for name in kept_names(DriveState):
        if name not in ("carrier", "tied", "linked"):
            copy_rows(getattr(new.world.drive, name), getattr(old.world.drive, name), links)
