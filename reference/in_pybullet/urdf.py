"""An avatar as a URDF file: only there Bullet takes limits of spherical joints.

Bullet bounds three angles of such a joint: two of the direction of the link's z axis, about x and y, and the twist about z. So a
circular cone becomes the pyramid around it, which touches it on four sides and is up to 16 degrees wider in its corners.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pybullet
from numpy.typing import NDArray

from avatarsim.scene.joint import SwingTwist
from avatarsim.scene.shape import Box, Capsule, Shape, Sphere
from avatarsim.spatial import rotation
from reference.in_pybullet.shapes import Placed, vertices_of, wxyz
from reference.in_pybullet.unsupported import WIDEST

Array = NDArray[np.float64]

UNLIMITED = 4.0
"""Range [rad] that no angle exceeds."""

NARROWEST = 1e-9
"""Range [rad] of an angle that is locked; Bullet takes 0 for a joint without limits."""

EFFORT = 1e6
"""Largest impulse [N m s] of a limit. Smaller than those that move an avatar: limits give way; 0: no limit at all."""

KINDS = {pybullet.JOINT_SPHERICAL: "spherical", pybullet.JOINT_FIXED: "fixed", pybullet.JOINT_REVOLUTE: "continuous"}


def zero(limits: SwingTwist) -> Array:
    """Return the turn of a link in its parent's frame from which Bullet counts: the limb in the middle of its cone, in the middle
    of its twist."""
    twist = rotation.from_axis_angle(limits.axis, 0.5 * sum(limits.twist))
    return np.asarray(rotation.multiply(rotation.between(limits.axis, limits.centre), twist))


def along_limb(limits: SwingTwist, moments: Array, frame: Array) -> tuple[Array, Array]:
    """Return principal moments (3,) and their frame, reordered to have z on the principal axis nearest to the limb."""
    limb, axes = np.array(limits.axis), rotation.to_matrix(frame)
    if np.ptp(moments) <= 1e-12 * moments.max():
        return moments, np.asarray(rotation.between((0.0, 0.0, 1.0), limb))
    nearest = int(np.argmax(np.abs(limb @ axes)))
    if limb @ axes[:, 2] > 0.0 and nearest == 2:
        return moments, frame
    order = [(nearest + 1) % 3, (nearest + 2) % 3, nearest]
    axes = axes[:, order]
    return moments[order], rotation.from_matrix(axes if limb @ axes[:, 2] > 0.0 else axes * (1.0, -1.0, -1.0))


def load(base: Mapping[str, Any], shape: list[Placed], columns: Mapping[str, list[Any]], shapes: list[list[Placed]],
         limits: Mapping[int, SwingTwist], client: int) -> int:
    """Load the multibody of `base` and `columns`, arguments of createMultiBody, with `limits` by joint; return its number."""
    with TemporaryDirectory() as folder:
        lines = [_link("base", base.get("baseMass", 0.0), base.get("baseInertialFramePosition", (0.0,) * 3), shape, Path(folder))]
        for k, parts in enumerate(shapes):
            row = {name: values[k] for name, values in columns.items()}
            lines.append(_link(f"link{k}", row["linkMasses"], row["linkInertialFramePositions"], parts, Path(folder)))
            lines.append(_joint(k, row, limits.get(k)))
        path = Path(folder) / "avatar.urdf"
        path.write_text("\n".join(['<robot name="avatar">', *lines, "</robot>", ""]), encoding="utf-8")
        place = {name: base[name] for name in ("basePosition", "baseOrientation") if name in base}
        return int(pybullet.loadURDF(
            str(path), **place, useFixedBase=not base, flags=pybullet.URDF_USE_SELF_COLLISION, physicsClientId=client,
        ))


def _link(name: str, mass: float, centre: Sequence[float], parts: list[Placed], folder: Path) -> str:
    """Return the text of a link; its inertia is set when it is loaded."""
    inertia = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
    met = "".join(
        f"<collision>{_origin(place, turn)}<geometry>{_geometry(shape, folder / f'{name}.{k}.stl')}</geometry></collision>"
        for k, (shape, place, turn) in enumerate(parts)
    )
    return f'<link name="{name}"><inertial>{_origin(centre)}<mass value="{mass!r}"/>{inertia}</inertial>{met}</link>'


def _joint(k: int, row: Mapping[str, Any], limits: SwingTwist | None) -> str:
    kind, parent, limit = KINDS[row["linkJointTypes"]], row["linkParentIndices"] - 1, ""
    above = f"link{parent}" if parent >= 0 else "base"
    if limits is not None:
        swing = max(limits.swing, NARROWEST) if limits.swing <= WIDEST else UNLIMITED
        twist = max(0.5 * (limits.twist[1] - limits.twist[0]), NARROWEST)
        limit = f'<limit lower="{swing!r}" upper="{swing!r}" twist="{twist!r}" effort="{EFFORT!r}"/>'
    return (
        f'<joint name="joint{k}" type="{kind}"><parent link="{above}"/><child link="link{k}"/>'
        f'{_origin(row["linkPositions"], row["linkOrientations"])}<axis xyz="{_spaced(row["linkJointAxis"])}"/>{limit}</joint>'
    )


def _origin(place: Sequence[float], turn: Sequence[float] = (0.0, 0.0, 0.0, 1.0)) -> str:
    """Return the text of a place and a turn (x, y, z, w), which URDF writes as roll, pitch and yaw."""
    matrix = rotation.to_matrix(wxyz(turn))
    roll = np.arctan2(matrix[2, 1], matrix[2, 2])
    pitch = np.arctan2(-matrix[2, 0], np.hypot(matrix[2, 1], matrix[2, 2]))
    # of the turn without its roll: at a pitch of 90 degrees roll and yaw turn about one axis, and only their sum is known
    c, s = np.cos(roll), np.sin(roll)
    yaw = np.arctan2(s * matrix[0, 2] - c * matrix[0, 1], c * matrix[1, 1] - s * matrix[1, 2])
    return f'<origin xyz="{_spaced(place)}" rpy="{_spaced((roll, pitch, yaw))}"/>'


def _spaced(numbers: Sequence[float]) -> str:
    return " ".join(repr(float(number)) for number in numbers)


def _geometry(shape: Shape | Array, file: Path) -> str:
    """Return the text of a shape. Vertices go into a binary STL, in single precision: of an OBJ file Bullet makes a compound."""
    if isinstance(shape, Sphere):
        return f'<sphere radius="{shape.radius!r}"/>'
    if isinstance(shape, Box):
        return f'<box size="{_spaced(shape.size)}"/>'
    if isinstance(shape, Capsule):
        return f'<capsule radius="{shape.radius!r}" length="{shape.length!r}"/>'
    vertices = vertices_of(shape)
    assert vertices is not None
    # a fan of triangles that names every vertex: a normal, three corners and an attribute each
    faces = np.zeros(len(vertices) - 2, dtype=[("floats", "<f4", (4, 3)), ("attribute", "<u2")])
    faces["floats"][:, 1], faces["floats"][:, 2], faces["floats"][:, 3] = vertices[0], vertices[1:-1], vertices[2:]
    file.write_bytes(bytes(80) + np.array(len(faces), dtype="<u4").tobytes() + faces.tobytes())
    return f'<mesh filename="{file.name}"/>'
