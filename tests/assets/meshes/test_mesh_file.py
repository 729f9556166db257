"""Meshes and their files: every format that is read, sizes with known answers, and refusals by name."""

import json
import os
import re
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from avatarsim.assets.meshes.mesh import BY_TRIMESH, groups_of, read_mesh, signed_volume
from avatarsim.assets.meshes.repairs import mended
from avatarsim.errors import InvalidFile, MissingPackage
from tests.assets.meshes.solids import cube, ell, obj_text


def exported(kind):
    """Return the content of a file, or the contents of several by their names, as trimesh writes the L."""
    return trimesh.Trimesh(*ell(), process=False).export(file_type=kind)


@pytest.mark.parametrize("ending", [".obj", *BY_TRIMESH])
def test_every_format_gives_the_same_solid(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"ell{ending}"
    written = exported(ending[1:])
    files = written if isinstance(written, dict) else {path.name: written}
    for name, content in files.items():
        (tmp_path / name).write_bytes(content.encode() if isinstance(content, str) else content)
    path = path if path.exists() else tmp_path / next(name for name in files if name.endswith(ending))
    sound = mended(read_mesh(path))
    assert sound.faults == () and sound.repairs == ()
    assert signed_volume(sound.mesh.corners) == pytest.approx(5.0, rel=1e-6)


def test_what_cannot_be_read_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(InvalidFile, match=r"nowhere\.stl.*existing file"):
        read_mesh(tmp_path / "nowhere.stl")
    with pytest.raises(InvalidFile, match=r"existing file"):
        read_mesh(tmp_path / ("a" * 300))
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


def test_collada_comes_in_metres_and_keeps_its_axes(tmp_path: Path) -> None:
    content = exported("dae").decode()
    path = tmp_path / "ell.dae"
    stated = '<asset><unit name="inch" meter="0.0254"/><up_axis>Y_UP</up_axis>'
    path.write_text(re.sub("<asset>.*?</asset>", f"{stated}</asset>", content, flags=re.DOTALL), encoding="utf-8")
    found = read_mesh(path)
    np.testing.assert_allclose(np.ptp(found.vertices, axis=0), 0.0254 * np.ptp(ell()[0], axis=0), rtol=1e-6)


@pytest.mark.parametrize(("before", "after", "thing"), [
    ("<COLLADA", '<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/hostname">]><COLLADA', "DOCTYPE or entity"),
    ("<asset>", '<asset><unit meter="0"/>', "unit of length"),
    ("<asset>", '<asset><unit meter="wide"/>', "mesh"),
    ("</COLLADA>", 9 * '<instance_node url="#a"/>' + "</COLLADA>", "instances of nodes"),
])
def test_collada_of_unknown_origin_is_looked_at_first(before: str, after: str, thing: str, tmp_path: Path) -> None:
    content = exported("dae").decode()
    path = tmp_path / "ell.dae"
    path.write_text(content.replace(before, after), encoding="utf-8")
    with pytest.raises(InvalidFile) as refused:
        read_mesh(path)
    assert refused.value.thing.startswith(thing) and "ell.dae" in refused.value.thing


def test_stl_that_is_cut_off_says_so(tmp_path: Path) -> None:
    content, path = exported("stl"), tmp_path / "cut.stl"
    for size in (10, 83, 84, 100, len(content) - 1):
        path.write_bytes(content[:size])
        with pytest.raises(InvalidFile, match=rf"length of cut\.stl \[bytes\] is {size}; valid: ({len(content)}|84)"):
            read_mesh(path)
    text = exported("stl_ascii")
    for part in (text[: len(text) // 2], text.rsplit("endsolid", 1)[0], text + text[: len(text) // 2]):
        path.write_text(part, encoding="utf-8")
        with pytest.raises(InvalidFile, match=r"end of cut\.stl is 'cut off within a solid'; valid: endsolid"):
            read_mesh(path)


def test_a_name_in_any_encoding_does_not_spoil_an_stl_text(tmp_path: Path) -> None:
    path = tmp_path / "named.stl"
    text = exported("stl_ascii")
    path.write_bytes(text.replace("solid", "solid caf\xe9", 1).encode("latin-1"))
    assert len(read_mesh(path).triangles) == len(ell()[1])


@pytest.mark.parametrize("unused", ["", "v 9 9 9\n"])
def test_a_byte_order_mark_costs_no_vertex(tmp_path: Path, unused: str) -> None:
    """With a vertex at the end that no face uses, every face would be one vertex off, without an error."""
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in cube()[0])
    faces = "".join("f " + " ".join(str(k + 1) for k in face) + "\n" for face in cube()[1])
    path = tmp_path / "marked.obj"
    path.write_text(vertices + unused + faces, encoding="utf-8-sig")
    mesh = read_mesh(path)
    np.testing.assert_array_equal(mesh.vertices[:8], cube()[0])
    np.testing.assert_array_equal(mesh.triangles, cube()[1])
    (group,) = groups_of(mesh)
    assert signed_volume(group.corners) == pytest.approx(signed_volume(cube()[0][cube()[1]]))


@pytest.mark.parametrize("ending", [".obj", ".stl", ".ply"])
def test_what_is_no_regular_file_or_too_large_is_refused_at_once(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"pipe{ending}"
    os.mkfifo(path)
    with pytest.raises(InvalidFile, match=rf"pipe\{ending}"):
        read_mesh(path)
    large = tmp_path / f"large{ending}"
    # 1 GB that takes no room on the disk
    with large.open("wb") as file:
        file.truncate(2**30)
    with pytest.raises(InvalidFile, match=r"size of mesh large.* is 1073741824; valid: up to"):
        read_mesh(large)


@pytest.mark.parametrize("named", ["pipe.bin", "../pipe.bin", "/dev/zero"])
def test_what_a_gltf_names_is_a_regular_file_beside_it(named: str, tmp_path: Path) -> None:
    files = exported("gltf")
    (text,) = (json.loads(content) for name, content in files.items() if name.endswith(".gltf"))
    text["buffers"][0]["uri"] = named
    folder = tmp_path / "folder"
    folder.mkdir()
    for place in (folder, tmp_path):
        os.mkfifo(place / "pipe.bin")
    (folder / "named.gltf").write_text(json.dumps(text), encoding="utf-8")
    with pytest.raises(InvalidFile, match=r"named\.gltf"):
        read_mesh(folder / "named.gltf")


def test_without_trimesh_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "trimesh", None)
    (tmp_path / "a.stl").write_bytes(b"x")
    with pytest.raises(MissingPackage, match=r"pip install '.*\[assets\]'"):
        read_mesh(tmp_path / "a.stl")
    # OBJ needs no package
    (tmp_path / "a.obj").write_text(obj_text(cube()), encoding="utf-8")
    assert len(read_mesh(tmp_path / "a.obj").triangles) == 12
