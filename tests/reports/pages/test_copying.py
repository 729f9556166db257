"""Lines to copy are Python that binds its names and loads a file that the run has, or the command that runs the setting."""

import ast
import builtins
from collections.abc import Mapping
from pathlib import Path

import pytest

from reports.pages import copying
from reports.reading.load import EngineNote
from reports.tables.run import Run
from reports.tables.settings import settings
from scenarios import catalog
from scenarios.engines import known
from scenarios.studies.settings.copyable import copyable
from scenarios.studies.settings.grid import Setting
from tests.reports.small_runs import MUJOCO, OVERLAP, SETTING, Part, figure, run_of, write_study
from tests.scenarios.studies.settings.grids import GRIDS

SCENE = "stack_ten"
ENDINGS: Mapping[str, str] = {"mujoco": "xml", "pybullet": "py", "rapier": "json"}
NOTES = [
    EngineNote("physx/tuned", SCENE, "1", {}, {"dt": ("0.001", ""), "pcm": ("False", ""), "lead_steps": ("1.0", "")}),
    EngineNote("physx/default", SCENE, "1", {}, {"dt": ("0.01", ""), "pcm": ("True", ""), "lead_steps": ("0.0", "")}),
]


def told(folder: Path, setting: Setting, files: bool = True) -> str:
    """Return the lines for a setting, of a run with or without files of the scene."""
    (folder / "native").mkdir(exist_ok=True)
    if files and setting.engine in ENDINGS:
        (folder / "native" / f"{SCENE}.{setting.engine}.{setting.base}.0.{ENDINGS[setting.engine]}.gz").touch()
    run: Run = run_of([figure(SCENE, MUJOCO, OVERLAP, 0.0)], notes=NOTES, name=str(folder))
    change = "" if setting.name == setting.base else setting.name
    write_study(folder, "settings", Part(SCENE, f"{setting.engine}/{setting.base}", change, SETTING, copyable(setting)))
    table = settings(folder)
    assert table is not None
    (row,) = table.itertuples()
    return copying.lines(run, row)


@pytest.mark.parametrize("setting", [one for grid in GRIDS.values() for one in grid], ids=lambda one: one.run)
def test_lines_bind_the_names_that_they_use(tmp_path: Path, setting: Setting) -> None:
    text = told(tmp_path, setting)
    if "own.toml" in text:
        assert f"run {SCENE} --engine {setting.engine}" in text and setting.slug in text and "python -m scenarios" in text
        assert setting.engine in known() and SCENE in catalog.scenarios()
        return
    nodes = list(ast.walk(ast.parse(text)))
    names = [node for node in nodes if isinstance(node, ast.Name)]
    bound = {node.id for node in names if isinstance(node.ctx, ast.Store)}
    bound |= {(one.asname or one.name) for node in nodes if isinstance(node, ast.Import | ast.ImportFrom) for one in node.names}
    # a scene of PhysX is the reader's own: no run leaves one
    bound |= {"scene"} if setting.engine == "physx" else set()
    assert {node.id for node in names} <= bound | set(dir(builtins))
    files = [str(node.value) for node in nodes if isinstance(node, ast.Constant) and str(node.value).endswith(".gz")]
    assert [(tmp_path / "native" / file).exists() for file in files] == [True] * (setting.engine in ENDINGS)


def test_a_scene_without_a_file_has_no_lines(tmp_path: Path) -> None:
    assert ast.parse(told(tmp_path, Setting("mujoco", "tuned", "tuned", {}), files=False)).body == []


def test_what_a_preset_sets_beyond_the_lines_is_named(tmp_path: Path) -> None:
    lines = told(tmp_path, Setting("physx", "tuned", "tuned", {})).splitlines()
    assert any("lead_steps = 1.0" in line and line.startswith("#") for line in lines)
    assert any("enable_pcm = False" in line for line in lines) and any("1/1000" in line for line in lines)
