"""Pairs that never touch: parent and child, rigidly joined bodies, the file's exclusions, pairs that its masks separate."""

from pathlib import Path

import numpy as np
import pytest

import avatarsim as av
from tests.assets.models.test_links_of_tree import written


def arm(*attributes: str, deep: str = "") -> str:
    """Return a chain of bodies a, b, c, ... a metre apart, with attributes for the geom of each."""
    text = ""
    for name, attribute in reversed(list(zip("abcdef", attributes, strict=False))):
        joint = "<joint/>" if name not in deep else ""
        text = f'<body name="{name}" pos="1 0 0">{joint}<geom name="{name}" size="0.1" {attribute}/>{text}</body>'
    return text


def meeting(model: av.Model) -> set[frozenset[str]]:
    """Return the pairs of names that a scene of the model tests."""
    scene = model.scene()
    names = [name.partition("/")[2] or name for name in scene.names]
    return {frozenset((names[a], names[b])) for a, b in np.argwhere(scene.pair_filter)}


def pairs(*texts: str) -> set[frozenset[str]]:
    return {frozenset(text) for text in texts}


MASKED, TWO, OTHER = 'contype="1" conaffinity="0"', 'contype="2" conaffinity="2"', 'contype="4" conaffinity="2"'
EXCLUDED = '<contact><exclude body1="a" body2="d"/></contact>'
STATED = '<contact><pair geom1="d" geom2="a"/></contact>'


@pytest.mark.parametrize(("chain", "rest", "masks", "found"), [
    (arm("", "", "", ""), "", True, ("ac", "ad", "bd")),
    # c is rigid with b, so a and c, and b and d, are as parent and child
    (arm("", "", "", "", "", deep="c"), "", True, ("ad", "ae", "be", "ce")),
    (arm("", "", "", ""), EXCLUDED, True, ("ac", "bd")),
    (arm(MASKED, MASKED, MASKED, MASKED), "", True, ()), (arm(MASKED, MASKED, MASKED, MASKED), "", False, ("ac", "ad", "bd")),
    (arm(MASKED, MASKED, MASKED, MASKED), STATED, True, ("ad",)), (arm("", TWO, "", TWO, OTHER), "", True, ("ac", "bd", "be")),
])
def test_pairs_of_links_follow_the_file(chain: str, rest: str, masks: bool, found: tuple[str, ...], tmp_path: Path) -> None:
    """Parents and children do not meet, nor neighbours of what is rigid together, nor what is excluded or masked."""
    assert meeting(av.load_avatar(written(tmp_path, chain, rest), masks=masks)) == pairs(*found)


ROOM = (
    '<geom name="floor" type="plane" size="1 1 1" pos="0 0 -1" {floor}/>'
    '<body name="w" pos="0 5 0"><freejoint/><geom size="0.1" {loose}/></body>'
)


@pytest.mark.parametrize(("floor", "loose", "found"), [
    ("", "", ("af", "bf", "cf", "aw", "bw", "cw", "fw")), ('contype="2" conaffinity="2"', "", ("aw", "bw", "cw")),
    ("", 'contype="0" conaffinity="2"', ("af", "bf", "cf")),
])
def test_pairs_with_the_room_follow_the_file(floor: str, loose: str, found: tuple[str, ...], tmp_path: Path) -> None:
    room = ROOM.format(floor=floor, loose=loose)
    model = av.load_avatar(written(tmp_path, arm("", "", "") + room))
    wanted = {frozenset("floor" if name == "f" else name for name in pair) for pair in found}
    assert meeting(model) == wanted | pairs("ac")


def test_links_that_are_fixed_never_meet_the_room(tmp_path: Path) -> None:
    model = av.load_avatar(written(tmp_path, arm("", "", "", deep="a") + ROOM.format(floor="", loose="")))
    assert frozenset(("a", "floor")) not in meeting(model) and frozenset(("a", "w")) in meeting(model)
