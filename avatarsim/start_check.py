"""Is a pose free? Asked once at load, of every pair the scene filters in."""

from avatarsim.collide.scratch import make_scratch
from avatarsim.collide.signed_distance import signed_distance
from avatarsim.errors import StartOverlaps
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


def require_free(world: World) -> None:
    """Raise StartOverlaps when the first pose is not free."""
    found = overlapping_pairs(world)
    if found:
        raise StartOverlaps(found)
