"""A key changes with all that can change a result, and with nothing else."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from avatarsim.errors import MissingPackage, UnknownName
from scenarios.job import Job
from scenarios.results import fingerprint
from scenarios.results.provenance import ROOT
from scenarios.studies.sweep import finer

JOB = Job("stop_distance", "mujoco", "x", base="tuned", options={"dt": 0.01})


def test_equal_jobs_have_equal_keys_whatever_they_are_called() -> None:
    key = fingerprint.key_of(JOB)
    assert key == fingerprint.key_of(replace(JOB, preset="another.name")) and len(key) == 24


@pytest.mark.parametrize("changed", [
    {"scenario": "stop_distance_30"}, {"engine": "pybullet"}, {"base": "default"}, {"options": {"dt": 0.02}},
    {"options": {"dt": 0.01, "cone": "PYRAMIDAL"}}, {"seed": 1}, {"frames": 7}, {"narrow": ("friction",)},
    {"scenario": "stop_distance~2", "catalogue": finer.__name__},
])
def test_every_part_counts(changed: dict[str, object]) -> None:
    assert fingerprint.key_of(JOB) != fingerprint.key_of(replace(JOB, **changed))


def reachable(start: str) -> set[Path]:
    """Everything that a file imports, by the simplest walk."""
    found, waiting = set(), [ROOT / start]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting += fingerprint.imported(path)
    return {path.relative_to(ROOT) for path in found}


def test_each_engine_hangs_on_its_own_sources() -> None:
    theirs, ours = reachable("reference/in_mujoco/engine.py"), reachable("avatarsim/simulator.py")
    assert Path("reference/in_mujoco/presets.py") in theirs and Path("reference/targets.py") in theirs
    assert not any("in_pybullet" in path.parts for path in theirs) and Path("avatarsim/frame.py") not in theirs
    assert Path("avatarsim/rigid/impacts.py") in ours and not any(path.parts[0] == "reference" for path in ours)


def test_measures_hang_on_the_judge_and_not_on_any_engine() -> None:
    found = reachable("scenarios/running/run.py") | reachable("scenarios/studies/sweep/measure.py")
    wanted = ("reference/judging/judge.py", "scenarios/measure/bodies/bounce.py", "scenarios/building/expected.py")
    assert set(map(Path, wanted)) <= found
    assert not found & {Path("avatarsim/simulator.py"), Path("avatarsim/frame.py"), Path("reference/in_mujoco/engine.py")}


def test_an_edit_changes_the_hash_of_who_imports_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fingerprint, "ROOT", tmp_path)
    (tmp_path / "scenarios").mkdir()
    one, two, three = (tmp_path / "scenarios" / f"{name}.py" for name in ("one", "two", "three"))
    one.write_text("from scenarios import two\n")
    two.write_text("def late() -> None:\n    from scenarios.three import (\n        x,\n    )\n")

    def hashed() -> str:
        fingerprint._content.cache_clear()
        fingerprint.imported.cache_clear()
        return fingerprint.sources([one])

    three.write_text("x = 1\n")
    before = hashed()
    assert hashed() == before
    three.write_text("x = 2\n")
    assert hashed() != before
    fingerprint.imported.cache_clear()
    fingerprint._content.cache_clear()


ENGINE = """
from importlib import import_module
from reference.in_tracker.engine import RawTracker

class Engine(RawTracker):
    version = import_module("simulator_of_a_stranger").VERSION
"""


def test_an_engine_that_joined_hangs_on_its_package_and_on_the_version_that_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "package_of_a_stranger"
    (package / "inner").mkdir(parents=True)
    info = tmp_path / "stranger-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: stranger\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[avatarsim.engines]\nstranger = package_of_a_stranger.inner.engine:Engine\n")
    beneath = tmp_path / "simulator_of_a_stranger.py"
    for file, text in {
        package / "__init__.py": "", package / "inner" / "__init__.py": "", package / "inner" / "engine.py": ENGINE,
        package / "step.py": "STEP = 1\n", beneath: "VERSION = '1'\n",
    }.items():
        file.write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def key() -> str:
        for kept in (fingerprint.engine_part, fingerprint.imported, fingerprint._content):
            kept.cache_clear()
        for name in [name for name in sys.modules if name.endswith("_of_a_stranger") or "_of_a_stranger." in name]:
            monkeypatch.delitem(sys.modules, name)
        return fingerprint.key_of(replace(JOB, engine="stranger"))

    keys = [key()]
    assert key() == keys[0]
    (package / "step.py").write_text("STEP = 2\n")
    keys.append(key())
    beneath.write_text("VERSION = '2'\n")
    keys.append(key())
    (package / "inner" / "engine.py").write_text("raise RuntimeError\n")
    keys.append(key())
    assert len(set(keys)) == 4
    assert "absent: RuntimeError" in fingerprint.engine_part("stranger")


def test_what_nobody_has() -> None:
    with pytest.raises(UnknownName):
        fingerprint.key_of(replace(JOB, scenario="nowhere"))
    with pytest.raises(MissingPackage):
        fingerprint.find("a_package_that_nobody_has.engine")
    assert fingerprint.engine_part("abacus") == "abacus"
