"""Which effects a scene calls for, by which of its parts, and which promise lapses where its author left one out: in words."""

from collections.abc import Mapping
from dataclasses import fields
from textwrap import fill

from avatarsim.scene.effects import CALLS, KEPT
from avatarsim.scene.scene import Scene

LISTED = 3
"""Parts named in full; of more the number is said."""

WIDTH = 120
"""Columns of the table on a terminal."""


def effects_of(scene: Scene) -> dict[str, object]:
    """What there is to say of a scene's effects, as data."""
    on, derived = scene.effects, scene.derived_effects
    return {
        "effects": [effect.name for effect in fields(on) if getattr(on, effect.name)],
        "called_by": {effect: list(parts) for effect, parts in scene.calls.items() if parts},
        "switched_off": list(on.missing_from(derived)),
        "lapsed": dict(scene.lapsed),
    }


def lines_of(scene: Scene) -> list[str]:
    """The same in words: one line an effect."""
    on = [effect.name for effect in fields(scene.effects) if getattr(scene.effects, effect.name)]
    said = [f"{effect:16} {parts_named(scene.calls[effect])}" for effect in on]
    said += [f"{effect:16} left out by its author: promise {lapsed} lapses" for effect, lapsed in scene.lapsed.items()]
    return said or ["nothing calls for any effect"]


def parts_named(parts: tuple[str, ...]) -> str:
    """A few names and a number; for an effect that is forced there are none."""
    if not parts:
        return "forced: nothing calls for it"
    more = f" and {len(parts) - LISTED} more" if len(parts) > LISTED else ""
    return ", ".join(parts[:LISTED]) + more


def lapse_said(scene: str, lapsed: Mapping[str, str]) -> str:
    """What an author gave up by leaving effects out; empty if nothing. Such a scene is measured, but stands outside the gate."""
    if not lapsed:
        return ""
    without = ", ".join(f"{effect}: promise {promise} lapses" for effect, promise in lapsed.items())
    return f"{scene} stands outside the gate, since its author left out {without}"


def table_of_calls() -> str:
    """Which part of a scene calls for which effect, and why."""
    rows = ["An effect runs in a scene if a part of it calls for it:", ""]
    for call in CALLS:
        without = "Cannot be left out." if call.effect in KEPT else f"Left out, promise {call.lapses} lapses."
        text = f"{call.part}: {call.why}. {without}"
        rows.append(fill(text, WIDTH, initial_indent=f"{call.effect:16} ", subsequent_indent=" " * 17))
    return "\n".join([*rows, ""])
