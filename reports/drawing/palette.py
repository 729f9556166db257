"""Colours and dashes of engines and presets, for light and dark pages.

A chart is drawn once, in light colours. The page's style sheet maps each of these exact hexadecimal values to its dark partner
by attribute selector, so one static picture serves both. The series colours are apart for the colour-blind (Okabe and Ito).
"""

from collections.abc import Iterable
from dataclasses import dataclass

# Ink of charts: (light, dark). Each light value must be unique, because the style sheet recognises it in the picture.
TEXT, MUTED, GRID, ALARM = ("#31363f", "#cfd4dc"), ("#6a7280", "#97a0ae"), ("#e3e6eb", "#2c323c"), ("#b3261e", "#ff8a80")
NAMED = {
    "avatarsim": ("#0067b1", "#5fb3f9"),
    "mujoco": ("#d55e00", "#ff9a4d"),
    "pybullet": ("#00855f", "#3fcf9f"),
    "tracker": ("#8b8f97", "#868c96"),
}
SPARE = (("#b0498d", "#f08fce"), ("#9a7400", "#e6c04a"), ("#3c8fb3", "#7fd0ef"), ("#7a5cc4", "#b7a0ff"))
DASHES = ((1, 0), (5, 3), (2, 2), (8, 3, 2, 3), (12, 4), (1, 4))
"""First preset of an engine solid, the next dashed, and so on; what comes after these is made by `dash`, so none is twice."""


@dataclass(frozen=True)
class Stroke:
    """How one run is drawn; colours as #rrggbb, `dash` in pixels on and off."""

    light: str
    dark: str
    dash: tuple[int, ...]


def dash(index: int) -> tuple[int, ...]:
    """The dash of the `index`-th preset of an engine, its own: after DASHES a long stroke and one dot more each time."""
    return DASHES[index] if index < len(DASHES) else (8, 3) + (2, 3) * (index - len(DASHES) + 2)


def strokes(runs: Iterable[str]) -> dict[str, Stroke]:
    """A stroke per run, in the order given. The colour says the engine, the dash the preset (default is always solid)."""
    seen: dict[str, list[str]] = {}
    ordered = tuple(dict.fromkeys(runs))
    for run in sorted(ordered, key=lambda run: not run.endswith("/default")):
        seen.setdefault(run.split("/")[0], []).append(run)
    others = [engine for engine in seen if engine not in NAMED]
    colours = NAMED | {engine: SPARE[index % len(SPARE)] for index, engine in enumerate(sorted(others))}
    found = {
        run: Stroke(*colours[engine], dash(index))
        for engine, own in seen.items() for index, run in enumerate(own)
    }
    return {run: found[run] for run in ordered}


def dark_rules() -> str:
    """The style sheet's part that turns light chart colours into dark ones."""
    pairs = (TEXT, MUTED, GRID, ALARM, *NAMED.values(), *SPARE)
    return "\n".join(
        f'.plot [{kind}="{light}"]{{{kind}:light-dark({light},{dark})}}' for light, dark in pairs for kind in ("stroke", "fill")
    )
