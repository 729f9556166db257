"""Scene description for renderers: bodies with their convex pieces, as plain JSON (the idea of glTF's node list, far smaller)."""

from typing import Any

from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Sphere


def described(scene: Scene) -> dict[str, Any]:
    """Return the first message to a client: `scene`, `bodies` in the order of poses, `links` in that of samples, `hinges`.

    A body has a name, a role ("fixed", "simulated", "driven") and pieces; a piece a shape, its sizes [m], a position [m] and an
    orientation (w, x, y, z) in the body's frame."""
    pieces = [body.pieces for body in scene.bodies] + [link.pieces for link in scene.links]
    bodies = [
        {"name": name, "role": role.name.lower(), "pieces": [_piece(piece) for piece in its]}
        for name, role, its in zip(scene.names, scene.roles, pieces, strict=True)
    ]
    return {
        "scene": scene.name, "bodies": bodies, "links": list(scene.names[len(scene.bodies) :]),
        "hinges": sum(avatar.hinge_count for avatar in scene.avatars),
    }


def _piece(piece: Piece) -> dict[str, Any]:
    return {**_shape(piece), "position": list(piece.position), "orientation": list(piece.orientation)}


def _shape(piece: Piece) -> dict[str, Any]:
    match piece.shape:
        case Sphere(radius):
            return {"shape": "sphere", "radius": radius}
        case Capsule(radius, length):
            return {"shape": "capsule", "radius": radius, "length": length}
        case Box(size):
            return {"shape": "box", "size": list(size)}
        case Ellipsoid(radii):
            return {"shape": "ellipsoid", "radii": list(radii)}
        case ConvexHull(vertices):
            # imported here, since it takes longer to import than the rest of the ports
            from scipy.spatial import ConvexHull as Triangulated

            triangles = Triangulated(vertices).simplices
            return {"shape": "hull", "vertices": vertices.tolist(), "triangles": triangles.tolist()}
