"""Provenance: hashes of scenes and code, versions, commits."""

from dataclasses import replace
from pathlib import Path

from avatarsim.running.sources import cpu, version
from scenarios.run.provenance import commit_of, hash_of_sources, provenance, scene_hash
from tests.scenarios.examples import arm_scene, drop_scene, fist_scene


def test_equal_scenes_have_equal_hashes_and_no_two_others_do() -> None:
    assert scene_hash(arm_scene()) == scene_hash(arm_scene())
    heavier = replace(drop_scene(), gravity=(0.0, 0.0, -9.82))
    moved = replace(drop_scene(), bodies=(drop_scene().bodies[0], replace(drop_scene().bodies[1], position=(0.0, 0.0, 1.2))))
    scenes = [arm_scene(), drop_scene(), fist_scene(), heavier, moved]
    assert len({scene_hash(scene) for scene in scenes}) == len(scenes)


def test_asking_a_scene_for_its_names_does_not_change_its_hash() -> None:
    scene = fist_scene()
    before = scene_hash(scene)
    assert scene.pair_filter.any()
    assert scene_hash(scene) == before


def test_versions_of_what_is_not_installed_are_none() -> None:
    assert version("numpy") and version("a-package-that-nobody-has") is None


def test_what_is_written_beside_the_figures() -> None:
    found = provenance(["check", "--full"])
    assert found["command"] == "python -m scenarios check --full" and cpu()
    assert {"started", "python", "cpus", "versions", "platform", "cpu", "commit"} < set(found)


def test_outside_a_repository_there_is_no_commit(tmp_path: Path) -> None:
    assert commit_of(tmp_path) is None
    (tmp_path / ".git").write_text("gitdir: nowhere\n")
    assert commit_of(tmp_path) is None


def test_the_hash_of_the_code_changes_with_any_file(tmp_path: Path) -> None:
    (tmp_path / "avatarsim").mkdir()
    (tmp_path / "avatarsim" / "a.py").write_text("x = 1\n")
    before = hash_of_sources(tmp_path)
    assert hash_of_sources(tmp_path) == before
    (tmp_path / "avatarsim" / "a.py").write_text("x = 2\n")
    assert hash_of_sources(tmp_path) != before


def test_our_own_version_is_known_without_being_installed() -> None:
    from avatarsim import __version__

    versions = provenance([])["versions"]
    assert isinstance(versions, dict) and versions["avatarsim"] == __version__
