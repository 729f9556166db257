"""Support feature of a shape along a direction: vertex, edge or face."""

from avatarsim.collide.support import reach
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Rows, Vec3, dot, row
from avatarsim.world.shapes import Shapes


@kernel
def foremost(vertices: Rows, shapes: Shapes, s: int, m: Vec3, band: float) -> tuple[int, Vec3, Vec3]:
    """(number of corners of shape s at most ``band`` [m] behind its farthest along m, the second of them, the first).

    With one corner both are that and zero. The ball around the points does not matter.
    """
    low = reach(vertices, shapes, s, m) - band
    p, q, count = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0
    for i in range(shapes.start[s], shapes.start[s + 1]):
        x = row(vertices, i)
        if dot(m, x) >= low:
            count += 1
            p, q = (x, p) if count < 3 else (p, q)
    return count, p, q
