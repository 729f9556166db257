"""Files: every format we name, and what is refused by name."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from avatarsim.errors import InvalidFile, MissingPackage
from avatarsim.pieces.mesh import signed_volume
from avatarsim.pieces.mesh_file import BY_TRIMESH, read_mesh
from avatarsim.pieces.obj_file import groups_of
from avatarsim.pieces.repairs import mended
from tests.pieces.solids import cube, ell, obj_text


@pytest.mark.parametrize("ending", [".obj", *BY_TRIMESH])
def test_every_format_gives_the_same_solid(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"ell{ending}"
    written = trimesh.Trimesh(*ell(), process=False).export(file_type=ending[1:])
    files = written if isinstance(written, dict) else {path.name: written}
    for name, content in files.items():
        (tmp_path / name).write_bytes(content.encode() if isinstance(content, str) else content)
    path = path if path.exists() else tmp_path / next(name for name in files if name.endswith(ending))
    sound = mended(read_mesh(path))
    assert sound.faults == () and sound.repairs == ()
    assert signed_volume(sound.mesh.corners) == pytest.approx(5.0, rel=1e-6)


def test_groups_of_an_obj_keep_their_vertices(tmp_path: Path) -> None:
    path = tmp_path / "two.obj"
    path.write_text(obj_text(cube(), ell()), encoding="utf-8")
    first, second = groups_of(read_mesh(path))
    np.testing.assert_array_equal(first.vertices, cube()[0])
    np.testing.assert_array_equal(second.vertices, ell()[0])
    np.testing.assert_array_equal(second.triangles, ell()[1])


def test_what_cannot_be_read_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(InvalidFile, match=r"nowhere\.stl.*existing file"):
        read_mesh(tmp_path / "nowhere.stl")
    (tmp_path / "scene.usd").write_text("x", encoding="utf-8")
    with pytest.raises(InvalidFile, match=r"format of scene\.usd is '\.usd'; valid: one of \.obj \.glb"):
        read_mesh(tmp_path / "scene.usd")


@pytest.mark.parametrize("ending", BY_TRIMESH)
@pytest.mark.parametrize("content", [b"", b"nonsense\n" * 20])
def test_a_broken_file_is_refused_by_name(ending: str, content: bytes, tmp_path: Path) -> None:
    path = tmp_path / f"broken{ending}"
    path.write_bytes(content)
    with pytest.raises(InvalidFile, match=rf"broken\{ending}"):
        read_mesh(path)


def test_without_trimesh_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "trimesh", None)
    (tmp_path / "a.stl").write_bytes(b"x")
    with pytest.raises(MissingPackage, match=r"pip install '.*\[assets\]'"):
        read_mesh(tmp_path / "a.stl")
    # OBJ needs nothing
    (tmp_path / "a.obj").write_text(obj_text(cube()), encoding="utf-8")
    assert len(read_mesh(tmp_path / "a.obj").triangles) == 12
