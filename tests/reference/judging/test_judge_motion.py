"""Distances that motion proves: the bound holds for every pair of moments, and skipped pairs were apart, or not the deepest."""

import numpy as np
import pytest

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, Mass, simulated
from avatarsim.scene.joint import Ball, Free, Joint
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.spatial import rotation
from reference.judging.judge import FREE, Judge
from reference.judging.motion import STRIDES, Moves
from reference.judging.near import Near

HULL = ConvexHull(np.array([[0.3, 0.1, 0.0], [-0.1, 0.2, 0.1], [0.0, -0.2, -0.1], [0.1, 0.0, 0.4], [-0.2, -0.1, 0.2]]))
SHAPES = (Box((0.5, 0.3, 0.2)), Capsule(0.1, 0.5), Ellipsoid((0.3, 0.1, 0.2)), HULL, Sphere(0.2))
PROMISE = 3e-8
"""Metres by which two judged distances may differ from the truth together, and some."""


def loose(k: int) -> Body:
    return simulated(f"loose {k}", (Piece(SHAPES[k], (0.1 * k, -0.05, 0.02)),), "wood", Mass(1.0))


def limb(name: str, parent: str | None, joint: Joint, shape: Shape) -> Link:
    return Link(name, parent, joint, (Piece(shape, (0.05, 0.0, -0.1)),), Mass(1.0))


HAND = Avatar("hand", (limb("palm", None, Free(), SHAPES[0]), limb("finger", "palm", Ball(), SHAPES[1])))
ROOM = Scene("room", tuple(loose(k) for k in range(5)), (HAND,))
COUNT = len(ROOM.names)


def walk(seed: int, states: int, pace: float) -> tuple[np.ndarray, np.ndarray]:
    """A walk of all bodies through each other: positions and orientations, every state `pace` [m, about rad] from the last."""
    random = np.random.default_rng(seed)
    at = 0.5 * random.normal(size=(COUNT, 3)) + np.cumsum(pace * random.normal(size=(states, COUNT, 3)), axis=0)
    turns = [rotation.normalised(random.normal(size=(COUNT, 4)))]
    for _ in range(states - 1):
        turns.append(rotation.multiply(rotation.from_rotation_vector(pace * random.normal(size=(COUNT, 3))), turns[-1]))
    return at, np.array(turns)


@pytest.mark.parametrize("pace", [0.002, 0.05])
def test_no_distance_changes_by_more_than_the_motion(pace: float) -> None:
    judge, (at, turns) = Judge(ROOM), walk(3, 12, pace)
    world = judge.pieces.placed(at, rotation.to_matrix(turns))
    first, second = np.nonzero(np.triu(judge._may_meet, 1))
    state = np.repeat(np.arange(12), len(first))
    near = Near(state, np.tile(first, 12), np.tile(second, 12))
    distances = judge.between.each(*world, near)[0].reshape(12, -1)
    moves, tight = Moves(judge.pieces, *world), 0.0
    for then in range(12):
        most = moves.between(near, np.full(len(state), then)).reshape(12, -1)
        changed = np.abs(distances - distances[then])
        assert (changed <= most + PROMISE).all()
        tight = max(tight, float((changed / np.maximum(most, 1e-3)).max()))
    assert tight > 0.5, "a bound that is never nearly met would prove little"


@pytest.mark.parametrize("pace", [0.0, 1e-4, 0.003, 0.1])
@pytest.mark.parametrize("seed", range(2))
def test_states_over_time_are_judged_as_each_alone(pace: float, seed: int) -> None:
    at, turns = walk(seed, 70, pace)
    at[33, 2] = np.nan
    judge = Judge(ROOM)
    alone, together = judge.each(at, turns), judge.over_time(at, turns)
    assert [(v.deepest, v.pair, v.pairs, v.faults) for v in together if not v.faults] \
        == [(v.deepest, v.pair, v.pairs, v.faults) for v in alone if not v.faults]
    assert [k for k, v in enumerate(together) if v.faults] == [33] and together[33].faults == alone[33].faults
    links = set(ROOM.names[len(ROOM.bodies):])
    linked = [max((deep for a, b, deep in v.pairs if links & {a, b}), default=v.deepest and 0.0) for v in alone]
    found = judge.link_depths(at, turns)
    assert np.isnan(found[33]) and np.array_equal(np.delete(found, 33), np.delete(linked, 33))
    assert np.isnan(judge.deepest(at, turns))
    sound = np.delete(np.arange(70), 33)
    assert judge.deepest(at[sound], turns[sound]) == pytest.approx(max(alone[k].deepest for k in sound), abs=PROMISE)


def test_what_hardly_moves_is_measured_once_in_a_while(monkeypatch: pytest.MonkeyPatch) -> None:
    judge, (at, turns) = Judge(ROOM), walk(4, 64, 1e-7)
    asked, plain = [], judge.between.each

    def counting(places: np.ndarray, turned: np.ndarray, near: Near) -> tuple[np.ndarray, np.ndarray]:
        asked.append(len(near.state))
        return plain(places, turned, near)

    monkeypatch.setattr(judge.between, "each", counting)
    every = judge.each(at, turns)
    everything, deep = sum(asked), sum(len(verdict.pairs) for verdict in every)
    asked.clear()
    judge.over_time(at, turns)
    assert deep <= sum(asked) <= deep + (everything - deep) / STRIDES[0] + COUNT**2
    asked.clear()
    judge.deepest(at, turns)
    assert sum(asked) < 0.3 * everything, "overlaps that are not the deepest need no measuring either"


def test_no_state_and_no_near_pair_ask_nothing() -> None:
    judge, (at, turns) = Judge(ROOM), walk(5, 3, 0.0)
    assert judge.over_time(at[:0], turns[:0]) == [] and judge.deepest(at[:0], turns[:0]) == 0.0
    apart = at + 10.0 * np.arange(COUNT)[:, None]
    assert judge.deepest(apart, turns) == 0.0 and (judge.link_depths(apart, turns) == 0.0).all()
    assert all(verdict == FREE for verdict in judge.over_time(apart, turns))
