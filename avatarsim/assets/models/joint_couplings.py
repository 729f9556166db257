"""Joints that a file couples, as `Coupling`s: q_b = c_0 + c_1 q_a, each joint counted from its reference.

MuJoCo's equality of joints is a polynomial of degree four; an avatar has straight lines only, which all of URDF's `mimic` are.
Joints that are coupled in a row or a ring follow the first of them; one that follows nothing, or a fixed joint, does not
move."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from avatarsim.assets.models.compiled import Compiled, EqualityKind
from avatarsim.errors import InvalidFile

AGREE = 1e-9
"""[rad, m] by which couplings in a ring may differ from one another: digits of a file."""


@dataclass(frozen=True)
class Line:
    """A joint's angle [rad] or distance [m] from the reference: `ratio` times that of `leader`, -1 for none, plus `offset`."""

    leader: int
    ratio: float
    offset: float


@dataclass(frozen=True)
class _Equality:
    name: str
    follower: int
    leader: int
    offset: float
    ratio: float


def curved(model: Compiled, joints: Sequence[int]) -> dict[int, str]:
    """Return the joints that an equality couples by more than a straight line, with the coefficients from the square on."""
    found = {}
    for k in _of_joints(model, joints):
        if int(model.eq_obj2id[k]) >= 0 and np.any(model.eq_data[k, 2:5] != 0.0):
            c2, c3, c4 = model.eq_data[k, 2:5].tolist()
            found[int(model.eq_obj1id[k])] = f"c2={c2:g} c3={c3:g} c4={c4:g}"
    return found


def _of_joints(model: Compiled, joints: Sequence[int]) -> list[int]:
    """Return the active equalities whose follower is one of some joints."""
    active = (model.eq_type == EqualityKind.JOINT) & (model.eq_active0 != 0)
    return [int(k) for k in np.flatnonzero(active) if int(model.eq_obj1id[k]) in joints]


def lines(model: Compiled, joints: Sequence[int], fixed: Sequence[int], file: str) -> dict[int, Line]:
    """Return the line of each dependent joint among `joints`, of which some are `fixed` at their reference.
    The latter no longer follow others, and their followers do not move.

    Raises InvalidFile for couplings that contradict one another, and for those with a joint of another tree."""
    equalities = [
        _Equality(
            model.eq_name[k] or f"equality {k}", int(model.eq_obj1id[k]), int(model.eq_obj2id[k]),
            float(model.eq_data[k, 0]), float(model.eq_data[k, 1]) if int(model.eq_obj2id[k]) >= 0 else 0.0,
        )
        for k in _of_joints(model, joints) if int(model.eq_obj1id[k]) not in fixed
    ]
    for one in equalities:
        if one.leader >= 0 and one.leader not in joints:
            valid = "a joint of the same avatar; avatar=(name, ...) makes one avatar of several trees"
            raise InvalidFile(f"joint2 of {one.name} in {file}", model.jnt_name[one.leader], valid)
    known = {j: Line(-1, 0.0, 0.0) for j in fixed}
    known |= {one.follower: Line(-1, 0.0, one.offset) for one in equalities if one.leader < 0 or one.ratio == 0.0}
    linked = [one for one in equalities if one.leader >= 0 and one.ratio != 0.0]
    _spread(known, linked)
    for j in sorted(joints):
        if j not in known and any(j in (one.follower, one.leader) for one in linked):
            known[j] = Line(j, 1.0, 0.0)
            _spread(known, linked)
    for one in linked:
        expected, own = _through(one, known[one.leader]), known[one.follower]
        if expected.leader != own.leader or max(abs(expected.ratio - own.ratio), abs(expected.offset - own.offset)) > AGREE:
            valid = "one that agrees with the other couplings"
            raise InvalidFile(f"coupling {one.name} of {file}", (one.offset, one.ratio), valid)
    return {j: line for j, line in known.items() if line.leader != j and j not in fixed}


def _through(one: _Equality, leader: Line) -> Line:
    """Return the line of a follower, from that of its leader."""
    return Line(leader.leader, one.ratio * leader.ratio, one.offset + one.ratio * leader.offset)


def _spread(known: dict[int, Line], linked: Sequence[_Equality]) -> None:
    """Add the lines that follow from the known ones."""
    grows = True
    while grows:
        grows = False
        for one in linked:
            if one.leader in known and one.follower not in known:
                known[one.follower] = _through(one, known[one.leader])
                grows = True
            elif one.follower in known and one.leader not in known:
                line = known[one.follower]
                known[one.leader] = Line(line.leader, line.ratio / one.ratio, (line.offset - one.offset) / one.ratio)
                grows = True


def narrowed(
    found: Mapping[int, Line], limits: Mapping[int, tuple[float, float]], names: Mapping[int, str], file: str
) -> dict[int, tuple[float, float]]:
    """Return the limits of all joints: of leaders those that all their followers can keep, of followers the resulting ones.

    Raises InvalidFile where none are left."""
    kept = dict(limits)
    for j, line in found.items():
        if line.leader >= 0:
            ends = sorted((limit - line.offset) / line.ratio for limit in limits[j])
            low, high = kept[line.leader]
            kept[line.leader] = max(low, ends[0]), min(high, ends[1])
    for j, line in found.items():
        if line.leader < 0:
            kept[j] = line.offset, line.offset
            continue
        low, high = kept[line.leader]
        if not low <= high:
            thing = f"limits of {names[line.leader]} in {file} that joints coupled to it leave"
            raise InvalidFile(thing, (low, high), "an interval")
        one, other = (line.ratio * end + line.offset for end in (low, high))
        kept[j] = min(one, other), max(one, other)
    return kept
