"""Proofs about directions that were not sampled, against sampling many of them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.collision.ellipsoid import is_depth_kept, least_cosine, least_curvature, least_share, rolling_radius
from avatarsim.spatial.vec3 import Vec3
from tests.collision.solids import Solid, as_arrays, ball, ellipsoid, random_hull

pytestmark = pytest.mark.nojit

SEEDS = st.integers(0, 2**32 - 1)
DIRECTIONS = 400


def two_shapes(rng: np.random.Generator) -> tuple[Solid, Solid]:
    """Return an ellipsoid, needles and plates among them, and another, a ball or a hull in it, somewhat off its centre."""
    axes = 10.0 ** rng.uniform(-2.0, 0.0, 3)
    a = ellipsoid(*axes).moved(Rotation.from_quat(rng.normal(size=4)))
    b = [ellipsoid(*rng.uniform(0.01, 0.5, 3)), ball(0.1), random_hull(rng, 12).moved(scale=0.1)][rng.integers(3)]
    return a, b.moved(Rotation.from_quat(rng.normal(size=4)), rng.normal(size=3) * 0.1 * axes.min())


def units_near(rng: np.random.Generator, m: np.ndarray, angle: float) -> np.ndarray:
    """Return unit vectors (DIRECTIONS, 3) at most `angle` [rad] from m, half of them just that."""
    across = np.cross(m, rng.normal(size=(DIRECTIONS, 3)))
    t = angle * np.where(rng.uniform(size=(DIRECTIONS, 1)) < 0.5, 1.0, rng.uniform(size=(DIRECTIONS, 1)))
    return np.cos(t) * m + np.sin(t) * across / np.linalg.norm(across, axis=1, keepdims=True)


def reach(a: Solid, b: Solid, m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """h(m) of A - B without b's radius, and the point that makes it, from the definitions; of one direction or of many."""
    ends = []
    for solid, d in ((a, m), (b, -m)):
        if solid.kind == 1:
            e = d @ solid.rows[1:].T
            ends.append(solid.rows[0] + e / np.linalg.norm(e, axis=-1, keepdims=True) @ solid.rows[1:])
        else:
            ends.append(solid.rows[np.argmax(d @ solid.rows.T, axis=-1)])
    apart = ends[0] - ends[1]
    return (apart * m).sum(axis=-1), apart


def vec(v: np.ndarray) -> Vec3:
    return (float(v[0]), float(v[1]), float(v[2]))


@settings(max_examples=60, deadline=None)
@given(SEEDS)
def test_the_bend_is_nowhere_less_than_claimed(seed):
    rng = np.random.default_rng(seed)
    a, b = two_shapes(rng)
    vertices, shapes = as_arrays(a, b)
    m = rng.normal(size=3)
    m /= np.linalg.norm(m)
    angle = 10.0 ** rng.uniform(-2.0, np.log10(1.5))
    bend = least_curvature(vertices, shapes, 0, 1, vec(m), float(np.cos(angle)))
    _, w = reach(a, b, m)
    d = units_near(rng, m, angle)
    assert (reach(a, b, d)[0] >= d @ w + bend * (1.0 - d @ m) - 1e-12).all()


@settings(max_examples=60, deadline=None)
@given(SEEDS)
def test_no_direction_of_a_settled_cone_is_lower(seed):
    rng = np.random.default_rng(seed)
    a, b = two_shapes(rng)
    vertices, shapes = as_arrays(a, b)
    m = rng.normal(size=3)
    m /= np.linalg.norm(m)
    height, w = reach(a, b, m)
    angle = 10.0 ** rng.uniform(-2.0, np.log10(1.5))
    lowest = reach(a, b, units_near(rng, m, angle))[0].min()
    cos = float(np.cos(angle))
    below, size = height - lowest, max(a.size, b.size)
    assert not is_depth_kept(vertices, shapes, 0, 1, vec(m), vec(w), cos, lowest + 1e-9 * size)
    # Far enough below it is settled: the bound of the point at m alone, with no bend at all.
    across = float(np.linalg.norm(w - height * m))
    flat = height * cos - across * np.sqrt(1.0 - cos * cos)
    assert is_depth_kept(vertices, shapes, 0, 1, vec(m), vec(w), cos, min(flat, -across, height) - below - 1e-9 * size)


def test_a_ball_bends_by_its_radius():
    vertices, shapes = as_arrays(ellipsoid(0.5, 0.5, 0.5), random_hull(np.random.default_rng(1), 8).moved(scale=1e-3))
    for cos in (0.0, 0.3, 0.999):
        assert least_curvature(vertices, shapes, 0, 1, (0.0, 0.6, 0.8), cos) == pytest.approx(0.5, abs=1e-15)
    assert least_cosine(vertices, shapes, 0, 1, (0.0, 0.6, 0.8), 0.499) == 0.0
    assert least_cosine(vertices, shapes, 0, 1, (0.0, 0.6, 0.8), 0.501) == 2.0
    assert least_share(vertices, shapes, 1, (0.0, 0.6, 0.8), (0.0, 0.0, 0.0), 0.5) == 0.0


@settings(max_examples=30, deadline=None)
@given(SEEDS)
def test_what_a_rolling_ball_leaves_is_convex(seed):
    rng = np.random.default_rng(seed)
    axes = rng.uniform(0.1, 1.0, 3)
    solid = ellipsoid(*axes).moved(Rotation.from_quat(rng.normal(size=4)))
    vertices, shapes = as_arrays(solid, ball(0.1))
    rho = rolling_radius(vertices, shapes, 0)
    assert rho == pytest.approx(axes.min() ** 2 / axes.max(), rel=1e-12)
    assert rolling_radius(vertices, shapes, 1) == 0.0

    def left(d: np.ndarray, radius: float) -> np.ndarray:
        return np.linalg.norm(d @ solid.rows[1:].T, axis=-1) - radius * np.linalg.norm(d, axis=-1)

    # A support function is convex: subadditive, being homogeneous.
    p, q = rng.normal(size=(2, DIRECTIONS, 3))
    assert (left(p + q, rho) <= left(p, rho) + left(q, rho) + 1e-12).all()
    # Most curved at the tip of the longest axis, towards the shortest.
    tip = solid.rows[1 + np.argmax(axes)] / axes.max()
    side = 1e-3 * solid.rows[1 + np.argmin(axes)] / axes.min()
    assert 2.0 * left(tip, 1.01 * rho) > left(tip + side, 1.01 * rho) + left(tip - side, 1.01 * rho)
