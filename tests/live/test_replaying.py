"""Recordings replay to the same bits; damage is refused with its place, and torn ends are read."""

import json
import struct
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.engine import Settings
from avatarsim.errors import InvalidFile
from avatarsim.live import recording
from avatarsim.live.messages import Command, Order, Switch
from avatarsim.live.orders import World
from avatarsim.live.recording import BEFORE, COMMAND, FORMAT, FRAME, HEAD, MAGIC, ROW, SUM, Recorder, read
from avatarsim.live.replaying import Difference, replay
from tests.live.small import plan, pushed

BETWEEN = {
    20: Command(Order.KEEP), 50: Command(Order.SWITCH, Switch(("friction", "self_contact"))), 80: Command(Order.KEEP),
    100: Command(Order.BACK), 120: Command(Order.SWITCH, Switch((), "paper")), 150: Command(Order.SWITCH, Switch()),
    170: Command(Order.BACK),
}
"""Commands before the frames of these numbers."""


def wrapped(kind: int, payload: bytes) -> bytes:
    """Return a row whose checksums are right."""
    begun = ROW.pack(kind, len(payload))
    row = begun + SUM.pack(zlib.crc32(begun)) + payload
    return row + SUM.pack(zlib.crc32(row))


def recorded(path: Path, frames: int = 200, between: dict[int, Command] = BETWEEN) -> Path:
    """Return a recording of a driven run with commands in it."""
    world = World(plan())
    recorder = Recorder(path, world.plan, world.shown.state_hash())
    for frame in range(1, frames + 1):
        if frame in between:
            assert world.apply(between[frame]) == ""
            recorder.command(between[frame])
        recorder.frame(pushed(frame), world.advance(pushed(frame)).state_hash())
    recorder.close()
    return path


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Return the bytes of a recording of 200 frames."""
    return recorded(tmp_path_factory.mktemp("whole") / "a.live").read_bytes()


def test_what_was_driven_runs_again_to_the_same_bits(whole: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.live").write_bytes(whole)
    found = read(tmp_path / "a.live")
    assert found.frames == 200 and len(found.rows) == 207 and not found.is_torn and found.plan.rate == 60.0
    seen = list[int]()
    done = replay(found, lambda frame, record: seen.append(frame))
    assert done.difference is None and done.frames == 200 and seen == list(range(1, 201))
    # a torn one up to its last whole row
    (tmp_path / "a.live").write_bytes(whole[:-60])
    found = read(tmp_path / "a.live")
    assert found.is_torn and 190 < found.frames < 200 and replay(found).difference is None


@pytest.mark.parametrize("first", [Switch(("friction", "dynamics")), Switch(("self_contact", "friction"), "paper")])
def test_a_log_from_a_reset_on_knows_what_its_author_left_on(tmp_path: Path, first: Switch) -> None:
    """Effects are switched off before the reset, and on again after it."""
    world = World(plan())
    assert world.apply(Command(Order.SWITCH, first)) == "" and world.apply(Command(Order.RESET)) == ""
    recorder = Recorder(tmp_path / "a.live", world.begun, world.shown.state_hash())
    for frame in range(1, 61):
        if frame == 30:
            assert world.apply(back := Command(Order.SWITCH, Switch())) == ""
            recorder.command(back)
        recorder.frame(pushed(frame), world.advance(pushed(frame)).state_hash())
    recorder.close()
    assert world.scene.effects == plan().scene.effects
    done = replay(read(tmp_path / "a.live"))
    assert done.frames == 60 and done.difference is None


@pytest.mark.parametrize(("start", "wrong"), [(None, 12), ("0" * 16, 0)])
def test_a_difference_is_found_at_its_frame(tmp_path: Path, start: str | None, wrong: int) -> None:
    world = World(plan())
    recorder = Recorder(tmp_path / "a.live", world.plan, start or world.shown.state_hash())
    for frame in range(1, 31):
        recorder.frame(pushed(frame + (frame == 12)), world.advance(pushed(frame)).state_hash())
    recorder.close()
    difference = replay(read(tmp_path / "a.live")).difference
    assert isinstance(difference, Difference) and difference.frame == wrong and difference.recorded != difference.replayed


@given(data=st.data())
def test_no_flipped_byte_is_read(data: st.DataObject, whole: bytes, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("flipped") / "a.live"
    at, value = data.draw(st.integers(0, len(whole) - 1)), data.draw(st.integers(0, 255))
    path.write_bytes(whole[:at] + bytes([value]) + whole[at + 1:])
    try:
        found = read(path)
    except InvalidFile as error:
        assert "a.live" in str(error)
    else:
        assert whole[at] == value and not found.is_torn


@given(cut=st.integers(0, 40_000))
def test_any_cut_is_refused_in_the_head_and_said_behind_it(
    cut: int, whole: bytes, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("cut") / "a.live"
    path.write_bytes(whole[:cut])
    head = len(MAGIC) + HEAD.size + HEAD.unpack_from(whole, len(MAGIC))[1] + SUM.size
    if cut < head:
        with pytest.raises(InvalidFile, match=r"a\.live"):
            read(path)
        return
    whole_rows, at = 0, head
    while at < min(cut, len(whole)):
        at += BEFORE + ROW.unpack_from(whole, at)[1] + SUM.size
        whole_rows += at <= cut
    found = read(path)
    assert len(found.rows) == whole_rows and found.is_torn == (at > cut)



@given(data=st.binary(max_size=200))
def test_what_is_no_recording_is_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    folder = tmp_path_factory.mktemp("bytes")
    (folder / "b.live").write_bytes(data)
    for path in (folder / "b.live", folder / "none.live", folder):
        with pytest.raises(InvalidFile, match=path.name):
            read(path)


@pytest.mark.parametrize(("row", "says"), [
    (wrapped(3, b""), "kind of row 2"), (wrapped(FRAME, b"12345678"), "bytes of row 2"),
    (wrapped(FRAME, bytes(8) + np.full(16, np.nan).tobytes()), "row 2 of recording a.live"),
    (wrapped(FRAME, bytes(8 + 8 * 16)), "tracker rotation of link 0"),
    (wrapped(COMMAND, b"[" * 5000), "row 2"), (wrapped(COMMAND, b"\xff"), "not UTF-8"),
    (wrapped(COMMAND, b'{"order": "RESET"}'), "KEEP, BACK, TAKE, PINCH, SWITCH"),
    (wrapped(COMMAND, b'{"order": ["KEEP"]}'), "order of row 2"),
    (wrapped(COMMAND, b'{"order": "PINCH", "on": 1}'), "switch of row 2"),
    (wrapped(COMMAND, b'{"order": "SWITCH", "off": [1], "preset": "", "options": {}}'), "effects of row 2"),
    (wrapped(COMMAND, b'{"order": "SWITCH", "off": [], "preset": 1, "options": {}}'), "settings of row 2"),
])
def test_a_row_that_is_none_is_refused_by_its_number(tmp_path: Path, row: bytes, says: str) -> None:
    path = recorded(tmp_path / "a.live", 2, {})
    path.write_bytes(path.read_bytes() + row)
    with pytest.raises(InvalidFile, match=says):
        read(path)


def test_numbers_of_numpy_and_whole_rates_come_back(tmp_path: Path) -> None:
    options = {"stand_off": np.float64(1e-4), "steps": np.int64(9)}
    one = replace(plan(), rate=60, settings=Settings(options=options))
    world = World(one)
    recorder = Recorder(tmp_path / "a.live", one, world.shown.state_hash())
    recorder.command(Command(Order.SWITCH, Switch((), "default", options)))
    recorder.close()
    found = read(tmp_path / "a.live")
    assert found.plan.rate == 60.0 and found.plan.settings.options == options
    assert isinstance(found.rows[0], Command) and found.rows[0].value == Switch((), "default", options)


def test_commands_count_as_rows_of_the_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recording, "FRAMES", 5)
    recorder = Recorder(tmp_path / "a.live", plan(), "0" * 16)
    for _ in range(9):
        recorder.command(Command(Order.KEEP))
    assert not recorder.is_open and len(read(tmp_path / "a.live").rows) == 5


@pytest.mark.parametrize(("name", "says"), [("BODIES", "bodies of"), ("LINKS", "links of"), ("JSON_BYTES", "bytes of the head")])
def test_what_is_too_large_to_read_is_not_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, says: str
) -> None:
    recorded(tmp_path / "a.live", 2, {})
    monkeypatch.setattr(recording, name, 1)
    with pytest.raises(InvalidFile, match=says):
        read(tmp_path / "a.live")
    with pytest.raises(OSError, match="large"):
        Recorder(tmp_path / "b.live", plan(), "0" * 16)


def headed(folder: Path, old: bytes, new: bytes) -> Path:
    """Return a recording with a part of its head replaced and its checksum updated."""
    data = recorded(folder / "c.live", 2, {}).read_bytes()
    start = len(MAGIC) + 8
    (length,) = struct.unpack_from("<I", data, len(MAGIC) + 4)
    head = data[start: start + length].replace(old, new, 1)
    assert head != data[start: start + length]
    assert isinstance(json.loads(head.replace(b"NaN", b"0")), dict)
    mended = MAGIC + struct.pack("<II", FORMAT, len(head)) + head + struct.pack("<I", zlib.crc32(head))
    (folder / "c.live").write_bytes(mended + data[start + length + 4:])
    return folder / "c.live"


@pytest.mark.parametrize(("old", "new", "says"), [
    (b'"avatarsim.simulator:AvatarsimEngine"', b'"os:system"', "engine of recording c.live is 'os:system'"),
    (b'"rate": 60.0', b'"rate": 1e9', "rate of recording c.live"), (b'"rate": 60.0', b'"rate": true', "rate in the head"),
    (b'"rate": 60.0', b'"rate": NaN', "NaN is no number"), (b'"seed": 0', b'"seed": 0.5', "seed in the head"),
    (b'"radius": 0.04', b'"radius": -1.0', "sphere radius"), (b'"is": "Sphere"', b'"is": "Spherf"', "one of Sphere"),
    (b'"bodies": [', b'"bodies": [1, ', r"scene\.bodies\[0\]"),
])
def test_a_head_that_is_none_is_refused_by_its_place(tmp_path: Path, old: bytes, new: bytes, says: str) -> None:
    with pytest.raises(InvalidFile, match=says):
        read(headed(tmp_path, old, new))


def test_a_recorder_stops_at_its_limit_and_what_it_has_is_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recording, "BYTES", 20_000)
    world = World(plan())
    recorder = Recorder(tmp_path / "a.live", world.plan, world.shown.state_hash())
    for frame in range(1, 301):
        recorder.frame(pushed(frame), world.advance(pushed(frame)).state_hash())
    assert not recorder.is_open
    recorder.flush()
    recorder.close()
    found = read(tmp_path / "a.live")
    assert 20 < found.frames < 300 and not found.is_torn and replay(found).difference is None
