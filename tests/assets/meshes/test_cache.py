"""Cached results: the same bits back, damage detected, unwritable folders, concurrent writers."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from avatarsim.assets.meshes import cache
from avatarsim.assets.meshes.cache import Answer, key_of, load, store
from avatarsim.assets.meshes.decompose import PieceOptions
from avatarsim.assets.meshes.hausdorff import Deviation
from tests.assets.meshes.solids import cube, ell, mesh

RNG = np.random.default_rng(0)
ANSWER = Answer((RNG.normal(size=(8, 3)), RNG.normal(size=(5, 3))), "decomposed", Deviation(0.1, 0.2, 0.15), ("one thing",))


def same(one: Answer | None, other: Answer) -> bool:
    if one is None or (one.source, one.deviation, one.repairs) != (other.source, other.deviation, other.repairs):
        return False
    return all(np.array_equal(a, b) for a, b in zip(one.hulls, other.hulls, strict=True))


@pytest.mark.parametrize("option", [
    {"threshold": 0.06}, {"seed": 1}, {"most_vertices": 32}, {"most_pieces": 3}, {"hull": True}, {"repair": "remesh"},
])
def test_every_wish_and_every_number_of_the_mesh_is_in_the_key(option: dict[str, object]) -> None:
    thing = mesh(cube())
    assert key_of(thing, PieceOptions()) == key_of(mesh(cube(), "other name"), PieceOptions())
    assert key_of(thing, PieceOptions()) != key_of(thing, PieceOptions(**option))  # type: ignore[arg-type]
    others = (mesh(ell()), mesh(cube(0.0, 1.0 + 1e-15)), replace(thing, groups=thing.groups + 1))
    assert len({key_of(one, PieceOptions()) for one in (thing, *others)}) == 4


def test_where_nothing_can_be_written_the_answer_is_not_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # a file in place of the folder stops every user, root too
    blocked = tmp_path / "blocked"
    blocked.write_text("", encoding="utf-8")
    monkeypatch.setattr(cache, "_folders", lambda: iter([blocked / "pieces"]))
    assert store("k", ANSWER) == "not kept: no cache folder can be written to"
    assert load("k") == (None, "")
    monkeypatch.setattr(cache, "_folders", lambda: iter([blocked / "pieces", tmp_path / "second"]))
    assert store("k", ANSWER) == f"kept in {tmp_path / 'second' / 'k.npz'}"
    assert same(load("k")[0], ANSWER)


def test_writers_and_readers_at_once_see_whole_entries_only() -> None:
    script = (
        "from tests.assets.meshes.test_cache import ANSWER, same\nfrom avatarsim.assets.meshes.cache import load, store\n"
        "for _ in range(60):\n    store('k', ANSWER)\n    assert same(load('k')[0], ANSWER)\n"
    )
    house = Path(__file__).resolve().parents[3]
    children = [subprocess.Popen([sys.executable, "-c", script], cwd=house, stderr=subprocess.PIPE) for _ in range(2)]
    for child in children:
        complaint = child.communicate(timeout=120)[1]
        assert child.returncode == 0, complaint.decode()
