"""Numbers of MJCF and URDF files, checked as written: MuJoCo's compiler clips some wrong ones and drops others.

A missing value has the default of the format. A wrong one is refused with the place of its element, the value and the valid
range. Masses may be 0: links fixed to the world often have none.
"""

from collections.abc import Callable, Mapping, Sequence
from math import inf, isfinite
from typing import NamedTuple

from avatarsim.errors import InvalidFile


class Rule(NamedTuple):
    """Count of numbers of an attribute (None: any), a test of all of them, and the valid range in words."""

    numbers: int | None
    is_valid: Callable[[Sequence[float]], bool]
    valid: str


def _finite(count: int | None) -> Rule:
    return Rule(count, lambda v: True, "")


def _from_zero(count: int | None) -> Rule:
    return Rule(count, lambda v: min(v) >= 0.0, ", 0 or more")


def _above_zero(count: int | None) -> Rule:
    return Rule(count, lambda v: min(v) > 0.0, ", above 0")


def _direction(count: int) -> Rule:
    return Rule(count, any, ", not all of them 0")


NUMBER, PLACE = _finite(1), _finite(3)
AMOUNT, LENGTH = _from_zero(1), _above_zero(1)
SCALE = Rule(3, all, ", none of them 0")
MOMENT = Rule(1, lambda v: v[0] >= -1e-12, ", 0 or more")
FIRST_AMOUNT = Rule(None, lambda v: v[0] >= 0.0, ", the first of them 0 or more")

URDF: Mapping[str, Mapping[str, Rule]] = {
    "mass": {"value": AMOUNT},
    "inertia": {**dict.fromkeys(("ixx", "iyy", "izz"), MOMENT), **dict.fromkeys(("ixy", "ixz", "iyz"), NUMBER)},
    "box": {"size": _above_zero(3)}, "sphere": {"radius": LENGTH},
    "cylinder": {"radius": LENGTH, "length": LENGTH}, "capsule": {"radius": LENGTH, "length": LENGTH},
    "mesh": {"scale": SCALE}, "axis": {"xyz": _direction(3)}, "origin": {"xyz": PLACE, "rpy": PLACE},
    "limit": {"lower": NUMBER, "upper": NUMBER, "effort": AMOUNT, "velocity": AMOUNT},
    "dynamics": {"damping": AMOUNT, "friction": AMOUNT}, "mimic": {"multiplier": NUMBER, "offset": NUMBER},
}
"""Rules of URDF by element and attribute."""

POSE: Mapping[str, Rule] = {
    "pos": PLACE, "quat": _direction(4), "euler": PLACE, "zaxis": _direction(3), "xyaxes": _finite(6),
    "axisangle": Rule(4, lambda v: any(v[:3]), ", not all of the first three 0"),
}

MJCF: Mapping[str, Mapping[str, Rule]] = {
    "body": POSE, "frame": POSE, "site": POSE,
    "inertial": {
        **POSE, "mass": AMOUNT, "diaginertia": _from_zero(3),
        "fullinertia": Rule(6, lambda v: min(v[:3]) >= 0.0, ", the first three 0 or more"),
    },
    "geom": {
        **POSE, "size": _from_zero(None), "mass": AMOUNT, "density": AMOUNT, "friction": _from_zero(None),
        "margin": AMOUNT, "gap": NUMBER, "fromto": Rule(6, lambda v: v[:3] != v[3:], ", of two places apart"),
    },
    "joint": {
        "pos": PLACE, "axis": _direction(3), "ref": NUMBER, "springref": NUMBER, "armature": AMOUNT, "frictionloss": AMOUNT,
        "damping": FIRST_AMOUNT, "stiffness": FIRST_AMOUNT,
        "range": Rule(2, lambda v: v[0] < v[1] or not any(v), ", the lower one first; or 0 0 for no limits"),
    },
    "mesh": {"scale": SCALE, "refpos": PLACE, "refquat": _direction(4)},
    "option": {"timestep": LENGTH, "gravity": PLACE, "o_friction": _from_zero(None)},
    "pair": {"friction": _from_zero(None)},
    "key": {"qpos": _finite(None), "mpos": _finite(None), "mquat": _finite(None)},
    "compiler": {"boundmass": AMOUNT, "boundinertia": AMOUNT},
}
"""Rules of MJCF by element and attribute, for the attributes that are read or that a simulation would need."""

BALL_RANGE = Rule(2, lambda v: v[0] == 0.0 and v[1] >= 0.0, ", 0 and the largest angle; or 0 0 for no limits")
"""Rule of the range of an MJCF ball joint."""

SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}
"""Count of numbers in the size of an MJCF geom, all above 0; one less, but at least one, between two places (`fromto`)."""

TURNLESS = ("fixed", "floating", "ball", "free")
"""Types of joints that have no axis: their axis attribute is ignored."""

LIMITED = ("revolute", "prismatic")
"""Types of URDF joints that have limits."""


class Element(NamedTuple):
    """An open element: its tag and its attributes."""

    tag: str
    attributes: Mapping[str, str]


def require(place: Callable[[str], str], above: Sequence[Element], own: Element) -> None:
    """Raise InvalidFile for a number of the element `own`, below the elements `above`, that the format does not allow.

    `place` adds file and line to what an error is about."""
    is_robot = (*above, own)[0].tag == "robot"
    joint = above[-1].attributes.get("type") if is_robot and above else own.attributes.get("type")
    of = _label(above, own)
    for key, rule in (URDF if is_robot else MJCF).get(own.tag, {}).items():
        if key in own.attributes and not ("axis" in (key, own.tag) and joint in TURNLESS):
            if own.tag == "geom" and key == "size":
                rule = _size(own.attributes)
            elif own.tag == "joint" and key == "range" and joint == "ball":
                rule = BALL_RANGE
            _numbers(place(f"{key} of {of}"), own.attributes[key], rule)
    if is_robot and own.tag == "limit" and joint in LIMITED:
        ends = [own.attributes[key] for key in ("lower", "upper") if key in own.attributes]
        limits = tuple(map(float, ends))
        if ends and not (len(ends) == 2 and (limits[0] < limits[1] or not any(limits))):
            valid = 'both, lower below upper; 0 and 0, or neither: no limits; type="fixed" does not move'
            raise InvalidFile(place(f"lower and upper of {of}"), " and ".join(ends), valid)


def _label(above: Sequence[Element], own: Element) -> str:
    """Return the name of an element in errors: its own, or that of the nearest enclosing element that has a name."""
    if "name" in own.attributes:
        return f"{own.tag} {own.attributes['name']}"
    named = next((one for one in reversed(above) if "name" in one.attributes), None)
    return f"<{own.tag}>" if named is None else f"<{own.tag}> of {named.tag} {named.attributes['name']}"


def _size(attributes: Mapping[str, str]) -> Rule:
    """Return the rule of a geom's size, which is the stricter where the geom itself states its type."""
    count = SIZES.get(attributes.get("type", ""))
    if count is None:
        return MJCF["geom"]["size"]
    if "fromto" in attributes:
        count = max(1, count - 1)
    valid = f", the first {count} of them above 0" if count > 1 else ", the first of them above 0"
    # missing ones may be in a class of defaults
    return Rule(None, lambda v: min(v[:count]) > 0.0, valid)


def _numbers(thing: str, text: str, rule: Rule) -> None:
    """Raise InvalidFile unless a text contains the numbers that a rule requires."""
    values = [_number(word) for word in text.split()]
    counted = bool(values) and rule.numbers in (None, len(values))
    if not (counted and all(map(isfinite, values)) and rule.is_valid(values)):
        wanted = "a finite number" if rule.numbers == 1 else f"{rule.numbers or ''} finite numbers".strip()
        raise InvalidFile(thing, text[:200], wanted + rule.valid)


def _number(word: str) -> float:
    """Return the number in a word; infinite for none."""
    try:
        return float(word) if "_" not in word else inf
    except ValueError:
        return inf
