"""The player gets poses as they were, to the fineness of 16 bits, and equal meshes once."""

import base64

import numpy as np
import pytest

from avatarsim.player.payload import LEAST, MISSING, MOST, BodyMesh, Poses, View, codes, payload, text
from avatarsim.player.surfaces import surface
from avatarsim.scene.shape import Piece, Sphere


def unpacked(packed: str, low: float, high: float) -> np.ndarray:
    """Return the numbers again, as a page unpacks them."""
    found = np.frombuffer(base64.b64decode(packed), dtype="<u2").astype(np.float64)
    return np.where(found == MISSING, np.nan, low + (found - LEAST) / (MOST - LEAST) * (high - low))


def test_packed_numbers_come_back_within_half_a_step() -> None:
    values = np.array([-1.0, 0.0, 0.123456, 3.0, np.nan, np.inf, 9.0])
    found = unpacked(text(codes(values, -1.0, 3.0)), -1.0, 3.0)
    assert found[:4] == pytest.approx(values[:4], abs=0.5 * 4.0 / 65534 + 1e-12)
    assert np.isnan(found[4:6]).all() and found[6] == 3.0
    assert unpacked(text(codes(np.zeros(3), 0.0, 0.0)), 0.0, 0.0).tolist() == [0.0] * 3


def test_equal_bodies_share_a_mesh() -> None:
    """A pose that is none has no place."""
    ball, upright = surface((Piece(Sphere(0.1)),)), np.array([1.0, 0.0, 0.0, 0.0])
    alike, large = surface((Piece(Sphere(0.1)),)), surface((Piece(Sphere(2.0)),))
    bodies = [BodyMesh("driven", ball), BodyMesh("simulated", alike, large), BodyMesh("fixed", large)]
    turns = np.tile(upright, (3, 2, 1))
    turns[2, 1] = np.nan
    view = View("a", "red", Poses(np.ones((3, 2, 3)), turns))
    still = {2: (np.zeros(3), upright)}
    found = payload(bodies, still, np.arange(3) / 60.0, [view], 0, None, lambda focus, radius: radius, opens=2)
    assert [body["mesh"] for body in found["bodies"]] == [0, 0, 1] and len(found["meshes"]) == 2
    assert [body.get("tested") for body in found["bodies"]] == [None, 1, None]
    mesh = found["meshes"][1]
    shares = (large[0] - mesh["low"]) / np.ptp(large[0], axis=0)
    np.testing.assert_allclose(unpacked(mesh["corners"], 0.0, 1.0).reshape(-1, 3), shares, atol=1e-5)
    assert np.frombuffer(base64.b64decode(mesh["faces"]), dtype="<u2").reshape(-1, 3).tolist() == large[1].tolist()
    assert found["moving"] == [0, 1] and found["opens"] == 2 and found["times"] == pytest.approx([0.0, 1 / 60, 2 / 60])
    places = unpacked(found["views"][0]["places"], found["low"][0], found["high"][0]).reshape(3, 2, 3)
    assert np.isnan(places[2, 1]).all() and places[:, 0] == pytest.approx(np.ones((3, 3)), abs=1e-4)
