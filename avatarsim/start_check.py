"""Is a pose free? Asked once at load, of every pair the scene filters in."""

from avatarsim.collide.scratch import make_scratch
from avatarsim.collide.signed_distance import signed_distance
from avatarsim.errors import InvalidScene, StartOverlaps
from avatarsim.posture.limits import cone_excess, has_cone
from avatarsim.spatial.tangent import columns
from avatarsim.world.skeleton import BALL, HINGES
from avatarsim.world.world import World

TOUCHING = 1e-9
"""[m] deeper than this is overlap; resting contact described in decimal numbers may be off by rounding."""


def overlapping_pairs(world: World) -> list[tuple[str, str, float]]:
    """Every wanted pair that overlaps, by name, with its depth [m], one entry per pair of bodies."""
    geo, poses, names = world.geometry, world.poses, world.scene.names
    scratch, found = make_scratch(), []
    for a in range(len(names)):
        for b in range(a + 1, len(names)):
            meet = (poses.hulls[a, :3] <= poses.hulls[b, 3:]).all() and (poses.hulls[b, :3] <= poses.hulls[a, 3:]).all()
            if not geo.wanted[a, b] or not meet:
                continue
            depth = 0.0
            for s in range(geo.first_shape[a], geo.first_shape[a + 1]):
                for t in range(geo.first_shape[b], geo.first_shape[b + 1]):
                    gap = signed_distance(poses.vertices, geo.shapes, s, t, (0.0, 0.0, 0.0), scratch)[1]
                    depth = max(depth, -gap)
            if depth > TOUCHING:
                found.append((names[a], names[b], depth))
    return found


def require_within_limits(world: World) -> None:
    """Raise InvalidScene when the first posture is beyond a joint limit: it could not be shown."""
    skel = world.skeleton
    for i, link in enumerate(world.scene.links):
        if skel.kind[i] == HINGES:
            for j in range(skel.first_dof[i], skel.first_dof[i + 1]):
                angle, (low, high) = world.posture.angle[j], skel.limits[j]
                if not low <= angle <= high:
                    raise InvalidScene(f"start angle of a hinge of {link.name} [rad]", float(angle), f"{low:g} to {high:g}")
        elif skel.kind[i] == BALL and has_cone(skel, i):
            excess = cone_excess(skel, i, columns(world.posture.turn, i))
            if not excess <= 0.0:
                thing = f"start rotation of {link.name} beyond its swing and twist limits [rad]"
                raise InvalidScene(thing, float(excess), "0 or less")


def require_free(world: World) -> None:
    """Raise StartOverlaps when the first pose is not free."""
    found = overlapping_pairs(world)
    if found:
        raise StartOverlaps(found)
