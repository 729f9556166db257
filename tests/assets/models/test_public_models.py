"""Models from installed packages: kinematics as MuJoCo's and thirty frames, or an error that names the remedy."""

from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import avatarsim as av
from tests.assets.models.mujoco_twin import Twin, greatest_difference
from tests.assets.motions.robots import driven


def shipped(package: str, *parts: str) -> Path:
    """Return a file of an installed package, which need not be imported."""
    found = find_spec(package)
    assert found is not None and found.submodule_search_locations
    return Path(found.submodule_search_locations[0]).joinpath(*parts)


GYM, ROBOTICS, BULLET = ("gymnasium", "envs", "mujoco", "assets"), ("gymnasium_robotics", "envs", "assets"), ("pybullet_data",)

LOADED: dict[str, tuple[tuple[str, ...], dict[str, Any], tuple[int, int]]] = {
    "gymnasium humanoid": ((*GYM, "humanoid.xml"), {}, (13, 17)),
    "gymnasium ant": ((*GYM, "ant.xml"), {}, (13, 8)),
    "shadow hand": ((*ROBOTICS, "hand", "reach.xml"), {"folder": ROBOTICS}, (26, 24)),
    "adroit hand": ((*ROBOTICS, "adroit_hand", "adroit_relocate.xml"), {"folder": ROBOTICS}, (28, 30)),
    "adroit door": ((*ROBOTICS, "adroit_hand", "adroit_door.xml"), {"folder": ROBOTICS}, (26, 28)),
    "gymnasium hopper": ((*GYM, "hopper.xml"), {}, (6, 6)),
    "gymnasium walker": ((*GYM, "walker2d_v5.xml"), {}, (9, 9)),
    "gymnasium double pendulum": ((*GYM, "inverted_double_pendulum.xml"), {}, (3, 3)),
    "fetch": ((*ROBOTICS, "fetch", "pick_and_place.xml"), {"folder": ROBOTICS}, (30, 15)),
    "pybullet humanoid": ((*BULLET, "humanoid", "humanoid.urdf"), {}, (16, 4)),
    "kuka iiwa": ((*BULLET, "kuka_iiwa", "model.urdf"), {"root": "fixed"}, (8, 7)),
    "r2d2": ((*BULLET, "r2d2.urdf"), {}, (16, 8)),
    "laikago": ((*BULLET, "laikago", "laikago_toes_limits.urdf"), {}, (17, 12)),
    "mini cheetah": ((*BULLET, "mini_cheetah", "mini_cheetah.urdf"), {}, (17, 12)),
}
"""Name -> file, options, numbers of links and hinges."""


@pytest.mark.parametrize("name", LOADED)
def test_links_are_where_mujoco_has_the_bodies_and_frames_run(name: str) -> None:
    parts, options, (links, hinges) = LOADED[name]
    path = shipped(*parts)
    if "folder" in options:
        options = {**options, "folder": shipped(*options["folder"])}
    model = driven(av.load_avatar(path, **options))
    assert (len(model.avatar.links), model.coordinates.hinges) == (links, hinges)
    assert greatest_difference(Twin(path), model, 10) <= 1e-12
    assert model.start is not None
    with av.AvatarsimEngine() as engine:
        engine.load(model.scene(), av.Settings(), dt=1 / 60)
        for frame in range(1, 31):
            angles = model.start.angles + 0.2 * np.sin(0.1 * frame + np.arange(model.coordinates.hinges))
            record = engine.advance(replace(model.start, time=frame / 60, angles=angles), dt=1 / 60)
        assert np.isfinite(record.shown.positions).all()


REFUSED: dict[str, tuple[tuple[str, ...], dict[str, Any], str]] = {
    "a height field": (("mujoco", "testdata", "model.xml"), {}, r"type of geom 1 of world.*leave=\(\"geom 1 of world\",\)"),
    "what is no XML": ((*BULLET, "husky", "husky.urdf"), {}, r"husky\.urdf, line 97, is '.*valid: 3 finite numbers"),
    "files elsewhere": (
        (*ROBOTICS, "hand", "reach.xml"), {}, r'meshdir of <compiler> in .*xml, line \d+,.*folder=".*/envs/assets"',
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused_says_what_to_do(name: str) -> None:
    parts, options, sentence = REFUSED[name]
    with pytest.raises(av.InvalidInput, match=sentence):
        av.load_avatar(shipped(*parts), **options)
