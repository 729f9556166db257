"""What a row says about how it was timed, in full and in short."""

import pytest

from runfiles.timing_protocol import Protocol, brief, least_of, repeats_of


@pytest.mark.parametrize(
    ("protocol", "said", "short"),
    [
        (Protocol(3, 240, 30), "3 x 240 frames, 30 warm-up frames", "3 x 240 frames"),
        (Protocol(1, 1, 1), "1 x 1 frame, 1 warm-up frame", "1 x 1 frame"),
    ],
)
def test_words(protocol: Protocol, said: str, short: str) -> None:
    assert protocol.said == said and brief(said) == short and repeats_of(said) == protocol.repeats
    assert brief(f"{said}; moving 3 us, resting 1 us") == f"{short}; moving 3 us, resting 1 us"


def test_a_figure_of_one_frame_says_of_how_many_repeats_it_is_the_least() -> None:
    assert [least_of(number) for number in (0, 1, 3)] == ["", "each frame run once", "each frame the least of 3 repeats"]
    assert repeats_of("") == 0 == repeats_of("fewer than 3 x 200")
