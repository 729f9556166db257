"""A channel between two ends: whole messages in order, and a sender that never waits."""

from collections.abc import Iterator

import numpy as np
import pytest

from avatarsim.live.channel import Channel, pair

Ends = tuple[Channel, Channel]


@pytest.fixture
def ends() -> Iterator[Ends]:
    """Yield both ends of a new channel."""
    both = pair()
    yield both
    for end in both:
        end.close()


def test_messages_arrive_whole_and_in_order(ends: Ends) -> None:
    one, other = ends
    sent = [("text", k, np.arange(100.0 * k)) for k in range(5)]
    assert all(one.send(message) for message in sent)
    for (name, k, numbers), found in zip(sent, other.drain(), strict=True):
        assert (name, k) == found[:2]
        np.testing.assert_array_equal(numbers, found[2])
    assert list(other.drain()) == [] and other.newest() is None
    assert other.send("back") and one.newest() == "back"


def test_the_newest_is_taken_and_the_rest_forgotten(ends: Ends) -> None:
    one, other = ends
    for k in range(4):
        one.send(k)
    assert other.newest() == 3 and other.newest() is None


def test_a_sender_whose_reader_sleeps_drops_and_counts(ends: Ends) -> None:
    one, other = ends
    told = [one.send(np.zeros(2000)) for _ in range(2000)]
    assert told[0] and not told[-1] and one.dropped == told.count(False)
    assert len(list(other.drain())) == told.count(True)
    # later messages arrive again
    assert one.send("again") and other.newest() == "again"


def test_a_sender_whose_reader_is_gone_does_not_fall(ends: Ends) -> None:
    one, other = ends
    other.close()
    assert not one.send("lost") and list(one.drain()) == []
