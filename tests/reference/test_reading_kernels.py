"""Compiled reading against numpy's own words for it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from avatarsim.spatial import rotation
from reference.reading_kernels import about_own_centres, body_frames

Array = NDArray[np.float64]
INSTANTS, BODIES, ALL = 3, 5, 9


def empty() -> tuple[Array, Array, Array, Array]:
    """Return positions, orientations, velocities and spins, to be written; nan marks the entries that were not."""
    return tuple(np.full((INSTANTS, BODIES, width), np.nan) for width in (3, 4, 3, 3))  # type: ignore[return-value]


@pytest.mark.nojit
@pytest.mark.boundscheck
@given(st.integers(0, 10**6))
def test_mass_centres_become_body_frames(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(INSTANTS, BODIES, 13))
    rows[..., 3:7] /= np.linalg.norm(rows[..., 3:7], axis=-1, keepdims=True)
    frames, centres = rotation.normalised(rng.normal(size=(BODIES, 4))), rng.normal(size=(BODIES, 3))
    found = empty()
    assert body_frames(rows, frames, centres, *found) == 0
    orientations = rotation.multiply(rows[..., [6, 3, 4, 5]], frames)
    plain = rows[..., :3] - rotation.rotate(orientations, centres), orientations, rows[..., 7:10], rows[..., 10:]
    for compiled, expected in zip(found, plain, strict=True):
        np.testing.assert_allclose(compiled, expected, rtol=0.0, atol=1e-14)


@pytest.mark.nojit
@pytest.mark.boundscheck
@given(st.integers(0, 10**6))
def test_velocities_of_a_tree_become_those_of_its_bodies(seed: int) -> None:
    rng = np.random.default_rng(seed)
    places, turns, motions, centres, trees = (rng.normal(size=(INSTANTS, ALL, width)) for width in (3, 4, 6, 3, 3))
    ids, roots = rng.permutation(ALL)[:BODIES].astype(np.int64), rng.integers(0, ALL, BODIES)
    found = empty()
    assert about_own_centres(places, turns, motions, centres, trees, ids, roots, *found) == 0
    spins = motions[:, ids, :3]
    velocities = motions[:, ids, 3:] + np.cross(spins, centres[:, ids] - trees[:, roots])
    for compiled, expected in zip(found, (places[:, ids], turns[:, ids], velocities, spins), strict=True):
        np.testing.assert_allclose(compiled, expected, rtol=0.0, atol=1e-14)
