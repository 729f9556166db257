"""States that name places that are not there."""


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


def named(state: IkState, what: str, count: int, *places: int) -> None:
    """Let a part of the state name places: so many contacts or touching pairs of one pair, near bodies, or islands."""
    if what == "island":
        state.tracking.island[:] = places
    elif what == "near":
        state.near_count[0], state.near[0, 0] = count, places[0]
    else:
        pairs = getattr(state, what)
        pairs.used[0], pairs.pair[0] = count, places


@pytest.mark.parametrize(("what", "count", "places", "is_sound"), [
    ("contacts", 0, (0, 0), True), ("contacts", 1, (1, 0), True), ("touching", 1, (1, 2), True), ("near", 1, (0,), True),
    ("island", 2, (0, 0), True),
    # the panel is no link, there is no such piece, and more or fewer than fit
    ("contacts", 1, (0, 1), False), ("contacts", 1, (1, 3), False), ("touching", 1, (1, -1), False),
    ("contacts", 10**6, (1, 0), False), ("touching", -1, (1, 0), False),
    # a hand is no body near, and there is one body alone
    ("near", 1, (1,), False), ("near", 2, (0,), False),
    # islands are numbered by their first avatar
    ("island", 2, (1, 1), False), ("island", 2, (0, -1), False),
])
def test_a_state_names_only_what_is_there(found: Solver, what: str, count: int, places: tuple[int, ...], is_sound: bool) -> None:
    named(found.state, what, count, *places)
    assert state_is_sound(found.world.geometry, found.world.skeleton, found.avatars, found.state) == is_sound
