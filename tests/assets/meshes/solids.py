"""Small meshes with known answers."""

import numpy as np
import trimesh
from numpy.typing import NDArray

from avatarsim.assets.meshes.mesh import Mesh

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Soup = tuple[Array, Indices]

ELL = np.array([(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)])
ELL_CAPS = ((0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5))
"""Triangles of the face of an L with arms 3 long and 1 wide."""

CHANNEL = np.array([(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (2.0, 2.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)])
CHANNEL_CAPS = ((0, 1, 4), (0, 4, 5), (1, 2, 3), (1, 3, 4), (0, 5, 6), (0, 6, 7))
"""Triangles of the face of a U 3 wide and 2 high, with a notch 1 wide and 1 deep."""


def prism(outline: Array, caps: tuple[tuple[int, int, int], ...], height: float = 1.0) -> Soup:
    """Return a counter-clockwise outline (n, 2) extruded from z = 0 to `height`; triangles face outwards."""
    n = len(outline)
    vertices = np.vstack([np.c_[outline, np.zeros(n)], np.c_[outline, np.full(n, height)]])
    below = [(a, c, b) for a, b, c in caps]
    above = [(a + n, b + n, c + n) for a, b, c in caps]
    sides = [side for i in range(n) for j in [(i + 1) % n] for side in ((i, j, j + n), (i, j + n, i + n))]
    return vertices, np.array([*below, *above, *sides], dtype=np.int64)


def ell() -> Soup:
    return prism(ELL, ELL_CAPS)


def channel() -> Soup:
    return prism(CHANNEL, CHANNEL_CAPS)


def cube(low: float = 0.0, high: float = 1.0) -> Soup:
    square = np.array([(low, low), (high, low), (high, high), (low, high)])
    vertices, triangles = prism(square, ((0, 1, 2), (0, 2, 3)), high - low)
    return vertices + [0.0, 0.0, low], triangles


def torus(ring: float = 1.0, tube: float = 0.3, around: int = 24, across: int = 12) -> Soup:
    """Return a torus about z, closed and facing outwards."""
    u, v = np.meshgrid(2 * np.pi * np.arange(around) / around, 2 * np.pi * np.arange(across) / across, indexing="ij")
    out = ring + tube * np.cos(v)
    vertices = np.stack([out * np.cos(u), out * np.sin(u), tube * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = (k.ravel() for k in np.meshgrid(np.arange(around), np.arange(across), indexing="ij"))
    a, b = i * across + j, (i + 1) % around * across + j
    c, d = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
    return vertices, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def together(*soups: Soup) -> Soup:
    """Return several meshes as one list of vertices and triangles."""
    shift = np.cumsum([0, *(len(vertices) for vertices, _ in soups)])
    triangles = [t + s for (_, t), s in zip(soups, shift, strict=False)]
    return np.concatenate([vertices for vertices, _ in soups]), np.concatenate(triangles)


def mesh(soup: Soup, name: str = "thing") -> Mesh:
    vertices, triangles = soup
    return Mesh(name, vertices, triangles, np.zeros(len(triangles), dtype=np.int64))


def obj_text(*soups: Soup) -> str:
    """Return an OBJ file with one group per mesh."""
    lines, first = [], 1
    for k, (vertices, triangles) in enumerate(soups):
        lines.append(f"o part{k}")
        lines += [f"v {float(x)!r} {float(y)!r} {float(z)!r}" for x, y, z in vertices]
        lines += ["f " + " ".join(str(first + corner) for corner in triangle) for triangle in triangles]
        first += len(vertices)
    return "\n".join(lines) + "\n"


def surface_points(soup: Soup, count: int, seed: int = 0) -> Array:
    """Return points distributed uniformly at random over the surface."""
    return np.asarray(trimesh.sample.sample_surface(trimesh.Trimesh(*soup, process=False), count, seed=seed)[0])


def knot() -> Soup:
    """Return a torus of which one vertex is pulled across its hole, through the other side."""
    vertices, triangles = torus(around=12, across=8)
    vertices[0] += [-2.2, 0.07, 0.03]
    return vertices, triangles


def through(soup: Soup) -> Soup:
    """Return a mesh with a turned copy of it, which intersect; no edge of one lies in a face of the other."""
    turn = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    return together(soup, (soup[0] @ turn.T + [0.3, 0.2, 0.4], soup[1]))
