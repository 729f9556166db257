"""Entry point `load_object`: the object of a motion file, with its shape and its recorded poses."""

from dataclasses import replace
from pathlib import Path

from avatarsim.assets.models.load import load_room
from avatarsim.assets.motions.object_poses import ObjectPoses
from avatarsim.errors import InvalidFile
from avatarsim.scene.carried import Carried
from avatarsim.scene.moving import moving
from avatarsim.scene.shape import Box, Piece
from avatarsim.spatial import rotation


def load_object(poses: ObjectPoses, path: str | Path | None = None, *, scale: float | None = None) -> Carried:
    """Return an object of a motion file as a body that is carried, with its recorded poses: for `clean` and `audit`.

    Args:
        poses: `load_motion(...).object`.
        path: a mesh, MJCF or URDF file with the object's shape, in the frame of its poses; of one body in that body's own frame.
            None for the box of the size that the motion file states.
        scale: metres a unit of length of the file; by default as the motion file states it, else 1.

    Raises:
        InvalidFile: for a file without shapes, and for a motion file that states no size where no file is given. Errors of
            `load_room`.
    """
    if path is None:
        if poses.size is None:
            raise InvalidFile(f"shape of {poses.name}", None, "object=FILE with a mesh, MJCF or URDF: the motion states no size")
        pieces: tuple[Piece, ...] = (Piece(Box(poses.size)),)
    else:
        room = load_room(path, scale=(poses.scale or 1.0) if scale is None else scale).room
        if len(room) == 1:
            pieces = room[0].pieces
        else:
            pieces = tuple(
                replace(
                    piece, orientation=tuple(rotation.multiply(body.orientation, piece.orientation).tolist()),
                    position=tuple((rotation.rotate(body.orientation, piece.position) + body.position).tolist()),
                )
                for body in room for piece in body.pieces
            )
        if not pieces:
            raise InvalidFile(f"shape of {poses.name} in {Path(path).name}", None, "at least one shape that collides")
    first = poses.motion
    return Carried(
        moving(
            poses.name, pieces, "wood", position=tuple(first.positions[0, 0].tolist()),
            orientation=tuple(first.rotations[0, 0].tolist()),
        ),
        first,
    )
