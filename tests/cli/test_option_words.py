"""Advice of readers in the words of the command line: each option that a sentence names is one that the command takes."""

import shlex
from pathlib import Path

import pytest

from avatarsim.cli import main
from avatarsim.cli.arguments import options_of
from avatarsim.cli.option_words import ARGUMENT, in_words
from tests.assets.meshes.solids import ell, obj_text
from tests.clips.made import bvh

SAID = {
    'fix=("elbow", ...) or fix="all" holds': ("fix", "fix"), 'leave=("geom 0 of world",) leaves it out': ("leave",),
    'folder="/a b" allows it': ("folder",),
    "rate= does": ("file-rate",), "skeleton= names": ("asf",), "limits=False leaves joints free": ("no-limits",),
    'offsets="mean" for': ("offsets",), 'quaternion="xyzw" says': ("quaternion",), "repair='remesh' to wrap": ("repair",),
    'meshes="hull" takes': ("meshes",),
    'type="fixed" does not move': (), "a.b=3 c-scale=2": (),
}
"""Advice of the library, and the options that `avatarsim clean` names in its place."""


@pytest.mark.parametrize("sentence", SAID)
def test_arguments_become_options_that_the_command_takes(sentence: str) -> None:
    for command in ("clean", "audit", "live"):
        named = tuple(word[2:] for word in shlex.split(in_words(sentence, command)) if word.startswith("--"))
        assert named == SAID[sentence] and options_of(command).issuperset(named)
    assert in_words(sentence, "replay") == sentence


MODEL = """<mujoco><worldbody>{}<body name="a"><joint name="swing"/><geom name="g" size="0.1"/>
<body name="b" pos="0 0 1"><joint name="lift" type="slide"/><geom size="0.1" pos="0 0 1"/></body></body></worldbody></mujoco>"""
CURVE = '<equality><joint joint1="lift" joint2="swing" polycoef="0 1 1 0 0"/></equality>'
BAD = {
    "curve.xml": MODEL.format("").replace("</worldbody>", f"</worldbody>{CURVE}"),
    "wrong.xml": MODEL.format("").replace('size="0.1"', 'size="-1"'),
    "hole.obj": obj_text((ell()[0], ell()[1][1:])), "none.obj": None, "text.obj": "v a b c\n", "text.bvh": "no motion",
    "none.bvh": None, "none.live": None, "text.live": "no recording",
}
"""Files that are no input, by the ends of their names."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in BAD.items():
        if text is not None:
            (tmp_path / name).write_text(text)
    bvh(tmp_path / "good.bvh", frames=4)
    (tmp_path / "good.xml").write_text(MODEL.format("").replace(' type="slide"', ""))
    return tmp_path


@pytest.mark.parametrize("words", [
    *(f"{command} good.bvh {option} {name}" for command in ("clean -o out", "audit") for option, name in (
        ("--room", "hole.obj"), ("--room", "none.obj"), ("--room", "text.obj"),
        ("--avatar", "curve.xml"), ("--avatar", "wrong.xml"), ("--avatar", "hole.obj"),
    )),
    *(f"{command} {name}" for command in ("clean -o out", "audit") for name in ("none.bvh", "text.bvh")),
    *(f"live --no-browser --avatar {words}" for words in (
        "curve.xml", "wrong.xml", "good.xml --room hole.obj", "good.xml --room text.obj", "good.xml --motion text.bvh",
    )),
    "replay none.live", "replay text.live", "pieces hole.obj", "pieces none.obj", "pieces text.obj",
])
def test_files_that_cannot_be_used_end_a_command_with_3(
    words: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    assert main([*shlex.split(words), *(["--workers", "0"] if words.startswith(("clean", "audit")) else [])]) == 3
    said = capsys.readouterr().err
    assert any(name in said for name in BAD)
    # nothing is left of Python's way to name an option
    assert not [found[0] for found in ARGUMENT.finditer(said) if found[1] in {"fix", "repair", "hull", "leave", "root", "meshes"}]


@pytest.mark.parametrize("words", [
    "clean good.bvh -o out --rate 0", "clean good.bvh -o out --margin 5", "audit good.bvh --workers -1",
    "clean good.bvh -o out --rate 1e6", "clean good.bvh -o out --rate 0.5", "audit good.bvh --rate -60",
    "audit good.bvh --rate nan",
    "audit good.bvh --file-rate 1e9", "audit good.bvh --scale 1e9", "audit good.bvh --scale 0", "audit good.bvh --mass 1e9",
    "audit good.bvh --stature 9", "audit good.bvh --avatar good.xml --avatar-scale 1e9", "audit good.bvh --workers 100000",
    "audit good.bvh --room floor --room-scale -1", "clean good.bvh -o out --margin -1", "clean good.bvh -o out --blend inf",
    "live --no-browser --rate 1e6", "live --no-browser --seconds inf", "live --no-browser --udp 99999",
    "live --no-browser --ws -1",
    "live --no-browser --avatar good.xml --avatar-scale 1e9", "live --no-browser --avatar good.xml --port 1e6",
    "pieces hole.obj --scale -1", "pieces hole.obj --threshold 7", "pieces hole.obj --most-vertices 1000000",
    "pieces hole.obj --most-pieces 0", "pieces hole.obj --seed -1",
])
def test_numbers_out_of_range_are_wrong_usage(
    words: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    try:
        code = main(shlex.split(words))
    except SystemExit as end:
        code = int(str(end.code))
    said = capsys.readouterr().err
    assert code == 2 and said and not (folder / "out").exists()


def test_options_of_readers_reach_live(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    words = "live --no-browser --port 0 --seconds 0.2 --avatar curve.xml --fix lift"
    assert main(words.split()) == 0
