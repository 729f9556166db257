"""Words and numbers of the page: overlaps, the avatar's action, counts of refusals that quote no message."""

import re
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("viser")

from avatarsim.live.messages import State
from avatarsim.live.ports.refusals import Peer, Refusal, Refusals
from avatarsim.live.stages import stage
from avatarsim.live.view.depth import OwnOverlap
from avatarsim.live.view.page_text import at_ports, numbers, word_of


def test_a_user_inside_something_has_a_pair() -> None:
    found = stage("hand").scene
    start, own = found.first_sample, OwnOverlap(found)
    _, pair = own.deepest(replace(start, positions=start.positions + (0.0, 0.0, 0.75 - start.positions[0, 2])))
    assert own.deepest(start) == (0.0, None) and pair is not None and pair[0] == "table" and pair[1].startswith("hand/")


def test_refusals_are_counted_and_the_most_frequent_are_named() -> None:
    refusals = Refusals()
    for times, reason in enumerate(list(Refusal)[:6], start=1):
        for _ in range(times):
            refusals.count(reason, Peer.UDP)
    assert sum(reason.value in at_ports(refusals) for reason in Refusal) == 4 and len(refusals.counts) == 6


def test_numbers_are_of_user_and_engines_and_names_no_markup() -> None:
    shown = numbers(0.0321, 0.05, {"avatarsim": 0.0, "<b>": 2e-3}, {"avatarsim": (0, 0, 255), "<b>": (0, 255, 0)})
    assert [float(found) for found in re.findall(r'data-overlap="([^"]*)"', shown)] == [32.1, 0.0, 2.0]
    assert "32 mm" in shown and "<b>" not in shown


def states(speed: float, statuses: dict[str, int] | None = None, impacts: int = 0) -> list[State]:
    """Return two states in which body 0 and the root, 1, move at a speed [m/s]."""
    def one(frame: int) -> State:
        positions = np.full((2, 3), speed * frame / 60.0) / np.sqrt(3.0)
        return State(frame, frame / 60.0, positions, np.tile((1.0, 0.0, 0.0, 0.0), (2, 1)), np.zeros(0), 0, -1, 0, False, 0, 0,
                     statuses or {}, {"impacts": impacts}, {}, "")

    return [one(0), one(1)]


@pytest.mark.parametrize(("found", "touches", "word"), [
    (states(0.0), True, False), (states(0.1), True, True), (states(0.1), False, False), (states(1.0, impacts=2), False, True),
    (states(0.0, {"waiting": 1}), True, True), (states(0.0, impacts=2), True, False),
])
def test_sliding_waiting_and_bouncing_have_a_word(found: list[State], touches: bool, word: bool) -> None:
    assert bool(word_of(found, 0.05, touches, 1, [0])) is word
