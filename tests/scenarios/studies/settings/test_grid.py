"""Settings that engines accept, that change something, and that are distinguished."""

import pytest

from avatarsim.engine import Settings
from avatarsim.errors import MissingPackage
from scenarios import catalog
from scenarios.engines import opened
from scenarios.run.own_settings import NAME, OwnSettings
from scenarios.studies.settings.grid import Setting, applicable, settings_of
from tests.scenarios.studies.settings.grids import GRIDS

GRID = [setting for settings in GRIDS.values() for setting in settings]
SMALL = ("stop_distance", "bounce_ladder", "driven_10cm_wall", "squeeze")
"""Scenes of each kind."""


def test_names_are_unique_and_fit_file_names() -> None:
    assert len({setting.run for setting in GRID}) == len(GRID) == len({(s.engine, s.slug) for s in GRID})
    assert all(NAME.fullmatch(setting.slug) for setting in GRID)


@pytest.mark.parametrize("setting", GRID, ids=lambda s: s.run)
def test_every_setting_is_accepted_and_none_repeats_its_base(setting: Setting) -> None:
    try:
        engine, tried, differs = opened(setting.engine), 0, False
    except MissingPackage as missing:
        pytest.skip(str(missing))
    for name in SMALL:
        scenario = catalog.get(name)
        scene = scenario.build()
        if not applicable(setting, scene):
            continue
        engine.load(scene, Settings(setting.base), scenario.dt)
        before = {key: str(value) for key, value in engine.settings_as_run().items()}
        engine.load(scene, Settings(setting.base, setting.options), scenario.dt)
        after = {key: str(value) for key, value in engine.settings_as_run().items()}
        # a reason changes with a setting set by hand, so only values are compared
        changed = [k for k in setting.options if before[k].split(",")[0] != after[k].split(",")[0]]
        differs |= bool(changed)
        tried += 1
    engine.close()
    # a step may equal that of the preset in one kind of scene
    assert tried and (differs or not setting.options or setting.name.startswith("tuned DISCRETE"))


def test_of_a_stranger_the_presets_and_of_a_reader_the_rows() -> None:
    own = (OwnSettings("mine", "stiff", "b", {"k": 3.0}), OwnSettings("other", "x", "b", {}))
    found = settings_of("mine", ("a", "b"), own)
    assert [(s.name, s.base, dict(s.options)) for s in found] == [("a", "a", {}), ("b", "b", {}), ("stiff", "b", {"k": 3.0})]


def test_what_changes_nothing_is_not_asked() -> None:
    alone, driven = catalog.get("stop_distance").build(), catalog.get("driven_10cm_wall").build()
    by_name = {setting.name: setting for setting in GRIDS["avatarsim"]}
    assert not applicable(by_name["default steps=1"], alone) and applicable(by_name["default steps=1"], driven)
    assert applicable(by_name["default continuous=off"], alone) and not applicable(by_name["default continuous=off"], driven)
