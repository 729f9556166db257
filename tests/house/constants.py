"""Inventory of the engine's tuned constants: python -m tests.house.constants [--all].

Looked at are the rooms that a frame runs through. A number counts as tuned if it was chosen and another would do: constants of
modules, defaults of settings, arguments of presets, and what stands in the middle of a function and is neither whole nor a
multiple of a quarter, as the coefficients of formulas are. It does not count if it is

- derived: computed from constants that are counted, or another's own name again;
- structure: a code, a place in a row, a mark, a fact of mathematics or physics, the range of what may be given;
- capacity: room in memory, of which there is so much that none runs out, or a status says so.

The last two are listed by name below, so what is new counts until it is listed. Budgets of work, caps of iterations and what
stands for rounding count as tuned, although most of them change nothing within a factor of ten.
"""

import argparse
import ast
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

ENGINE = Path(__file__).resolve().parents[2] / "avatarsim"

ROOMS = (
    "batch.py", "collision", "coupling", "frame.py", "ik", "lower_loop.py", "many_worlds.py", "model", "paper", "planner",
    "pose_queries.py", "rehearsal.py", "rigid", "settings.py", "simulator.py", "spatial", "tolerances.py",
)
"""What a frame runs through. Left out: what makes and checks scenes, files, compiled kernels and messages."""

TUNED, DERIVED, STRUCTURE, CAPACITY = KINDS = ("tuned", "derived", "structure", "capacity")

LISTED = {
    STRUCTURE: {
        "collision/broad_phase.py": "SECOND_HALF",
        "collision/conservative_advancement.py": "UNKNOWN",
        "collision/ellipsoid_distance.py": "FEATURE",
        "collision/epa.py": "outward_try()",
        "collision/gjk.py": "NOWHERE WHOLE",
        "collision/grid.py": "LOWEST LEVELS NOWHERE ROOM AXIS_BITS SPREAD POSITIVE ALL FARTHEST",
        "collision/manifold.py": "NO_FACE FACE_OF_A FACE_OF_B",
        "collision/path.py": "STILL FREE HELD",
        "collision/primitives.py": "BOX_CORNERS NONE TWO_POINTS TWO_SEGMENTS POINT_AND_BOX BOX_AND_POINT UNKNOWN",
        "collision/status.py": "CONVERGED OUT_OF_ITERATIONS DEGENERATE NOT_FINITE CANCELLING OUT_OF_ROOM",
        "collision/warm_start.py": "EDGES",
        "ik/chord.py": "SAGITTA",
        "ik/state.py": "EMPTY",
        "lower_loop.py": "MOST NOTHING_RECEIVED NOT_KNOWN",
        "model/geometry.py": "POINTS ELLIPSOID OPEN CORNERS",
        "model/joint_limits.py": "UNLIMITED_COSINE",
        "model/skeleton.py": "RIGID HINGES BALL FREE UNLIMITED",
        "paper/ccd_ik.py": "REACHED OUT_OF_SWEEPS STUCK SINGULAR NO_GOAL NO_JOINT ANY_DIRECTION",
        "paper/push_apart.py": "NOT_CHECKED NOTHING_KNOWN OBSTACLE ASKED DOUBTED STAY",
        "paper/walk_back.py": "CHAINS_HIT AVATARS_HIT EVERYTHING",
        "planner/goal_test.py": "JOINTS DIRECTIONS",
        "planner/state.py": "NONE GOAL_NODE",
        "planner/supervisor.py": "NEVER JOINTED",
        "pose_queries.py": "FARTHEST",
        "rigid/contact_generation.py": "FOUND NO_ROOM BROKEN",
        "rigid/crowd_step.py": "CROWDED UNPROVED",
        "rigid/contact_law.py": "NO_SLIP",
        "rigid/contacts.py": "ROW MOTION EARTH NOT_DRIVEN DRIVEN_A DRIVEN_B SHARP ROUND_A ROUND_B NORMAL_OF_ANOTHER TWO_BALLS "
        "SPREAD SHIFT",
        "rigid/deferred_impacts.py": "MOST_ELASTIC",
        "rigid/impacts.py": "NOTHING NONE",
        "rigid/internal_edges.py": "NOTHING NO_FACE",
        "rigid/resting.py": "DETERMINED ONCE",
        "rigid/rolling.py": "CORNER EDGE FACE",
        "rigid/solver.py": "LANES RESPONSE RESPONSE_PARTS JACOBIAN_SIZE",
        "rigid/state.py": "APPROACH IMPACT AGAIN",
        "rigid/substep_state.py": "UNKNOWN KNOWN FIXED_GROUP",
        "rigid/swept_certificate.py": "SAGITTA NOWHERE",
        "rigid/step.py": "MOST",
        "settings.py": "around couple",
        "simulator.py": "MOST NOWHERE CHOICES LEAST",
        "spatial/random.py": "MULTIPLIER MODULUS WARM_UP",
        "spatial/rotation.py": "IDENTITY",
    },
    CAPACITY: {
        "collision/grid.py": "LOOKED",
        "collision/manifold.py": "FEATURE_ROOM",
        "collision/scratch.py": "POINTS_CAP PIECES_CAP",
        "collision/warm_start.py": "POINTS_KEPT",
        "ik/chord.py": "ROOM_MOST ROOM_DEEPER",
        "ik/state.py": "SLOTS_PER_PIECE PROBES ROWS_PER_AVATAR ROWS_MOST TOUCHING_PER_AVATAR",
        "lower_loop.py": "STEPS_KEPT",
        "many_worlds.py": "MOST_THREADS",
        "paper/push_apart.py": "PAIRS_PER_LINK CANDIDATES_MORE",
        "rigid/contacts.py": "ROOM ROOM_PER_BODY SLOTS_PER_POINT TRIES",
        "rigid/state.py": "PAIRS_ROOM PAIRS_PER_BODY CANDIDATES_MORE",
        "rigid/substep_state.py": "PIECES_ROOM PIECES_PER_PAIR",
        "rigid/step.py": "EVENTS_KEPT",
    },
}
"""Constants that are not tuned, by kind and file."""


class Found(NamedTuple):
    """A number: kind, file within the engine, name (of a number within a function, that of the function), line, source text."""

    kind: str
    path: str
    name: str
    line: int
    text: str


def inventory() -> list[Found]:
    """All numbers, by file and line."""
    found = []
    for room in ROOMS:
        for file in sorted((ENGINE / room).rglob("*.py")) if (ENGINE / room).is_dir() else [ENGINE / room]:
            path = file.relative_to(ENGINE).as_posix()
            listed = {name: kind for kind, files in LISTED.items() for name in files.get(path, "").split()}
            for name, kind, value in numbers_of(ast.parse(file.read_text(encoding="utf-8")), listed):
                found.append(Found(kind, path, name, value.lineno, ast.unparse(value)))
    return found


def numbers_of(tree: ast.Module, listed: Mapping[str, str]) -> Iterator[tuple[str, str, ast.expr]]:
    """(name, kind, value) of the numbers of a file, of which those that are not tuned are `listed` with their kind."""
    for name, value in _numbers(tree):
        yield name, listed.get(name) or (DERIVED if _is_derived(value) else TUNED), value


def unknown() -> list[str]:
    """What is listed above and is not there."""
    there = {(one.path, one.name) for one in inventory()}
    return [
        f"{path}: {name}" for files in LISTED.values() for path, names in files.items() for name in names.split()
        if (path, name) not in there
    ]


def _numbers(tree: ast.Module) -> Iterator[tuple[str, ast.expr]]:
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            for field in node.body:
                if isinstance(field, ast.AnnAssign) and field.value is not None:
                    yield from _named(field.target, field.value, is_field=True)
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            yield from _named(node.target, node.value)
        elif isinstance(node, ast.Assign):
            yield from _named(node.targets[0], node.value)
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    for function in functions:
        for node in ast.walk(function):
            if isinstance(node, ast.Constant) and isinstance(node.value, float) and _is_chosen(node.value):
                yield f"{function.name}()", node


def _named(target: ast.expr, value: ast.expr, is_field: bool = False) -> Iterator[tuple[str, ast.expr]]:
    """The numbers of an assignment: of two tuples pair by pair, of a preset argument by argument."""
    if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        for one, its in zip(target.elts, value.elts, strict=True):
            yield from _named(one, its)
    elif isinstance(target, ast.Name) and (is_field or target.id.isupper()):
        if isinstance(value, ast.Call) and value.keywords and not value.args:
            yield from ((f"{target.id}.{one.arg}", one.value) for one in value.keywords if _holds_number(one.value))
        elif _holds_number(value) or (_is_derived(value) and isinstance(value, ast.Name | ast.UnaryOp)):
            yield target.id, value


def _holds_number(value: ast.expr) -> bool:
    return any(
        isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool)
        for node in ast.walk(value)
    )


def _is_derived(value: ast.expr) -> bool:
    """Whether another constant is in it."""
    return any(isinstance(node, ast.Name) and node.id.isupper() for node in ast.walk(value))


def _is_chosen(value: float) -> bool:
    """Whether a number in a function is no coefficient of a formula: neither whole nor a multiple of a quarter, nor next to 0."""
    return not (4.0 * value).is_integer() and abs(value) > 1e-200


def main(arguments: Sequence[str] | None = None) -> int:
    """The list on the screen."""
    parser = argparse.ArgumentParser(prog="python -m tests.house.constants", description=(__doc__ or "").partition("\n\n")[0])
    parser.add_argument("--all", action="store_true", help="those that are not tuned as well")
    asked = parser.parse_args(arguments)
    found = inventory()
    for one in found:
        if asked.all or one.kind == TUNED:
            print(f"{one.kind + ' ' if asked.all else ''}avatarsim/{one.path}:{one.line} {one.name} = {one.text}")
    count = Counter(one.kind for one in found)
    print(", ".join(f"{count[kind]} {kind}" for kind in KINDS))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
