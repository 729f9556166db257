"""Clips that a folder's certificate lists as not done: of the last command, and of all commands before."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from avatarsim.clips import certificate
from avatarsim.clips.batch import INDEX, UNFINISHED, WHOLE, Batch, leave, left_undone
from avatarsim.clips.task import CERTIFICATES, Outcome
from avatarsim.clips.whole_files import write_whole
from avatarsim.errors import InvalidFile
from tests.clips.entries import entry

BROKEN = ("x.bvh", "unreadable", "cut off")


def done(out: Path, place: str) -> Outcome:
    """Return a clip with a result in the folder."""
    one: dict[str, Any] = entry() | {"motion": place}
    write_whole(out / CERTIFICATES / f"{place}.json", certificate.text(one))
    return Outcome(place, one)


def undone(out: Path) -> dict[str, str]:
    """Return the list of the folder's certificate: kinds by names."""
    whole = json.loads((out / WHOLE).read_text())
    jsonschema.validate(whole, certificate.schema())
    return {one["name"]: one["kind"] for one in whole["not_done"]}


def command(out: Path, *clips: str) -> Batch:
    """Return a command into the folder with these clips, of which none is done yet."""
    batch = Batch(clips=frozenset(clips), earlier=left_undone(out, frozenset(clips)))
    leave(out, batch)
    return batch


def ended(out: Path, batch: Batch, *clips: str, broken: tuple[str, str, str] | None = None) -> None:
    """The command with these clips done, and one that cannot be."""
    batch.outcomes += [done(out, place) for place in clips]
    if broken is not None:
        batch.outcomes.append(Outcome(broken[0], trouble=(broken[1], broken[2])))
        batch.troubles.append(broken)
    leave(out, batch)


def test_what_a_command_asks_for_is_not_done_before_it_is(tmp_path: Path) -> None:
    batch = command(tmp_path, "a.bvh", "b.bvh")
    assert undone(tmp_path) == {"a.bvh": UNFINISHED, "b.bvh": UNFINISHED}
    assert "2 not done" in (tmp_path / INDEX).read_text("utf-8")
    ended(tmp_path, batch, "b.bvh")
    assert undone(tmp_path) == {"a.bvh": UNFINISHED}
    ended(tmp_path, batch, "a.bvh")
    assert undone(tmp_path) == {}


def test_a_second_command_keeps_what_the_first_left_undone(tmp_path: Path) -> None:
    ended(tmp_path, command(tmp_path, "a.bvh", "x.bvh"), "a.bvh", broken=BROKEN)
    ended(tmp_path, command(tmp_path, "b.bvh"), "b.bvh")
    assert undone(tmp_path) == {"x.bvh": "unreadable"}
    # requested again, the clip has its new result
    ended(tmp_path, command(tmp_path, "x.bvh"), broken=("x.bvh", "no free posture", "deep"))
    assert undone(tmp_path) == {"x.bvh": "no free posture"}
    ended(tmp_path, command(tmp_path, "x.bvh"), "x.bvh")
    assert undone(tmp_path) == {}


def test_a_clip_that_got_worse_is_not_done_and_keeps_its_result(tmp_path: Path) -> None:
    ended(tmp_path, command(tmp_path, "x.bvh"), "x.bvh")
    ended(tmp_path, command(tmp_path, "x.bvh"), broken=BROKEN)
    ended(tmp_path, command(tmp_path, "b.bvh"), "b.bvh")
    assert undone(tmp_path) == {"x.bvh": "unreadable"}
    whole = json.loads((tmp_path / WHOLE).read_text())
    assert [one["motion"] for one in whole["clips"]] == ["b.bvh", "x.bvh"]


@pytest.mark.parametrize("content", [b"{", b"[]", b'{"not_done": 3}', b'{"not_done": [{"name": 3}]}', b"\xff"])
def test_a_damaged_certificate_of_the_folder_is_refused(tmp_path: Path, content: bytes) -> None:
    assert left_undone(tmp_path, frozenset()) == ()
    (tmp_path / WHOLE).write_bytes(content)
    with pytest.raises(InvalidFile, match=WHOLE):
        left_undone(tmp_path, frozenset())
