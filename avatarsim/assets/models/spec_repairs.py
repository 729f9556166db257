"""Changes of a model before MuJoCo compiles it: masses for which it would refuse the model, pictures that it would open.

Moments of inertia that no solid has (zero, negative ones about the principal axes, one above the sum of the others; Featherstone
2008, 2.13) become the nearest that one can have. Works on an MjSpec without importing MuJoCo.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets import caps
from avatarsim.errors import InvalidFile

Array = NDArray[np.float64]

LEAST = 1e-12
"""Mass [kg] and moments of inertia [kg m^2] of bodies without any in the file: MuJoCo refuses moving bodies without."""

SMALLEST_SHARE = 1e-6
"""Smallest moment of inertia, as a share of the largest one: thinner is no solid."""

SMALL_BALL = 0.4 * 1e-2**2
"""Moment of inertia [m^2] for each kilogram of a body that has mass and no moments: that of a ball of 1 cm."""

FLAT = 2
"""Width [pixels] of the replacement of a texture, and rows of the replacement of a height field."""


def bare(spec: Any, mujoco: Any) -> None:
    """Replace textures and height fields by plain ones, so that no picture is opened, and remove unused parts.
    These are skins, actuators, sensors, tuples and simulation memory. Raises InvalidFile for too many keyframes."""
    if len(spec.keys) > caps.KEYFRAMES:
        raise InvalidFile("number of keyframes", len(spec.keys), f"up to {caps.KEYFRAMES}")
    for texture in spec.textures:
        texture.file, texture.builtin = "", mujoco.mjtBuiltin.mjBUILTIN_FLAT
        texture.cubefiles = [""] * len(texture.cubefiles)
        texture.width = FLAT
        texture.height = FLAT if texture.type == mujoco.mjtTexture.mjTEXTURE_2D else 6 * FLAT
    for field in spec.hfields:
        field.file, field.nrow, field.ncol, field.userdata = "", FLAT, FLAT, [0.0] * FLAT**2
    for unread in (*spec.skins, *spec.tuples, *spec.actuators, *spec.sensors):
        spec.delete(unread)
    for key in spec.keys:
        # of removed actuators
        key.ctrl, key.act = [], []
    # no memory for a simulation, since a file may request any amount
    spec.memory = spec.nconmax = spec.njmax = spec.nstack = -1


def with_solid_moments(spec: Any) -> list[str]:
    """Give every body moments of inertia that a solid can have; return names of changed bodies."""
    # bodies with neither mass nor moments get these values, which identify them afterwards
    spec.compiler.boundmass = spec.compiler.boundinertia = LEAST
    changed = []
    for body in spec.bodies:
        if not body.explicitinertial:
            continue
        xx, yy, zz, xy, xz, yz = (float(value) for value in body.fullinertia)
        is_full = not np.isnan(xx)
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) if is_full else np.diag(body.inertia)
        if not np.isfinite(inertia).all():
            continue
        found, is_changed = solid(inertia, float(body.mass))
        if not is_changed:
            continue
        if body.mass > LEAST:
            changed.append(body.name)
        if is_full:
            body.fullinertia = [*np.diag(found), found[0, 1], found[0, 2], found[1, 2]]
        else:
            body.inertia = np.diag(found)
    return changed


def solid(inertia: Array, mass: float) -> tuple[Array, bool]:
    """Return the nearest inertia (3, 3) that a solid can have, and whether it differs."""
    moments, axes = np.linalg.eigh(inertia)
    largest = float(moments[2])
    if not largest > LEAST * SMALL_BALL:
        return max(mass, LEAST) * SMALL_BALL * np.eye(3), True
    mended = np.maximum(moments, max(SMALLEST_SHARE * largest, LEAST))
    lacking = 0.5 * (float(mended[2]) * (1.0 + 1e-9) - float(mended[0] + mended[1]))
    if lacking > 0.0:
        mended[:2] += lacking
    if np.abs(mended - moments).max() <= 1e-8 * largest:
        return inertia, False
    found = axes @ np.diag(mended) @ axes.T
    return np.asarray(0.5 * (found + found.T)), True
