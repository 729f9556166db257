"""How much of the grid of settings of other engines was measured, by what a setting turns: the cheapest is of that only."""

from collections.abc import Mapping

from reports.sections.sweep.points import OURS, Point, Sweep
from reports.words.wording import count

PRESETS, OTHERS = "presets", "others"
KINDS: Mapping[str, str] = {
    "dt": "steps", "iterations": "iterations", "solver_iterations": "iterations", "sleep": "sleep", "margin": "margins",
    "loose_margin": "margins",
}
"""Option of an engine -> what it turns, in words."""


def kind(point: Point) -> str:
    """What a setting turns: PRESETS for a preset, one of KINDS where it is of one kind alone, else OTHERS."""
    if point.is_preset:
        return PRESETS
    changed = point.setting.removeprefix(f"{point.base} ").split()
    kinds = {KINDS.get(part.partition("=")[0], OTHERS) for part in changed}
    return kinds.pop() if len(kinds) == 1 else OTHERS


def sentence(sweep: Sweep) -> str:
    """Of all scenes and other engines: how many cells were measured of how many planned, and by kind of setting; "" without."""
    cells: dict[tuple[str, str], tuple[str, bool]] = {}
    for point in sweep.points:
        if point.engine != OURS[0] and point.state != "cannot-say":
            place = point.scenario, point.run
            _, before = cells.get(place, ("", False))
            cells[place] = kind(point), before or point.state != "not-measured"
    if not cells:
        return ""
    names = dict.fromkeys((PRESETS, *KINDS.values(), OTHERS))
    of = {name: [measured for known, measured in cells.values() if known == name] for name in names}
    each = ", ".join(f"{name} {sum(found)} of {len(found)}" for name, found in of.items() if found)
    measured = sum(known for _, known in cells.values())
    return (f"Cheapest is the cheapest of what was measured: of {count(len(cells), 'planned cell')} of other engines in all "
            f"scenes, each a setting in a scene, {measured} were, by what a setting turns: {each}.")
