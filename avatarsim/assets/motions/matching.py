"""Mapping of a file's columns to generalized coordinates and back: by the joints' names if it has them, else by order."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.coordinates import WIDTHS, Coordinates
from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.archive import Archive
from avatarsim.errors import InvalidFile, InvalidInput, UnknownName
from avatarsim.scene.joint import LONGEST_SLIDE, MANY_TURNS
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation
from avatarsim.spatial.rotation import Array

Columns = NDArray[np.int64]

ORDERS = {"wxyz": (0, 1, 2, 3), "xyzw": (3, 0, 1, 2)}
"""Orders of a quaternion in files, and the indices of its w, x, y and z."""

FARTHEST = 1e5
"""Largest coordinate [m] of a root. Recordings are made indoors; larger values mean another unit or a shifted column."""

SHORTEST, LONGEST = 0.5, 1.5
"""Lengths between which a stored quaternion is taken as a rotation: blends of them leave some that are off 1. Further out is a
shifted column."""

NAMED = 8
"""Most names in a message on names that do not fit."""


@dataclass(frozen=True)
class Layout:
    """Meaning of the columns of a file's table.

    joints  names in the file's order; None for a file without names, whose order is the model's
    order   of quaternions, of ORDERS
    rooted  whether position and quaternion of the root come first, before the named joints"""

    joints: tuple[str, ...] | None
    order: str
    rooted: bool = True


def listed(joints: str | Iterable[str] | None) -> tuple[str, ...] | None:
    """Return joint names listed by a user; text is split at its commas."""
    if isinstance(joints, str):
        joints = [name.strip() for name in joints.split(",")]
    return None if joints is None else tuple(joints)


def pickles_note(archive: Archive) -> list[str]:
    """Return a sentence on entries of an archive that are not read."""
    left = shortened(archive.left_out)
    return [f"{archive.name}: left out, {left}: Python objects (a pickle) are not read"] if left else []


def require_order(order: str) -> str:
    """Return `order` if it is one of ORDERS. Raises UnknownName."""
    if order not in ORDERS:
        raise UnknownName("quaternion", order, ORDERS)
    return order


def coordinates_of_model(name: str, model: Model) -> Coordinates:
    """Return the coordinates of a model with an avatar; InvalidFile, which names the motion's file, for a room."""
    if model.avatar is None or model.coordinates is None:
        raise InvalidFile(f"avatar for {name}", None, "a model with an avatar: a robot in MJCF or URDF, a skeleton")
    return model.coordinates


def columns(name: str, layout: Layout, width: int, coordinates: Coordinates) -> Columns:
    """Return for each generalized coordinate its column in a table of `width` columns; -1 for fixed ones, which never change.

    Raises InvalidFile, with the missing columns."""
    free = [slot.name for slot in coordinates.slots if slot.kind == "free"]
    if layout.joints is None:
        if width != coordinates.width:
            # each joint, with its count of numbers if that is not one
            widths = ((slot.name, WIDTHS[slot.kind]) for slot in coordinates.slots)
            joints = ", ".join(joint if count == 1 else f"{joint} ({count})" for joint, count in widths)
            valid = f"{coordinates.width}: {joints}; joints= says names for another order"
            raise InvalidFile(f"columns of {name}, which names no joints,", width, valid)
        starts = [sum(WIDTHS[slot.kind] for slot in coordinates.slots[:k]) for k in range(len(coordinates.slots))]
    else:
        named = _starts(name, layout, width, coordinates, free)
        starts = [named.get(slot.name, -1) for slot in coordinates.slots]
    found: list[int] = []
    turned = ORDERS[layout.order]
    for slot, start in zip(coordinates.slots, starts, strict=True):
        if WIDTHS[slot.kind] == 1:
            found.append(-1 if slot.kind == "fixed" else start)
            continue
        if slot.kind == "free":
            found += [start, start + 1, start + 2]
            start += 3
        found += [start + k for k in turned]
    return np.array(found, dtype=np.int64)


def _starts(name: str, layout: Layout, width: int, coordinates: Coordinates, free: list[str]) -> dict[str, int]:
    """Return the first column of each joint, by name."""
    assert layout.joints is not None
    kinds = {slot.name: slot.kind for slot in coordinates.slots}
    starts: dict[str, int] = {}
    column = 0
    listed = layout.joints
    if layout.rooted and not any(joint in free for joint in listed):
        if not free:
            valid = "joints alone, since this avatar stands fixed; or an avatar that is loaded with a free root"
            raise InvalidFile(f"root of {name}", "position and quaternion", valid)
        listed = (free[0], *listed)
    for joint in listed:
        if joint in starts:
            raise InvalidFile(f"joint of {name}", joint, "names, each once")
        starts[joint] = column
        column += WIDTHS[kinds.get(joint, "hinge")]
    if not layout.rooted and (bare := [root for root in free if root not in starts]):
        valid = f'columns of {bare[0]}, or an avatar that stands fixed: root="fixed"'
        raise InvalidFile(f"root of {name}", "none", valid)
    missing = [slot.name for slot in coordinates.slots if slot.name not in starts and slot.kind != "fixed"]
    if missing:
        unused = [joint for joint in layout.joints if joint not in kinds]
        valid = f"all joints of the avatar; missing: {shortened(missing)}; not the avatar's: {shortened(unused) or 'none'}"
        raise InvalidFile(f"joints of {name}", f"{len(layout.joints)} names", valid)
    if layout.joints and not any(joint in kinds for joint in layout.joints):
        # a root alone fits any free body: another one would be driven, without any of the recorded joints
        valid = f"at least one of the avatar's: {shortened(list(kinds))}"
        raise InvalidFile(f"joints of {name}", shortened(layout.joints), valid)
    if column != width:
        raise InvalidFile(f"columns of {name}", width, f"{column}, as its joint names say")
    return starts


def columns_of(table: Array, chosen: Columns) -> Array:
    """Return generalized coordinates (F, width) of a table; 0 for fixed ones."""
    found = np.zeros((len(table), len(chosen)))
    found[:, chosen >= 0] = table[:, chosen[chosen >= 0]]
    return found


def left_alone(layout: Layout, coordinates: Coordinates) -> tuple[str, ...]:
    """Return joints of the file that the avatar does not have."""
    return tuple(joint for joint in layout.joints or () if joint not in coordinates.names)


def by_order(coordinates: Coordinates) -> str:
    """Return a sentence on the assumed order of columns, for a file without joint names, where only the width is checked."""
    # a joint fixed at the reference has a slot for each of its numbers
    count = len({slot.name for slot in coordinates.slots if slot.kind != "free"})
    root = "a root and " if any(slot.kind == "free" for slot in coordinates.slots) else ""
    return f"columns matched by order: {root}{count} joint{'' if count == 1 else 's'}, no names in the file"


def shortened(names: list[str] | tuple[str, ...]) -> str:
    """Join names; of many the first ones and the number of the rest."""
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more


def motion_of(name: str, q: Array, times: Array, coordinates: Coordinates) -> Motion:
    """Return the motion of rows of generalized coordinates, with quaternions without changes of sign.

    Raises InvalidFile for values that no recording has, with frame and joint."""
    first = 0
    for slot in coordinates.slots:
        width = WIDTHS[slot.kind]
        part = q[:, first : first + width]
        first += width
        if slot.kind == "fixed":
            continue
        if slot.kind == "hinge":
            require_within(name, f"angle of {slot.name}", np.abs(part[:, 0]), 0.0, MANY_TURNS, "rad")
            continue
        if slot.kind == "slide":
            require_within(name, f"way of {slot.name}", np.abs(part[:, 0]), 0.0, LONGEST_SLIDE, "m")
            continue
        if slot.kind == "free":
            require_within(name, f"distance of {slot.name} from the origin", np.abs(part[:, :3]).max(axis=1), 0.0, FARTHEST, "m")
        lengths = np.sqrt((np.clip(part[:, -4:], -1e100, 1e100) ** 2).sum(axis=1))
        require_within(name, f"length of the quaternion of {slot.name}", lengths, SHORTEST, LONGEST, "1")
    try:
        found = coordinates.motion(q, times)
    except InvalidInput as error:
        raise InvalidFile(f"{error.thing} of {name}", error.value, error.valid) from error
    return replace(found, rotations=rotation.continuous(found.rotations))


def require_within(name: str, thing: str, values: Array, least: float, most: float, unit: str) -> None:
    """Raise InvalidFile, with the frame, unless all values (F,) of a quantity are in a range."""
    bad = ~((values >= least) & (values <= most))
    if bad.any():
        frame = int(np.argmax(bad))
        raise InvalidFile(f"{thing} in frame {frame} of {name} [{unit}]", float(values[frame]), f"{least:g} to {most:g}")


def rows_near(motion: Motion, coordinates: Coordinates, near: Array | None, stayed: Array | None = None) -> Array:
    """Return generalized coordinates (F, width) of a motion, with signs of quaternions for readers that interpolate numbers.
    They change where those of `near` do, and equal them in frames that `stayed` (F,); without `near` they never change."""
    rows = coordinates.rows(motion).copy()
    first = 0
    for slot in coordinates.slots:
        end = first + WIDTHS[slot.kind]
        if slot.kind in ("free", "ball"):
            part = slice(end - 4, end)
            if near is None:
                rows[:, part] = rotation.continuous(rows[:, part])
            else:
                kept = np.zeros(len(rows), dtype=np.bool_) if stayed is None else stayed
                rows[:, part] = rotation.with_signs_of(rows[:, part], near[:, part], kept)
        first = end
    return rows
