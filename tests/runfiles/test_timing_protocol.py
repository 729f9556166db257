"""What a row says about how it was timed, in full and in short."""

import pytest

from runfiles.timing_protocol import Protocol, brief


@pytest.mark.parametrize(("protocol", "said", "short"), [
    (Protocol(3, 240, 30), "3 x 240 frames, 30 warm-up frames", "3 x 240 frames"),
    (Protocol(1, 1, 1), "1 x 1 frame, 1 warm-up frame", "1 x 1 frame"),
])
def test_words(protocol: Protocol, said: str, short: str) -> None:
    assert protocol.said == said and brief(said) == short
    assert brief(f"{said}; moving 3 us, resting 1 us") == f"{short}; moving 3 us, resting 1 us"
