"""Proofs by axes: all axes of two polytopes against the hull of all differences, many placements at once against each alone."""

import numpy as np
import pytest

from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Shape, Sphere, ellipsoid_hull
from avatarsim.spatial import rotation
from reference.judging.geometry import Outline
from reference.judging.minkowski import signed_distance
from reference.judging.proof import hold, in_parts, largest_over_axes, largest_over_faces

BOX, PLATE, EGG = Box((0.3, 0.2, 0.4)), Box((0.5, 0.4, 0.01)), ellipsoid_hull((0.1, 0.15, 0.2))


def placements(seed: int, count: int, turned: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return turns of either shape (count, 3, 3) by about `turned` [rad], and offsets (count, 3) [m]; every fifth on a grid,
    where faces and edges are aligned."""
    random = np.random.default_rng(seed)
    turns = rotation.to_matrix(rotation.from_rotation_vector(turned * random.normal(size=(2, count, 3))))
    offsets = random.uniform(-0.4, 0.4, (count, 3))
    offsets[::5] = 0.05 * random.integers(-6, 7, (len(offsets[::5]), 3))
    return turns[0], turns[1], offsets


@pytest.mark.parametrize("turned", [0.0, 1e-12, 1e-9, 1e-7, 1e-4, 1.0])
@pytest.mark.parametrize("pair", [(BOX, BOX), (BOX, PLATE), (BOX, EGG)])
def test_all_axes_give_the_depth_and_at_most_the_gap(pair: tuple[Shape, Shape], turned: float) -> None:
    a, b = Outline(pair[0]), Outline(pair[1])
    turns_a, turns_b, offsets = placements(3, 40, turned)
    found = largest_over_axes(a, turns_a, b, turns_b, offsets)
    exact = np.array([
        signed_distance(a.points @ ta.T + at, 0.0, b.points @ tb.T, 0.0)
        for ta, tb, at in zip(turns_a, turns_b, offsets, strict=True)
    ])
    deep = exact < 0.0
    assert 5 < deep.sum() < 40
    assert found[deep] == pytest.approx(exact[deep], abs=1e-9)
    assert (found[~deep] <= exact[~deep] + 1e-12).all() and (found[~deep] >= -1e-12).all()


@pytest.mark.parametrize("pair", [(BOX, EGG), (EGG, Sphere(0.1)), (Capsule(0.05, 0.3), PLATE), (Ellipsoid((0.1, 0.2, 0.1)), BOX)])
def test_many_placements_at_once_are_those_of_each_alone(pair: tuple[Shape, Shape], monkeypatch: pytest.MonkeyPatch) -> None:
    a, b = Outline(pair[0]), Outline(pair[1])
    turns_a, turns_b, offsets = placements(7, 30, 1.0)
    together = largest_over_faces(a, turns_a, b, turns_b, offsets)
    alone = [
        max(
            [float(-(face @ at) - a.reach(face @ ta) - b.reach(-face @ tb)) for face in a.faces @ ta.T]
            + [float(face @ at - b.reach(face @ tb) - a.reach(-face @ ta)) for face in b.faces @ tb.T]
        )
        for ta, tb, at in zip(turns_a, turns_b, offsets, strict=True)
    ]
    assert together == pytest.approx(alone, abs=1e-14)
    normals = rotation.normalised(np.random.default_rng(1).normal(size=(30, 4)))[:, :3]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    proven = np.array([
        normal @ at - a.reach(-normal @ ta) - b.reach(normal @ tb)
        for normal, ta, tb, at in zip(normals, turns_a, turns_b, offsets, strict=True)
    ])
    # the proof by its own axis holds unless a face refutes it
    sound = hold(proven, normals, a, turns_a, b, turns_b, offsets)
    assert (sound == (~(proven < 0.0) | (np.array(alone) <= proven + 1e-8))).all()
    assert not hold(proven + 1e-6, normals, a, turns_a, b, turns_b, offsets).any()
    assert not hold(np.full(30, np.nan), normals, a, turns_a, b, turns_b, offsets).any()
    monkeypatch.setattr("reference.judging.proof.AT_ONCE", 1)
    assert (hold(proven, normals, a, turns_a, b, turns_b, offsets) == sound).all()


def test_shapes_without_faces_refute_nothing() -> None:
    ball, rod = Outline(Sphere(0.1)), Outline(Capsule(0.1, 0.2))
    turns = np.tile(np.eye(3), (4, 1, 1))
    assert (largest_over_faces(ball, turns, rod, turns, np.ones((4, 3))) == -np.inf).all()


@pytest.mark.parametrize(("rows", "size"), [(0, 5), (7, 0), (7, 300_000), (7, 10**9)])
def test_parts_hold_every_row_once(rows: int, size: int) -> None:
    parts = in_parts(np.arange(rows), size)
    assert [row for part in parts for row in part.tolist()] == list(range(rows))
    assert all(len(part) * size <= 1_000_000 or len(part) == 1 for part in parts)
