"""Settings copied from the page are those measured: rows are read back to equal options."""

from pathlib import Path

import pytest

from scenarios.run.own_settings import read
from scenarios.studies.settings.copyable import copyable
from scenarios.studies.settings.grid import Setting
from tests.scenarios.studies.settings.grids import GRIDS

GRID = [setting for settings in GRIDS.values() for setting in settings]


@pytest.mark.parametrize("setting", [s for s in GRID if s.options], ids=lambda s: s.run)
def test_a_row_is_read_back_to_the_last_digit(setting: Setting, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(copyable(setting) + "\n", encoding="utf-8")
    (row,) = read(path, GRIDS)
    assert (row.engine, row.name, row.base) == (setting.engine, setting.slug, setting.base)
    assert {name: tuple(value) if isinstance(value, list) else value for name, value in row.options.items()} == setting.options


def test_rows_of_one_engine_stand_together_in_one_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    rows = [copyable(setting) for setting in GRIDS["mujoco"] if setting.options]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    assert len(read(path, GRIDS)) == len(rows) > 10


def test_presets_are_named_and_what_no_row_can_say_is_python() -> None:
    assert copyable(Setting("mujoco", "tuned", "tuned")) == "--engine mujoco --preset tuned"
    assert copyable(Setting("avatarsim", "x", "default", cut=2)) == "for _ in range(2): engine.advance(sample, dt / 2)"
    assert copyable(Setting("avatarsim", "x", "default", narrow=("friction",))) == "replace(scene, narrow=('friction',))"
