"""Which memories of the posture solver name places that are not there."""

from collections.abc import Callable

import pytest

from avatarsim.posture.sound import memory_is_sound, way_is_sound
from avatarsim.posture.way_memory import (
    AT,
    BLOCKED,
    BLOCKING,
    LAST,
    LEAVES_USED,
    MODE,
    NODE,
    NODES,
    NODES_USED,
    PHASE,
    SEARCHING,
    WALKED,
    Way,
    make_way,
)
from avatarsim.posture.way_search import AWAY_STEPS, HOME_STEPS, TO_NODE, TO_TRACKER, TO_WAYPOINT
from avatarsim.posture.workspace import COUNT, FAILED, FAILED_CAP, LISTED, LISTED_CAP, NEARBY, ROW_CAP, Memory
from tests.posture.little_worlds import Little, hand_scene, little, panel


@pytest.fixture(name="world")
def _world() -> Little:
    """A hand before a panel: piece 0 is the panel, piece 1 the hand."""
    return little(hand_scene((-0.5, 0.0, 0.0), panel()))


def listed(memory: Memory, a: int, b: int) -> None:
    """One pair listed."""
    memory.pairs.marks[LISTED], memory.pairs.listed[0] = 1, (a, b)


def row(memory: Memory, a: int, b: int) -> None:
    """One row."""
    memory.rows.size[COUNT], memory.rows.pair[0] = 1, (a, b)


def near(memory: Memory, body: int) -> None:
    """One body near."""
    memory.pairs.marks[NEARBY], memory.pairs.near[0] = 1, body


def mark(memory: Memory, place: int, value: int) -> None:
    """A count."""
    memory.pairs.marks[place] = value


GOOD: dict[str, Callable[[Memory], None]] = {
    "fresh": lambda memory: None, "a pair": lambda memory: listed(memory, 1, 0),
    "a row of pieces": lambda memory: row(memory, 1, 0),
    "a row of a limit": lambda memory: row(memory, -3, 5), "the panel is near": lambda memory: near(memory, 0),
}
BAD: dict[str, Callable[[Memory], None]] = {
    "no driven piece": lambda memory: listed(memory, 0, 1), "no such piece": lambda memory: listed(memory, 1, 2),
    "a piece below all": lambda memory: listed(memory, 1, -1), "many listed": lambda memory: mark(memory, LISTED, LISTED_CAP + 1),
    "many failed": lambda memory: mark(memory, FAILED, FAILED_CAP + 1),
    "fewer than none": lambda memory: mark(memory, NEARBY, -1),
    "the hand is near itself": lambda memory: near(memory, 1), "a row of no pieces": lambda memory: row(memory, 2, 0),
    "a row of no degree": lambda memory: row(memory, -1, 6), "many rows": lambda memory: memory.rows.size.fill(ROW_CAP + 1),
}


@pytest.mark.parametrize("what", list(GOOD))
def test_a_memory_that_names_what_is_there_is_sound(world: Little, what: str) -> None:
    GOOD[what](world.memory)
    assert memory_is_sound(world.world.geometry, world.world.skeleton, world.memory)


@pytest.mark.parametrize("what", list(BAD))
def test_a_memory_that_names_what_is_not_there_is_not(world: Little, what: str) -> None:
    BAD[what](world.memory)
    assert not memory_is_sound(world.world.geometry, world.world.skeleton, world.memory)


def searching(way: Way) -> None:
    """A walk is under way, at the third node of a chain."""
    way.before[:3] = -1, 0, 1
    way.state[[MODE, NODES_USED, NODE, PHASE, WALKED]] = SEARCHING, 3, 2, TO_WAYPOINT, 2


def put(**values: int) -> Callable[[Way], None]:
    """Set places of the state by name."""
    places = {
        "mode": MODE, "used": NODES_USED, "leaves": LEAVES_USED, "node": NODE, "phase": PHASE, "walked": WALKED, "at": AT,
        "last": LAST, "blocking": BLOCKING, "blocked": BLOCKED,
    }

    def change(way: Way) -> None:
        for name, value in values.items():
            way.state[places[name]] = value

    return change


FULL = NODES - HOME_STEPS + 5
WAYS: dict[str, tuple[Callable[[Way], None], bool]] = {
    "a walk": (put(), True), "no walk": (put(node=-1, walked=10**6), True), "led": (put(mode=2, at=1, last=2), True),
    "what blocks": (put(blocking=1, blocked=0), True),
    "full, and a walk at its end": (put(used=FULL, phase=TO_TRACKER, walked=5), True),
    "full, and a walk before its end": (put(used=FULL, phase=TO_TRACKER, walked=4), False),
    "no room for the way home": (put(used=NODES - AWAY_STEPS - HOME_STEPS + 3), False),
    "used too many": (put(used=NODES + 1), False),
    "a node that is none": (put(node=3), False), "a walk too long": (put(walked=AWAY_STEPS), False),
    "a short cut of nothing": (put(phase=TO_NODE), False), "past the end of the path": (put(at=3, last=2), False),
    "a path too long": (put(last=NODES), False), "leaves too many": (put(leaves=65), False),
    "the panel blocks itself with nothing": (put(blocking=0, blocked=1), False),
    "nothing blocks": (put(blocking=2, blocked=2), False),
    "a ring": (lambda way: way.before.__setitem__(0, 2), False),
}


@pytest.mark.parametrize("what", list(WAYS))
def test_the_tree_of_a_search_is_one_and_has_room(world: Little, what: str) -> None:
    geo, skel, posture, poses = world.parts
    way = make_way(geo, skel, posture, poses, world.memory, 0)
    assert way_is_sound(geo, skel, way)
    searching(way)
    way.before[3:] = 0
    change, sound = WAYS[what]
    change(way)
    assert way_is_sound(geo, skel, way) is sound
