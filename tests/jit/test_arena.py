"""Packed tuples share one memory, keep order and aliases, and kernels find them again; frames come out bit for bit the same."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest
from numba.core.registry import cpu_target

from avatarsim.collision.scratch import Scratch, make_scratch
from avatarsim.coupling.tracked_motion import make_tracked_motion
from avatarsim.errors import AvatarsimError
from avatarsim.ik.make import make_solver
from avatarsim.jit.arena import Image, pack, view_arena
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import FlagLine, Grid, Line, Matrices, Stack, numba_type
from avatarsim.jit.record import known_as_table
from avatarsim.model.geometry import SHAPE
from avatarsim.model.world import World, build
from avatarsim.paper.state import make_paper_memory
from avatarsim.planner.state import make_planner
from avatarsim.rigid.state import DONE, Switches, make_events
from avatarsim.rigid.state import make_memory as make_upper_memory
from avatarsim.rigid.step import SimulatedLoop, advance_opened
from avatarsim.scene.body import simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.settings import AttractionSettings, CouplingSettings, PaperSettings, PostureSettings
from tests.worlds.little_worlds import mixed_avatar, panel

ROOT = Path(__file__).parents[2]
CRATE = (Piece(Box((0.1, 0.2, 0.3))),)
SCENE = Scene(
    "s", (panel(x=9.0), simulated("crate", CRATE, "wood", solid(CRATE, 1.0), (5.0, 0.0, 0.0))), (mixed_avatar(),)
)


def leaves(tree: object) -> list:
    """Return all arrays and numbers of nested tuples, in order."""
    return [leaf for branch in tree for leaf in leaves(branch)] if isinstance(tree, tuple) else [tree]


def same_memory(a: object, b: object) -> bool:
    """Return whether two arrays or records are one, or two numbers are equal and of one kind."""
    if isinstance(a, np.void):
        return isinstance(b, type(a)) and same_memory(np.asarray(a), np.asarray(b))
    if not isinstance(a, np.ndarray):
        return bool(a == b) and isinstance(b, (bool, np.bool_)) == isinstance(a, bool)
    assert isinstance(b, np.ndarray)
    at = a.__array_interface__["data"][0] == b.__array_interface__["data"][0]
    return (at or a.size == 0) and a.shape == b.shape and a.dtype == b.dtype and a.strides == b.strides


def parts(world: World, cap: int = 3) -> dict[str, tuple]:
    """Return the parts that the engine packs."""
    geo, skel, dyn, posture, poses = world.geometry, world.skeleton, world.dynamics, world.posture, world.poses
    avatars, state, working = make_solver(geo, skel, posture, poses, cap)
    plan, planning_avatar = make_planner(geo, skel, avatars, state, posture, poses, np.zeros(3), 1)
    return {
        "geometry": geo, "dynamics": dyn, "poses": poses, "velocities": world.velocities, "skeleton": skel,
        "posture": posture, "avatars": avatars, "state": state, "working": working, "plan": plan, "ghost": planning_avatar,
        "settings": PostureSettings(steps=7, near=0.5),
        "motion": make_tracked_motion(skel, dyn.drive, posture, poses, CouplingSettings(3.0, 4.0)),
        "upper memory": make_upper_memory(geo, dyn, poses),
        "events": make_events(len(geo.first_shape) - 1, cap), "switches": Switches(False, True, False, True, False),
        "paper memory": make_paper_memory(world, 1), "paper settings": PaperSettings(rounds=3),
        "coupling": CouplingSettings(5.0, 6.0), "attraction": AttractionSettings(7.0),
    }


def test_a_packed_tuple_is_the_same_tuple_in_one_memory() -> None:
    for name, part in parts(build(SCENE)).items():
        words, views = pack(part)
        assert type(views) is type(part), name
        for mine, theirs in zip(leaves(part), leaves(views), strict=True):
            if isinstance(mine, np.ndarray):
                assert np.array_equal(mine, theirs) and theirs.dtype == mine.dtype and theirs.flags.carray
                assert np.shares_memory(words, theirs) or not mine.size
                assert not np.shares_memory(mine, theirs)
            elif isinstance(mine, np.void):
                assert mine == theirs and type(mine) is type(theirs)
                assert np.shares_memory(words, theirs) and not np.shares_memory(mine, theirs)
            else:
                assert mine is theirs


def test_no_two_arrays_overlap_unless_they_were_one() -> None:
    one, other = np.arange(5.0), np.arange(5.0)
    _, (a, b, c, d) = pack((one, other, one, np.ones(3, dtype=bool)))
    c[:] = 7.0
    assert (a == 7.0).all() and (b == other).all() and d.all()
    d[:] = False
    assert (a == 7.0).all() and (b == other).all()


def test_aliases_of_the_upper_loop_live_on() -> None:
    world = build(SCENE)
    memory = make_upper_memory(world.geometry, world.dynamics, world.poses)
    assert memory.impact_masses.inverse_inertia is memory.masses.inverse_inertia
    views = pack((memory,))[1][0]
    assert same_memory(views.impact_masses.inverse_inertia, views.masses.inverse_inertia)
    assert same_memory(views.round, views.paths.round)


@pytest.mark.parametrize(
    "bad",
    [
        np.zeros(3, dtype=np.float32), np.zeros((1, 1, 1, 1, 1)), np.zeros(()), np.zeros(2, dtype=np.int32),
        np.zeros((2, 2), dtype=SHAPE),
    ],
)
def test_what_no_kernel_could_open_is_refused(bad: np.ndarray) -> None:
    with pytest.raises(AvatarsimError):
        pack((bad,))
    with pytest.raises(AvatarsimError, match="str"):
        numba_type(str)


PAIR = np.dtype([("axis", np.float64, (3,)), ("twin", np.uint16, (8, 4))])


class PairMemory(np.recarray[Any, np.dtype[Any]]):
    """A table, one record per pair."""

    axis: np.ndarray
    twin: np.ndarray


known_as_table(PairMemory, PAIR)


class Found(NamedTuple):
    """The tuple that the test below packs."""

    one: Scratch
    table: PairMemory
    other: Scratch


def test_opens_records_and_tables_as_packed_in_kernels_too() -> None:
    scratch, memory = make_scratch(), np.zeros(3, PAIR).view(PairMemory)
    scratch.w[5], memory.axis[2], memory.twin[1, 4, :3] = (1.0, 2.0, 3.0), (4.0, 5.0, 6.0), (7, 8, 9)
    words, (one, table, other) = pack(Found(scratch, memory, scratch))
    assert one == scratch and (table == memory).all() and type(table) is type(memory)
    other.rows[0, 1] = 3
    assert one.rows[0, 1] == 3 and scratch.rows[0, 1] == 0
    assert sum_of_some(words) == 1 + 2 + 3 + 4 + 5 + 6 + 7 + 8 + 9
    assert (one.w[5] == 10.0).all() and (table.axis[2] == 10.0).all()


@kernel
def sum_of_some(words: np.ndarray) -> float:
    """Return the numbers that the test above put into a scratch and a memory; all become 10."""
    scratch, memory = view_arena(words, Found).one, view_arena(words, Found).table
    total = 0.0
    for k in range(3):
        total += scratch.w[5, k] + memory.axis[2, k] + memory[1].twin[4, k]
        scratch.w[5, k] = memory.axis[2, k] = 10.0
    return total


def test_kernels_know_what_was_packed_by_its_annotations() -> None:
    """As numba types the views themselves, and as LLVM lays out a value of that type."""
    target = cpu_target.target_context
    for name, part in parts(build(SCENE)).items():
        kind = numba_type(type(part))
        assert kind == numba.typeof(pack(part)[1]), name
        image = Image()
        image.lay(part, {id(leaf): 0 for leaf in leaves(part)})
        assert len(image.data) == target.get_abi_sizeof(target.get_value_type(kind)), name


class Two(NamedTuple):
    """Something to be packed in something."""

    flag: bool
    grid: Grid


class Mixed(NamedTuple):
    """One of every kind that differs in memory."""

    flag: bool
    two: Two
    switches: Switches
    whole: int
    turns: Matrices
    flags: FlagLine
    scratch: Scratch
    real: float


class Framed(NamedTuple):
    """A Mixed between two numbers."""

    first: int
    mixed: Mixed
    last: float


@kernel
def digits(words: np.ndarray) -> tuple[float, float]:
    """Return every part of a Mixed between two numbers, as digits of one number; the Mixed is left with its last turn doubled."""
    framed = view_arena(words, Framed)
    first, m, last = framed.first, framed.mixed, framed.last
    s = m.switches
    found = 1.0 * m.flag + 2.0 * m.two.flag + 4.0 * s.gyroscopic + 8.0 * s.continuous + 16.0 * s.sleeping + 32.0 * s.paper
    found += 64.0 * s.record
    for flag in m.flags:
        found = 2.0 * found + flag
    total = m.two.grid.sum() + m.two.grid[1, 2] + m.turns[1, 2, 0] + m.scratch.w[3, 1] + m.whole + m.real + first + last
    m.turns[1, 2, 0] *= 2.0
    return found, total + m.two.grid.shape[0] + m.turns.shape[0] + m.turns.strides[0] + m.flags.size


def test_a_kernel_reads_parts_where_they_lie_also_once_moved() -> None:
    scratch = make_scratch()
    scratch.w[3, 1] = 0.25
    grid, turns = np.arange(8.0).reshape(2, 4), np.arange(27.0).reshape(3, 3, 3)
    flags = np.array([True, False, True])
    mixed = Mixed(True, Two(False, grid), Switches(False, True, False, True, True), 1000, turns, flags, scratch, 0.5)
    words, (_, views, _) = pack(Framed(10000, mixed, 0.125))
    expected = (1.0 + 8.0 + 32.0 + 64.0) * 8.0 + 5.0, 28.0 + 6.0 + 15.0 + 0.25 + 1000.0 + 0.5 + 10000.0 + 0.125 + 2 + 3 + 72 + 3
    assert digits(words) == expected and views.turns[1, 2, 0] == 30.0
    moved = words.copy()
    words[:] = 0
    assert digits(moved) == (expected[0], expected[1] + 15.0)


def test_an_array_that_is_not_in_c_order_is_laid_out_in_c_order() -> None:
    turned = np.arange(6.0).reshape(2, 3).T
    view = pack((turned,))[1][0]
    assert (view == turned).all() and view.flags.c_contiguous


class Rest(NamedTuple):
    """A last part that no part of the engine has."""

    real: float
    yes: bool
    no: bool
    stack: Stack
    line: Line


def test_swapped_arenas_raise() -> None:
    """A world viewed as the working memory of a step, and the other way round: both raise."""
    world = build(SCENE)
    upper = SimulatedLoop(world, paper=False, record=False)
    for wrong in ((upper.words, upper.words), (world.words, world.words), (upper.words, world.words)):
        with pytest.raises(ValueError, match="layout"):
            advance_opened(*wrong, 1.0 / 60.0)
    assert advance_opened(world.words, upper.words, 1.0 / 60.0) == DONE


def open_everything() -> None:
    """Run every opening in plain Python, where the views can be inspected: a compiled kernel may not return them."""
    world = build(SCENE)
    rest = Rest(2.5, True, False, np.zeros((2, 3, 4, 5)), np.arange(3.0))
    for cap in (0, 3):
        for name, part in {**parts(world, cap), "rest": rest}.items():
            words, views = pack(part)
            found = view_arena(words, type(part))
            assert type(found) is type(part) and len(leaves(found)) == len(leaves(part)), name
            assert all(map(same_memory, leaves(views), leaves(found))), name


def test_what_is_opened_is_what_was_packed_field_by_field() -> None:
    """In a process with kernels in plain Python, where swapped arenas raise too."""
    code = "from tests.jit import test_arena; test_arena.open_everything(); test_arena.test_swapped_arenas_raise()"
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
