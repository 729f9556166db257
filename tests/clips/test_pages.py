"""Pages: marks that keep every frame, a policy that fits, texts that are data."""

import base64
import hashlib
import html
import json
import re
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.assets.models.model import Model
from avatarsim.cleaning import Options, audit
from avatarsim.clips.page.clip_page import PIECES, RUNS, Shown, replay, room_of, runs
from avatarsim.clips.page.layout import address, data, esc, page
from avatarsim.scene.body import fixed
from avatarsim.scene.shape import Box, ConvexHull, Piece
from tests.cleaning.rooms import lowered, model, swinging

GRID = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 7)] * 3), axis=-1).reshape(-1, 3)


def test_a_room_of_many_pieces_is_drawn_by_the_largest() -> None:
    rng = np.random.default_rng(1)
    balls = tuple(Piece(ConvexHull(0.1 * (k + 1) * GRID), (float(k), 0.0, 0.0)) for k in range(40))
    few = room_of(Model(None, None, (fixed("a", balls[:2], "wood"),), ()))
    assert len(few) == 1 and len(np.unique(few[0].surface[0].round(9), axis=0)) == 2 * 8
    ground = fixed("ground", (Piece(Box((5.0, 5.0, 1.0))),), "wood")
    stones = fixed("stones", tuple(Piece(ConvexHull(0.05 * rng.normal(size=(40, 3)))) for _ in range(PIECES + 200)), "wood")
    drawn = [one.surface[1] for one in room_of(Model(None, None, (stones, ground), ()))]
    assert len(drawn[1]) == 12 and sum(map(len, drawn)) < 20_000


def test_visuals_are_drawn_and_pieces_are_tested() -> None:
    table = fixed("table", (Piece(Box((1.0, 1.0, 1.0))),), "wood", (0.0, 0.0, 2.0))
    (found,) = room_of(Model(None, None, (table,), (), visuals={"table": (Piece(Box((1.0, 1.0, 0.2))),)}))
    assert found.tested is not None and found.tested[0].min() == -0.5 and found.tested[0].max() == 2.5
    assert found.surface[0][:, 2].min() == 1.9 and found.surface[0][:, 2].max() == 2.1


def test_the_player_knows_furniture_ground_and_overlaps() -> None:
    human, table = model(), fixed("table", (Piece(Box((1.0, 1.0, 0.5))),), "wood", (0.0, 0.0, 0.2))
    room = Model(None, None, (fixed("ground", (Piece(Box((100.0, 100.0, 1.0))),), "wood", (0.0, 0.0, -0.5)), table), ())
    assert [one.role for one in room_of(room)] == ["fixed", "furniture"]
    heights = np.array([2.0, 0.6, 2.0, 2.0])
    motion = lowered(swinging(4, 0.0), heights)
    before, after = (audit(one, human, room.room, Options(opinion=False)) for one in (motion, swinging(4, 2.0)))
    found: Any = replay("clip", Shown(human, room, motion, swinging(4, 2.0), before, after, ()), [])
    assert list(found["ghost_overlaps"]) == [1]
    roles = {found["bodies"][k]["role"] for k in found["ghost_overlaps"][1]}
    assert roles == {"driven", "furniture"} and found["views"][0]["pairs"] == {}


@given(st.lists(st.booleans(), min_size=1, max_size=300))
def test_runs_are_the_marked_frames(marked: list[bool]) -> None:
    found = runs(np.array(marked))
    assert {frame for first, last in found for frame in range(first, last + 1)} == {k for k, one in enumerate(marked) if one}
    assert all(first <= last for first, last in found)
    assert all(after[0] > before[1] + 1 for before, after in zip(found, found[1:], strict=False))


def test_many_runs_are_joined_and_none_is_lost() -> None:
    marked = np.zeros(100_000, dtype=bool)
    marked[::3] = True
    found = runs(marked)
    assert len(found) <= RUNS
    covered = np.zeros(len(marked), dtype=bool)
    for first, last in found:
        covered[first : last + 1] = True
    assert (covered | ~marked).all()


def test_the_policy_allows_its_own_style_and_script_alone() -> None:
    text = page("A & B", "<p>x</p>", "let a = 1;").decode()
    policy = html.unescape(re.findall(r'Content-Security-Policy" content="([^"]*)"', text)[0])
    for tag in ("style", "script"):
        [content] = re.findall(rf"<{tag}>(.*?)</{tag}>", text, re.DOTALL)
        digest = base64.b64encode(hashlib.sha256(content.encode()).digest()).decode()
        assert f"{tag}-src 'sha256-{digest}'" in policy
    assert policy.startswith("default-src 'none'; ") and "unsafe" not in policy and "<title>A &amp; B</title>" in text
    beside = page("A", "<p>x</p>", "let a = 1;", library="../three.js").decode()
    assert '<script src="../three.js">' in beside and beside.index("three.js") < beside.index("let a")
    without = page("A", "<p>x</p>").decode()
    assert "<script" not in without and html.escape("script-src 'none'") in without
    assert not re.findall(r"""(?:src|href)=["']?(?:https?:)?//""", text)


@given(st.text(max_size=60))
def test_any_text_is_text(text: str) -> None:
    assert not re.search(r"[<>\"']", esc(text)) and esc(text).isprintable()
    found = data("clip", {"name": text})
    assert found.count("<") == found.count(">") == 2
    assert json.loads(re.findall(r">(.*)<", found, re.DOTALL)[0]) == {"name": text}


def test_addresses_lead_to_files_of_any_name() -> None:
    assert address("deep/a b.bvh") == "deep/a%20b.bvh" and address("100%#?.bvh") == "100%25%23%3F.bvh"
    assert address("\ud800") == "%3F"
    assert address("bad\udcff") == "bad%FF" and address("\"'<>") == "%22%27%3C%3E"
