"""Malicious files: each is refused with file, place and valid range, within time and memory limits."""

import os
import resource
import struct
from pathlib import Path

import pytest

import avatarsim as av
from avatarsim.assets.models import compiled
from avatarsim.assets.models.compile_process import MEMORY
from avatarsim.errors import InvalidFile
from tests.assets.models.in_process import IN_A_PROCESS

BODY = '<worldbody><body><joint/><geom size="0.1"/></body></worldbody>'
MESH = '<mujoco><asset><mesh name="m" file="{}"/></asset><worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>'
BALLS = '<?xml version="1.0"?><!DOCTYPE m [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]><mujoco model="&b;">' + BODY + "</mujoco>"
CHAIN = "".join('<body pos="0 0 1"><joint/><geom size="0.1"/>' for _ in range(300)) + "</body>" * 300


def asset(inside: str, after: str = "") -> str:
    """Return a model of one asset."""
    return f"<mujoco><asset>{inside}</asset>{after}</mujoco>"


def world(inside: str) -> str:
    """Return a model of one world."""
    return f"<mujoco><worldbody>{inside}</worldbody></mujoco>"


GRID = '<flexcomp name="f" type="grid" count="1000 1000 1000" spacing="1 1 1"/>'
COPIES = '<replicate count="100000000" offset="1 0 0"><geom size="0.1"/></replicate>'
PLUGIN = '<mujoco><asset><mesh name="m"><plugin plugin="mujoco.sdf.bolt"/></mesh></asset></mujoco>'
TEXTS = {
    "nothing": ("", "cut off or not XML"), "no XML": ("solid cube\nfacet normal", "cut off or not XML"),
    "cut off": ("<mujoco><worldbody>", "cut off or not XML"),
    "two roots": (f"<mujoco>{BODY}</mujoco><mujoco/>", "cut off or not XML"),
    "another format": ("<html><body/></html>", "valid: a model that MuJoCo's compiler takes"),
    "entities": (BALLS, r"DOCTYPE or entity in bad\.xml, line 1, is 'm'"),
    "external entity": ('<!DOCTYPE m SYSTEM "file:///etc/passwd"><mujoco/>', "DOCTYPE or entity in bad.xml, line 1"),
    "plugin": (PLUGIN, r"<plugin> in bad\.xml, line 1, is 'mujoco\.sdf\.bolt'; valid: shapes without"),
    "absolute mesh": (MESH.format("/etc/passwd"), r"file of <mesh> in bad\.xml, line 1, is '/etc/passwd'; valid: a path rel"),
    "home": (MESH.format("~/secret.stl"), "a path relative to the file"),
    "drive": (MESH.format("C:\\\\secret.stl"), "a path relative to the file"),
    "another scheme": (MESH.format("http://x/y.stl"), "a path relative to the file"),
    "mesh outside": (MESH.format("../../a.stl"), r"mesh m of bad\.xml is '\.\./\.\./a\.stl'; valid: a path that stays in"),
    "folder outside": (f'<mujoco><compiler meshdir="../.."/>{BODY}</mujoco>', r"meshdir of <compiler> in bad\.xml, line 1, is"),
    "include outside": ('<mujoco><include file="../other.xml"/></mujoco>', r"file of <include> in bad\.xml, line 1, is"),
    "include missing": ('<mujoco>\n<include file="gone.xml"/></mujoco>', r"bad\.xml, line 2, is 'gone\.xml'; valid: a file"),
    "includes itself": ('<mujoco><include file="bad.xml"/></mujoco>', "bad.xml"),
    "absolute texture": (asset('<texture name="t" type="2d" file="/dev/zero"/>'), "file of <texture> in bad.xml, line 1"),
    "absolute attached": (asset('<model name="t" file="/etc/passwd"/>'), "file of <model>"),
    "deformable file": (world('<flexcomp name="f" type="mesh" file="a.obj"/>'), "file of <flexcomp> in bad.xml"),
    "mesh of no format": (MESH.format("bad.xml"), r"mesh m of bad\.xml is 'bad\.xml'; valid: a file \.msh \.obj \.stl"),
    "deep": ("<mujoco>" + "<a>" * 1000 + "</a>" * 1000 + "</mujoco>", "depth of elements in bad.xml, line 1, is 201; .* 200"),
    "deep bodies": (world(CHAIN), "depth of elements"),
    "many elements": ("<mujoco>" + "<a/>" * 200_001 + "</mujoco>", "number of elements"),
    "long name": (world(f'<body name="{"a" * 300}"><geom size="1"/></body>'), "characters of a name in bad.xml is 300; .* 200"),
    "not a number": (world('<geom size="0.1" pos="nan 0 0"/>'), "bad.xml"),
    "infinite": (world('<geom name="g" size="0.1" pos="1e300 0 0"/>'), "position"), "huge grid": (world(GRID), "bad.xml"),
    "replicated": (world(COPIES), "time to compile model bad.xml is 'too long'; valid: a smaller model"),
    "huge field": (asset('<hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/>', BODY), "valid: a model that"),
}
"""Name -> text of a file bad.xml, and a part of its error."""
HUGE = {"cut off", "entities", "deep", "deep bodies", "many elements", "infinite", "huge grid", "replicated", "huge field"}
"""Texts that go to the compiler in a process of its own, with limits."""


@pytest.mark.parametrize("name", TEXTS)
def test_each_text_is_refused(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text, said = TEXTS[name]
    folder = tmp_path / "one" / "two"
    folder.mkdir(parents=True)
    (tmp_path / "one" / "other.xml").write_text(f"<mujoco>{BODY}</mujoco>")
    (folder / "bad.xml").write_text(text)
    if name in HUGE:
        monkeypatch.setattr(compiled, "_run", IN_A_PROCESS)
    with pytest.raises(InvalidFile, match=said):
        av.load_room(folder / "bad.xml")
    # the largest of all awaited processes
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024 < MEMORY


def test_links_that_lead_out_are_not_followed(tmp_path: Path) -> None:
    folder, outside = tmp_path / "model", tmp_path / "secret.stl"
    folder.mkdir()
    outside.write_bytes(b"\0" * 84)
    (folder / "mesh.stl").symlink_to(outside)
    (folder / "bad.xml").write_text(MESH.format("mesh.stl"))
    with pytest.raises(InvalidFile, match=r"mesh m of bad\.xml is 'mesh\.stl, a link to .*secret\.stl'"):
        av.load_room(folder / "bad.xml")
    (folder / "round.xml").symlink_to(folder / "round.xml")
    with pytest.raises(InvalidFile):
        av.load_room(folder / "round.xml")


def test_pipes_and_folders_are_no_files(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.stl")
    (tmp_path / "bad.xml").write_text(MESH.format("pipe.stl"))
    with pytest.raises(InvalidFile, match="mesh m of bad.xml is 'a pipe, a socket or a device'"):
        av.load_room(tmp_path / "bad.xml")
    (tmp_path / "folder.xml").mkdir()
    with pytest.raises(InvalidFile, match="a folder"):
        av.load_room(tmp_path / "folder.xml")


@pytest.mark.parametrize("count", [2**31, 10**9, 5])
def test_a_mesh_that_says_it_is_larger_than_it_is_is_refused(count: int, tmp_path: Path) -> None:
    (tmp_path / "mesh.stl").write_bytes(b"\0" * 80 + struct.pack("<I", count) + b"\0" * 50)
    (tmp_path / "bad.xml").write_text(MESH.format("mesh.stl"))
    with pytest.raises(InvalidFile, match=rf"mesh\.stl \[bytes\] is 134; valid: {84 + 50 * count}, for the {count} triangles"):
        av.load_room(tmp_path / "bad.xml")


def test_comments_hide_nothing(tmp_path: Path) -> None:
    # text that the reader here takes for a comment is one for the compiler too: it reads the same text
    hidden = '<extension><plugin plugin="mujoco.pid"/></extension>'
    text = f'<mujoco model="<!--">{hidden}<custom><text name="a" data="-->"/></custom>{BODY}</mujoco>'
    (tmp_path / "bad.xml").write_text(text)
    with pytest.raises(InvalidFile):
        av.load_avatar(tmp_path / "bad.xml")
    (tmp_path / "good.xml").write_text(f"<mujoco><!-- a -- b <plugin/> -->{BODY}</mujoco>")
    assert av.load_avatar(tmp_path / "good.xml").avatar is not None


HIDDEN = '<geom name="hidden" size=".1"/>'


@pytest.mark.parametrize("after", [f"<![CDATA[{HIDDEN}]]>", f"<![CDATA[]]><![CDATA[{HIDDEN}]]>", HIDDEN.replace("<", "&lt;")])
@pytest.mark.parametrize("plugin", ["<plugin/>", '<plugin plugin="a>b">\n<plugin/></plugin >'])
def test_text_after_an_element_that_is_left_out_stays_text(after: str, plugin: str, tmp_path: Path) -> None:
    (tmp_path / "bad.xml").write_text(world(f"<body>{plugin}{after}</body><geom name='seen' size='1'/>"))
    assert [body.name for body in av.load_room(tmp_path / "bad.xml").bodies] == ["seen"]


def test_plugins_of_other_programs_in_urdf_are_nothing_to_it(tmp_path: Path) -> None:
    link = '<link name="a"><collision><geometry><sphere radius="1"/></geometry></collision></link>'
    (tmp_path / "robot.urdf").write_text(f'<robot name="r">{link}<gazebo><plugin name="p" filename="libp.so"/></gazebo></robot>')
    assert av.load_avatar(tmp_path / "robot.urdf").avatar is not None
    (tmp_path / "robot.urdf").write_text(f'<robot name="r">{link}<mujoco><plugin plugin="p"/></mujoco></robot>')
    with pytest.raises(InvalidFile, match="<plugin> in robot.urdf"):
        av.load_avatar(tmp_path / "robot.urdf")


def test_loading_leaves_no_files_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(scratch))
    monkeypatch.setattr(compiled, "_run", IN_A_PROCESS)
    folder = tmp_path / "model"
    folder.mkdir()
    (folder / "bad.xml").write_text(f"<mujoco>{BODY}<contact><exclude body1='none' body2='no'/></contact></mujoco>")
    with pytest.raises(InvalidFile):
        av.load_avatar(folder / "bad.xml")
    assert list(scratch.iterdir()) == [] and [path.name for path in folder.iterdir()] == ["bad.xml"]
