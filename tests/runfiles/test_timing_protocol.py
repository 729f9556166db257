"""Words of a row about how it was timed."""

import pytest

from runfiles.timing_protocol import Protocol


@pytest.mark.parametrize(
    ("protocol", "said"),
    [(Protocol(3, 240, 30), "3 x 240 frames, 30 warm-up frames"), (Protocol(1, 1, 1), "1 x 1 frame, 1 warm-up frame")],
)
def test_words(protocol: Protocol, said: str) -> None:
    assert protocol.said == said
