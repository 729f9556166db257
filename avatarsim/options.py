"""Options of a method: the settings with those fields replaced that a user names, checked."""

from collections.abc import Mapping
from typing import get_type_hints

from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.checks import as_number
from avatarsim.settings import Chosen

MOST = 1e9
"""Largest value of any option: a billion of anything here is a slip of the hand."""

CHOICES = {"around": 2, "couple": 1}
"""Largest value of the options that are a choice between 0 and this."""

LEAST = {
    "steps": 1, "sweeps": 1, "work": 1, "stand_off": 1e-7, "rounds": 1, "spring": 1e-3, "walk_back": 1e-12, "settle_time": 1e-3,
    "catch_up_turn": 1e-3, "catch_up_move": 1e-3, "natural_frequency": 1.0, "sticking_speed": 1e-3,
}
"""Smallest value of the options that are no switch: with 0 no body moves, no offset decays, or only rounding is left."""

METHOD_SETTINGS = {"default": ("posture", "coupling"), "paper": ("paper", "coupling", "attraction")}
"""The groups of settings that each method reads."""


def choose(method: str, options: Mapping[str, object]) -> Chosen:
    """Return the method's settings with those fields replaced that `options` names, checked for name, type and finiteness."""
    chosen, left = Chosen(), dict(options)
    known: list[str] = []
    for group in METHOD_SETTINGS[method]:
        defaults = getattr(chosen, group)
        fields = get_type_hints(type(defaults))
        known += fields
        replaced = {name: number(name, left.pop(name), kind) for name, kind in fields.items() if name in left}
        chosen = chosen._replace(**{group: defaults._replace(**replaced)})
    for name in left:
        raise UnknownName(f"option of avatarsim, preset {method}", name, known)
    require_order(chosen, method)
    return chosen


def number(name: str, value: object, kind: type[float] | type[int]) -> float:
    """Return `value` as a number of `kind`, within the range of option `name`."""
    found, least, most = as_number(value), LEAST.get(name, 0.0), CHOICES.get(name, MOST)
    if not least <= found <= most:
        raise InvalidInput(f"option {name}", value, f"a number from {least:g} to {most:g}")
    if kind is int and found != int(found):
        raise InvalidInput(f"option {name}", value, f"a whole number from {least:g} to {most:g}")
    return kind(found)


def require_order(chosen: Chosen, method: str) -> None:
    """Refuse a tolerance that is no smaller than the gap it belongs to: goals would then be reached in contact."""
    if method == "paper" and chosen.paper.tolerance >= chosen.paper.stand_off:
        raise InvalidInput("option tolerance", chosen.paper.tolerance, f"below stand_off, {chosen.paper.stand_off:g} m")
