"""Provenance: hashes of scenes and code, versions, commits."""

from dataclasses import replace
from pathlib import Path

from avatarsim import __version__
from avatarsim.running.sources import cpu, version
from scenarios.run.provenance import commit_of, hash_of_sources, provenance, scene_hash
from tests.scenarios.examples import arm_scene, drop_scene, fist_scene


def test_equal_scenes_have_equal_hashes_and_no_two_others_do() -> None:
    assert scene_hash(arm_scene()) == scene_hash(arm_scene())
    heavier = replace(drop_scene(), gravity=(0.0, 0.0, -9.82))
    moved = replace(drop_scene(), bodies=(drop_scene().bodies[0], replace(drop_scene().bodies[1], position=(0.0, 0.0, 1.2))))
    scenes = [arm_scene(), drop_scene(), fist_scene(), heavier, moved]
    assert len({scene_hash(scene) for scene in scenes}) == len(scenes)
    scene = fist_scene()
    before = scene_hash(scene)
    # a derived property that is stored in the scene
    assert scene.pair_filter.any() and scene_hash(scene) == before


def test_the_facts_beside_the_figures() -> None:
    found = provenance(["check", "--full"])
    assert found["command"] == "python -m scenarios check --full" and cpu()
    assert {"started", "python", "cpus", "versions", "platform", "cpu", "commit"} < set(found)
    assert isinstance(found["versions"], dict) and found["versions"]["avatarsim"] == __version__
    assert version("numpy") and version("a-package-that-nobody-has") is None


def test_outside_a_repository_there_is_no_commit(tmp_path: Path) -> None:
    assert commit_of(tmp_path) is None
    (tmp_path / ".git").write_text("gitdir: nowhere\n")
    assert commit_of(tmp_path) is None


def test_the_hash_of_the_code_changes_with_any_file(tmp_path: Path) -> None:
    (tmp_path / "avatarsim").mkdir()
    found = []
    for text in ("x = 1\n", "x = 1\n", "x = 2\n"):
        (tmp_path / "avatarsim" / "a.py").write_text(text)
        found.append(hash_of_sources(tmp_path))
    assert found[0] == found[1] != found[2]
