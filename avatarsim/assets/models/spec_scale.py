"""Another unit of length for a model, before MuJoCo compiles it: similarity (geometric scaling) of places, shapes and moments.

A file in centimetres, or drawn four times too large, states true masses and wrong lengths: stated masses stay, moments of
inertia scale with the square of lengths, and MuJoCo derives the rest from densities. Works on an MjSpec without importing
MuJoCo.
"""

from typing import Any

import numpy as np

from avatarsim.scene.scene import EARTH

SMALLEST, LARGEST = 1e-4, 1e4
"""Metres a unit of length of a model: a tenth of a millimetre to ten kilometres. Beyond, no file uses such a unit."""


def in_metres(spec: Any, scale: float, slide: Any) -> None:
    """Multiply all lengths of a spec by `scale`, metres a unit of the file; `slide` is MuJoCo's kind of joints that slide.

    Coordinates of keyframes stay: they have no unit of their own before the model is compiled.
    """
    if scale == 1.0:
        return
    # the default gravity of a file without its own is in metres
    if tuple(spec.option.gravity) != EARTH:
        spec.option.gravity = scale * np.asarray(spec.option.gravity)
    for kind in (spec.bodies, spec.frames, spec.geoms, spec.joints, spec.sites):
        for one in kind:
            one.pos = scale * np.asarray(one.pos)
    for body in spec.bodies:
        if body.explicitinertial:
            body.ipos = scale * np.asarray(body.ipos)
            body.inertia = scale**2 * np.asarray(body.inertia)
            # nan where the file has none
            body.fullinertia = scale**2 * np.asarray(body.fullinertia)
    for geom in spec.geoms:
        geom.size = scale * np.asarray(geom.size)
        geom.fromto = scale * np.asarray(geom.fromto)
    for joint in spec.joints:
        if joint.type == slide:
            joint.range = scale * np.asarray(joint.range)
            joint.ref = scale * joint.ref
    for mesh in spec.meshes:
        mesh.scale = scale * np.asarray(mesh.scale)
        mesh.refpos = scale * np.asarray(mesh.refpos)
    for field in spec.hfields:
        field.size = scale * np.asarray(field.size)
