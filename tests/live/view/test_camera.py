"""The camera of the page: no key of the avatar moves it, and Home brings the first view back."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

viser = pytest.importorskip("viser")

from avatarsim.live.drive.keys import KEYS  # noqa: E402
from avatarsim.live.stages import NAMES, stage  # noqa: E402
from avatarsim.live.view.page import Page  # noqa: E402

CONTROLS = Path(viser.__file__).parent / "client" / "src" / "CameraControls.tsx"
"""Where the installed viser lists the physical keys that fly its camera."""


def test_no_key_of_the_avatar_flies_the_camera() -> None:
    [listed] = re.findall(r"CAMERA_MOVEMENT_KEYS = new Set\(\[(.*?)\]\)", CONTROLS.read_text(encoding="utf-8"), re.DOTALL)
    flying = set(re.findall(r'"(\w+)"', listed))
    assert {"KeyW", "ArrowUp"} <= flying
    assert not flying & {f"Key{key.key.upper()}" for key in KEYS}


@pytest.mark.parametrize("name", NAMES)
def test_home_is_the_first_view(name: str) -> None:
    found = stage(name)
    camera = SimpleNamespace(position=np.full(3, 50.0), look_at=np.zeros(3), up_direction=np.array((1.0, 0.0, 0.0)))
    Page.go_home(SimpleNamespace(shows=SimpleNamespace(stage=found)), camera)
    assert tuple(camera.position) == found.camera.position and tuple(camera.look_at) == found.camera.look_at
    assert tuple(camera.up_direction) == (0.0, 0.0, 1.0)
