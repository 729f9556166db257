"""Camera of the page: no key of the avatar moves it, views frame the avatar, and Home brings the first one back."""

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

viser = pytest.importorskip("viser")

from avatarsim.live.drive.keys import KEYS  # noqa: E402
from avatarsim.live.stages import NAMES, stage  # noqa: E402
from avatarsim.live.view.cameras import FIELD, VIEWS, framed, world_spacing  # noqa: E402
from avatarsim.live.view.worlds import Worlds  # noqa: E402
from avatarsim.player.surfaces import corners  # noqa: E402
from avatarsim.scene.tracker import link_poses  # noqa: E402
from avatarsim.spatial import rotation  # noqa: E402

CONTROLS = Path(viser.__file__).parent / "client" / "src" / "CameraControls.tsx"
"""File of the installed viser with the physical keys that fly its camera."""


def test_no_key_of_the_avatar_flies_the_camera() -> None:
    [listed] = re.findall(r"CAMERA_MOVEMENT_KEYS = new Set\(\[(.*?)\]\)", CONTROLS.read_text(encoding="utf-8"), re.DOTALL)
    flying = set(re.findall(r'"(\w+)"', listed))
    assert {"KeyW", "ArrowUp"} <= flying
    assert not flying & {f"Key{key.key.upper()}" for key in KEYS}


def unit(vector: np.ndarray) -> np.ndarray:
    """Return a vector of length 1."""
    return np.asarray(vector / np.linalg.norm(vector))


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("name", NAMES)
def test_a_view_shows_the_avatar_at_two_fifths_of_the_height(name: str, view: str) -> None:
    scene = stage(name).scene
    own = scene.avatars[0]
    places, turns = (one[: len(own.links)] for one in link_poses(scene.avatars, scene.first_sample))
    seen = framed(own, places, turns, view, np.zeros((1, 3)))
    ahead = unit(seen.look_at - seen.position)
    up = unit(np.array((0.0, 0.0, 1.0)) - ahead[2] * ahead)
    points = np.concatenate([
        rotation.rotate(turns[k], corners(piece)) + places[k] for k, link in enumerate(own.links) for piece in link.pieces
    ]) - seen.position
    scale = (points @ ahead) * 2.0 * np.tan(0.5 * FIELD)
    heights, across = points @ up / scale, points @ np.cross(ahead, up) / scale
    assert 0.3 < max(np.ptp(heights), 0.7 * np.ptp(across)) < 0.6 and np.abs(heights).max() < 0.5


def test_worlds_side_by_side_are_all_in_the_first_view() -> None:
    scene = stage("toys").scene
    places, turns = (one[: len(scene.avatars[0].links)] for one in link_poses(scene.avatars, scene.first_sample))
    step = world_spacing(scene)
    offsets = np.arange(2)[:, None] * step
    seen = framed(scene.avatars[0], places, turns, "Home", offsets)
    ahead = unit(seen.look_at - seen.position)
    right = unit(np.cross(ahead, (0.0, 0.0, 1.0)))
    across = [(place - seen.position) @ right / ((place - seen.position) @ ahead) for place in places[0] + offsets]
    wide = 1.5 * np.tan(0.5 * FIELD)
    assert -0.9 * wide < across[0] < 0.0 < across[1] < 0.5 * wide
    # far enough apart that the tables do not overlap
    assert np.linalg.norm(step) > 0.9


def test_home_is_the_first_view() -> None:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    worlds = Worlds(server, stage("hand"), ["avatarsim"])
    camera: Any = SimpleNamespace(position=np.full(3, 50.0), look_at=np.zeros(3), up_direction=np.array((1.0, 0.0, 0.0)))
    worlds.look(camera, "Home")
    first = server.initial_camera
    assert camera.position == pytest.approx(first.position) and camera.look_at == pytest.approx(first.look_at)
    assert tuple(camera.up_direction) == (0.0, 0.0, 1.0)
    server.stop()
