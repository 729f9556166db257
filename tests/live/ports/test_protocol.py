"""Messages from trackers: valid ones are read, and all others are refused for a stated reason and in no other way."""

import json
import math
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.errors import InvalidSample
from avatarsim.live.ports.protocol import HEAD, MOST_METRES, SAMPLE, UNIT, Goals, Shape, parse
from avatarsim.live.ports.refusals import Refusal, Refused
from avatarsim.scene.tracker import TrackerSample
from tests.live.ports.opened import json_sample, packed_sample

LINKS = ("left/palm", "left/tip", "right/palm", "ball_hand")
SHAPE = Shape(LINKS, 2, ("table", *LINKS), LINKS)
TURNED = [[1.0, 0.0, 0.0, 0.0]] * 4
GOOD = {"positions": [[0.0, 0.1, 0.2]] * 4, "rotations": TURNED, "angles": [0.1, -0.2]}
GOOD_PACKED = packed_sample(TrackerSample(0.0, np.ones((4, 3)), np.array(TURNED), np.zeros(2)))


def refused(data: bytes | str, shape: Shape = SHAPE) -> Refusal:
    """Return the reason for which a message is refused."""
    with pytest.raises(Refused) as caught:
        parse(data, shape)
    assert isinstance(caught.value, InvalidSample) and caught.value.valid and len(str(caught.value)) < 1000
    return caught.value.reason


def changed(**keys: object) -> str:
    """Return the valid message with other values."""
    return json.dumps({**GOOD, **keys})



def test_whole_numbers_are_read_and_angles_may_be_missing() -> None:
    sample = parse('{"positions": [[1, 2, 3]], "rotations": [[1, 0, 0, 0]]}', Shape(("hand",), 0, ("hand",), ("hand",)))
    assert isinstance(sample, TrackerSample)
    assert sample.positions.tolist() == [[1.0, 2.0, 3.0]] and sample.angles.shape == (0,)


@given(st.data())
def test_what_is_written_is_read_again(data: st.DataObject) -> None:
    metres = st.floats(-MOST_METRES, MOST_METRES, width=32)
    rng = np.random.default_rng(data.draw(st.integers(0, 1000)))
    rotations = rng.standard_normal((4, 4))
    rotations /= np.linalg.norm(rotations, axis=1)[:, None]
    positions = np.array([data.draw(metres) for _ in range(12)]).reshape(4, 3)
    sample = TrackerSample(0.0, positions, rotations, rng.uniform(-3.0, 3.0, 2))
    text = json_sample(sample)
    for message, close in (
        (text, 1e-15), (b"  " + text.encode(), 1e-15), (packed_sample(sample, 8), 1e-15), (packed_sample(sample, 4), 3e-7),
    ):
        read = parse(message, SHAPE)
        assert isinstance(read, TrackerSample)
        np.testing.assert_array_equal(read.positions, sample.positions)
        np.testing.assert_allclose(read.rotations, sample.rotations, rtol=0.0, atol=close)
        np.testing.assert_allclose(read.angles, sample.angles, rtol=0.0, atol=close)
        np.testing.assert_allclose(np.linalg.norm(read.rotations, axis=1), 1.0, rtol=0.0, atol=1e-15)


def test_goals_are_read_by_short_and_by_whole_names() -> None:
    message = '{"links": {"tip": {"position": [1, 2, 3]}, "right/palm": {"position": [0, 0, 0], "rotation": [0, 1.0004, 0, 0]}}}'
    goals = parse(message, SHAPE)
    assert isinstance(goals, Goals) and list(goals.links) == ["left/tip", "right/palm"]
    assert goals.links["left/tip"].orientation is None and goals.links["left/tip"].position.tolist() == [1.0, 2.0, 3.0]
    turned = goals.links["right/palm"].orientation
    assert turned is not None and turned.tolist() == [0.0, 1.0, 0.0, 0.0]
    empty = parse('{"links": {}}', SHAPE)
    assert isinstance(empty, Goals) and not empty.links


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"{" + b" " * 10000, Refusal.TOO_LONG),
        (b'{"links": \xff}', Refusal.NOT_TEXT),
        (b"", Refusal.WRONG_MAGIC),
        (b"\x00\x01\x02\x03", Refusal.WRONG_MAGIC),
        ("", Refusal.NOT_JSON),
        ('{"links": {}} x', Refusal.NOT_JSON),
        ('{"links": ' + "[" * 700 + "]" * 700 + "}", Refusal.TOO_DEEP),
        ('{"links": {"tip": {"position": [[0]]}}}', Refusal.TOO_DEEP),
        ('{"links": {"[[[[[": {"position": [0,0,0]}}}', Refusal.UNKNOWN_LINK),
        ("[]", Refusal.WRONG_TYPE),
        ('{"links": {}, "links": {}}', Refusal.DUPLICATE),
        ('{"links": {"tip": {"position": [0,0,0]}, "left/tip": {"position": [0,0,0]}}}', Refusal.DUPLICATE),
        (changed(extra=1), Refusal.UNKNOWN_KEY),
        ('{"links": {}, "angles": []}', Refusal.UNKNOWN_KEY),
        ('{"links": {"tip": {"position": [0,0,0], "turn": 1}}}', Refusal.UNKNOWN_KEY),
        ('{"positions": [], "rotations": []}', Refusal.MISSING_KEY),
        ('{"links": {"tip": {}}}', Refusal.MISSING_KEY),
        ('{"links": {"palm": {"position": [0,0,0]}}}', Refusal.UNKNOWN_LINK),
        ('{"links": {"table": {"position": [0,0,0]}}}', Refusal.UNKNOWN_LINK),
        ('{"links": {"\\ud800": {"position": [0,0,0]}}}', Refusal.UNKNOWN_LINK),
        ('{"links": []}', Refusal.WRONG_TYPE),
        ('{"links": {"tip": [0,0,0]}}', Refusal.WRONG_TYPE),
        ('{"links": {"tip": {"position": null}}}', Refusal.WRONG_TYPE),
        (changed(positions={}), Refusal.WRONG_TYPE),
        (changed(positions=[[True, 0, 0]] * 4), Refusal.WRONG_TYPE),
        (changed(angles="ab"), Refusal.WRONG_TYPE),
        (changed(positions=[[0, 0, 0]] * 3), Refusal.WRONG_LENGTH),
        (changed(positions=[[0, 0]] * 4), Refusal.WRONG_LENGTH),
        (changed(angles=[0.0]), Refusal.WRONG_LENGTH),
        (changed(positions=[[math.nan, 0, 0]] * 4), Refusal.NOT_FINITE),
        (changed(angles=[math.inf, 0]), Refusal.NOT_FINITE),
        (changed(positions=[[1e9, 0, 0]] * 4), Refusal.TOO_LARGE),
        (changed(angles=[-1e9, 0.0]), Refusal.TOO_LARGE),
        (json.dumps(GOOD).replace("-0.2", "9" * 1000), Refusal.TOO_LARGE),
        (json.dumps(GOOD).replace("-0.2", "1e999"), Refusal.TOO_LARGE),
        (changed(rotations=[[0, 0, 0, 0]] * 4), Refusal.NOT_A_ROTATION),
        (changed(rotations=[[1 + 2 * UNIT, 0, 0, 0]] * 4), Refusal.NOT_A_ROTATION),
        ('{"links": {"tip": {"position": [0,0,0], "rotation": [2,0,0,0]}}}', Refusal.NOT_A_ROTATION),
        (SAMPLE, Refusal.WRONG_LENGTH),
        (GOOD_PACKED[:-1], Refusal.WRONG_LENGTH),
        (GOOD_PACKED + b"\0", Refusal.WRONG_LENGTH),
        (HEAD.pack(SAMPLE, 2, 4, 4, 2) + GOOD_PACKED[HEAD.size :], Refusal.WRONG_VERSION),
        (HEAD.pack(SAMPLE, 1, 3, 4, 2) + GOOD_PACKED[HEAD.size :], Refusal.WRONG_VERSION),
        (HEAD.pack(SAMPLE, 1, 4, 2**32 - 1, 2**32 - 1) + GOOD_PACKED[HEAD.size :], Refusal.WRONG_LENGTH),
        (GOOD_PACKED[:-4] + struct.pack("<f", math.nan), Refusal.NOT_FINITE),
        (GOOD_PACKED[:-4] + b"\x01\x00\x80\x7f", Refusal.NOT_FINITE),
        (GOOD_PACKED[:-4] + struct.pack("<f", math.inf), Refusal.NOT_FINITE),
        (GOOD_PACKED[:-4] + struct.pack("<f", 1e9), Refusal.TOO_LARGE),
        (GOOD_PACKED[: HEAD.size] + bytes(len(GOOD_PACKED) - HEAD.size), Refusal.NOT_A_ROTATION),
    ],
)
def test_what_is_wrong_is_refused_by_its_reason(data: bytes | str, reason: Refusal) -> None:
    assert refused(data) is reason


def test_the_deepest_message_that_is_read_in_a_large_scene() -> None:
    large = Shape(tuple(f"link {k}" for k in range(500)), 0, (), tuple(f"link {k}" for k in range(500)))
    assert large.most_bytes > 100_000
    assert refused('{"links":' + "[" * 100_000, large) is Refusal.TOO_DEEP
    assert refused('{"links":' + '{"a":' * 20_000, large) is Refusal.TOO_DEEP



VALUES = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5)),
    lambda inner: st.one_of(
        st.lists(inner, max_size=4),
        st.dictionaries(st.sampled_from(["positions", "rotations", "angles", "links", "tip", "position", "rotation"]), inner),
    ),
    max_leaves=20,
)


@st.composite
def damaged(draw: st.DrawFn) -> bytes:
    """Return a valid message, as JSON or packed, with some bytes changed and possibly cut short."""
    found = bytearray(draw(st.sampled_from([json.dumps(GOOD).encode(), GOOD_PACKED])))
    for _ in range(draw(st.integers(1, 4))):
        found[draw(st.integers(0, len(found) - 1))] = draw(st.integers(0, 255))
    return bytes(found[: draw(st.integers(0, len(found)) | st.just(len(found)))])


@settings(max_examples=300)
@given(st.one_of(
    damaged(), VALUES.map(json.dumps), st.binary(max_size=400), st.binary(max_size=200).map(lambda rest: SAMPLE + rest),
    st.text(max_size=300),
))
def test_anything_is_read_or_refused(data: bytes | str) -> None:
    try:
        found = parse(data, SHAPE)
    except Refused:
        return
    if isinstance(found, TrackerSample):
        assert found.positions.shape == (4, 3) and found.angles.shape == (2,)
        assert np.isfinite(found.positions).all() and np.isfinite(found.angles).all()
        np.testing.assert_allclose(np.linalg.norm(found.rotations, axis=1), 1.0, rtol=0.0, atol=1e-12)
