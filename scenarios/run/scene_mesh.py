"""What a page needs to draw a scene and to weigh its bodies: one small file per scene, beside the recordings."""

from pathlib import Path

from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Piece, Sphere
from runfiles.files import write_json
from scenarios.measure.posture.joints import places

FOLDER = "scenes"
"""Where these files lie in a run's folder, and later the pages of the scenes."""
SCHEMA_VERSION = 1
"""Layout of the file; a reader refuses every other."""
DIGITS = 7
"""Digits behind the point of a vertex [m]: a tenth of a micrometre, far below what a picture shows."""


def drawn(scene: Scene) -> dict[str, object]:
    """Bodies and links in canonical order, each with role, convex pieces and, where it is simulated, its mass; of each link its
    parent's place among the links, none of a root; and gravity."""
    carried = [body.pieces for body in scene.bodies] + [link.pieces for link in scene.links]
    masses = [body.mass for body in scene.bodies] + [None for _ in scene.links]
    return {
        "schema_version": SCHEMA_VERSION,
        "scene": scene.name,
        "gravity": list(scene.gravity),
        "parents": [place.parent for place in places(scene)],
        "bodies": [
            {
                "name": name, "role": role.name.lower(), "pieces": [_piece(piece) for piece in pieces],
                "mass": None if mass is None else {
                    "mass": mass.mass, "centre": list(mass.centre), "inertia": mass.inertia.tolist(),
                },
            }
            for name, role, pieces, mass in zip(scene.names, scene.roles, carried, masses, strict=True)
        ],
    }


def write(scene: Scene, folder: Path, name: str) -> None:
    """Write the file of scenario `name` into the run folder, unless it is there: all engines have the same scene."""
    path = folder / FOLDER / f"{name}.json"
    if not path.exists():
        write_json(path, drawn(scene))


def _piece(piece: Piece) -> dict[str, object]:
    """Kind and measures [m] of a convex shape, and where it sits on its body."""
    shape = piece.shape
    measures: dict[str, object]
    if isinstance(shape, Sphere):
        measures = {"kind": "sphere", "radius": shape.radius}
    elif isinstance(shape, Capsule):
        measures = {"kind": "capsule", "radius": shape.radius, "length": shape.length}
    elif isinstance(shape, Box):
        measures = {"kind": "box", "size": list(shape.size)}
    elif isinstance(shape, Ellipsoid):
        measures = {"kind": "ellipsoid", "radii": list(shape.radii)}
    else:
        measures = {"kind": "hull", "vertices": shape.vertices.round(DIGITS).tolist()}
    return {**measures, "position": list(piece.position), "orientation": list(piece.orientation)}
