"""`check_engine`: the skeleton passes, engines of the comparison pass, and each fault is found and named."""

import importlib
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import avatarsim as av
from avatarsim.engine import require_shapes
from avatarsim.errors import UnsupportedShape
from avatarsim.testing import Finding, check_engine
from scenarios.engines import opened

FOLDER = Path(__file__).resolve().parents[1] / "examples"


@pytest.fixture
def mine(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module("engine_of_your_own").MyEngine


def shown(change: Callable[[Any], dict[str, Any]]) -> Callable[[Any], Any]:
    """Return the skeleton with a change of its shown state: arrays of a snapshot by name."""

    def of(engine: Any) -> Any:
        class Broken(engine):
            def record(self, sample: av.TrackerSample, dt: float) -> av.FrameRecord:
                found = super().record(sample, dt)
                one = found.shown
                names = ("time", "positions", "orientations", "velocities", "angular_velocities")
                arrays = {name: getattr(one, name) for name in names} | change(one)
                return av.FrameRecord(av.Snapshot(**arrays), found.angles)

        return Broken

    return of


def raises(method: str) -> Callable[[Any], Any]:
    def fails(self: Any, *_: object) -> None:
        raise RuntimeError(method)

    return lambda engine: type("Broken", (engine,), {method: fails})


class NoLimits:
    """Overrides of the skeleton: joints without limits."""

    limits = property(lambda self: (-np.inf, np.inf), lambda self, value: None)


BROKEN: dict[str, tuple[Callable[[Any], Any], set[str]]] = {
    "scalar last": (shown(lambda one: {"orientations": np.roll(one.orientations, -1, axis=1)}), {"follows", "limits", "falls"}),
    "moved": (shown(lambda one: {"positions": one.positions + 0.1}), {"follows", "limits", "falls", "spins", "shapes"}),
    "not finite": (shown(lambda one: {"velocities": one.velocities * np.nan}), {"record"}),
    "too few": (shown(lambda one: {"positions": one.positions[1:]}), {"record"}),
    "no unit": (shown(lambda one: {"orientations": 2.0 * one.orientations}), {"record"}),
    "late": (shown(lambda one: {"time": 2.0 * one.time}), {"record"}),
    "degrees": (shown(lambda one: {"angular_velocities": np.rad2deg(one.angular_velocities)}), {"spins"}),
    "still": (shown(lambda one: {"velocities": np.zeros_like(one.velocities)}), {"falls", "spins"}),
    "drawn": (shown(lambda one: {"velocities": one.velocities + 1e-9 * random.random()}), {"determinism"}),
    "limits": (lambda engine: type("Broken", (NoLimits, engine), {}), {"limits"}),
    "names": (lambda engine: type("Broken", (engine,), {"version": ""}), {"protocol"}),
    "presets": (lambda engine: type("Broken", (engine,), {"presets": ["default"]}), {"protocol"}),
    "half": (lambda engine: type("Half", (), {"name": "half"}), {"protocol"}),
    "made": (raises("__init__"), {"protocol"}), "load": (raises("load"), {"refusals", "presets", "follows", "shapes"}),
    "settings": (raises("settings_as_run"), {"presets"}),
}


def test_the_skeleton_and_the_engine_pass(mine: Any) -> None:
    assert check_engine(mine) == () and check_engine(av.AvatarsimEngine) == ()


@pytest.mark.parametrize("name", BROKEN)
def test_a_fault_is_found_and_named(mine: Any, name: str) -> None:
    made, checks = BROKEN[name]
    found = check_engine(made(mine), raises=False)
    assert all(isinstance(one, Finding) and one.text for one in found) and checks <= {one.check for one in found}, found
    if name == "names":
        with pytest.raises(AssertionError) as raised:
            check_engine(made(mine))
        assert all(one.check in str(raised.value) for one in found)


def test_wrong_input_that_is_taken_is_found(mine: Any) -> None:
    class Careless(mine):
        presets = property(lambda self: ("default",))

        def load(self, scene: av.Scene, settings: av.Settings, dt: float) -> av.FrameRecord:
            record: av.FrameRecord = super().load(scene, av.Settings(), dt)
            return record

    texts = [one.text for one in check_engine(Careless, raises=False) if one.check == "refusals"]
    assert len(texts) == 2 and "preset" in texts[0] and "option" in texts[1]


def test_the_tracker_without_limits_is_found() -> None:
    assert {one.check for one in check_engine(lambda: opened("tracker"), raises=False)} == {"limits"}


def test_one_shape_is_refused_by_the_name_of_its_body() -> None:
    ball, cube = (av.Piece(av.Sphere(0.1)),), (av.Piece(av.Box((0.1, 0.1, 0.1))),)
    scene = av.Scene("two", (av.fixed("ball", ball, "wood"), av.fixed("cube", cube, "wood", position=(1.0, 0.0, 0.0))))
    require_shapes(scene, (av.Sphere, av.Box))
    with pytest.raises(UnsupportedShape) as raised:
        require_shapes(scene, (av.Sphere,))
    assert (raised.value.body, raised.value.value, raised.value.valid) == ("cube", "Box", "Sphere")
