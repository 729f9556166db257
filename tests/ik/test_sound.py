"""Which states name places that are not there."""

from collections.abc import Callable

import pytest

from avatarsim.ik.state import IkState, state_is_sound
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import rest
from tests.ik.solvers import Solver, solver_of
from tests.worlds.little_worlds import at, hand, panel

PAIR = (hand(), hand(name="other"))


@pytest.fixture(name="found")
def _found() -> Solver:
    """Two hands before a panel: piece 0 is the panel, pieces 1 and 2 the hands."""
    return solver_of(Scene("s", (panel(),), PAIR, start=at(rest(PAIR), (-0.5, 0.0, 0.0))))


def contact(state: IkState, a: int, b: int, count: int = 1) -> None:
    """A contact."""
    state.contacts.used[0], state.contacts.pair[0] = count, (a, b)


def touching(state: IkState, a: int, b: int, count: int = 1) -> None:
    """A pair that was in contact lately."""
    state.touching.used[0], state.touching.pair[0] = count, (a, b)


def near(state: IkState, body: int, count: int = 1) -> None:
    """A body near the first hand."""
    state.near_count[0], state.near[0, 0] = count, body


def islands(state: IkState, *numbers: int) -> None:
    """Numbers of the islands."""
    state.tracking.island[:] = numbers


GOOD: dict[str, Callable[[IkState], None]] = {
    "fresh": lambda state: None, "a contact": lambda state: contact(state, 1, 0),
    "two hands": lambda state: touching(state, 1, 2),
    "the panel is near": lambda state: near(state, 0), "one island": lambda state: islands(state, 0, 0),
}
BAD: dict[str, Callable[[IkState], None]] = {
    "the panel is no link": lambda state: contact(state, 0, 1), "no such piece": lambda state: contact(state, 1, 3),
    "nor before the first": lambda state: touching(state, 1, -1),
    "more contacts than fit": lambda state: contact(state, 1, 0, 10**6),
    "fewer than none": lambda state: touching(state, 1, 0, -1), "a hand is no body near": lambda state: near(state, 1),
    "more bodies than there are": lambda state: near(state, 0, 2),
    "an island that comes later": lambda state: islands(state, 1, 1),
    "an island before the first": lambda state: islands(state, 0, -1),
}


@pytest.mark.parametrize("name", [*GOOD, *BAD])
def test_a_state_names_only_what_is_there(found: Solver, name: str) -> None:
    (GOOD | BAD)[name](found.state)
    assert state_is_sound(found.world.geometry, found.world.skeleton, found.avatars, found.state) == (name in GOOD)
