"""Parts that charts share: scenes' dots, axes, colours.

Colours are tokens, "@avatarsim" or "@ink": the page puts in those of its theme, and a static picture the light ones.
"""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from runfiles.engines import engines

Spec = dict[str, Any]

INKS: Mapping[str, tuple[str, str]] = {
    "ink": ("#31363f", "#cfd4dc"),
    "muted": ("#6a7280", "#97a0ae"),
    "grid": ("#e3e6eb", "#2c323c"),
    "alarm": ("#b3261e", "#ff8a80"),
    "paper": ("#ffffff", "#14171c"),
    "low": ("#e6eef6", "#1b2a39"),
    "high": ("#0b3c66", "#3f9be0"),
    "gain": ("#7cc7a6", "#1f6b4d"),
}
"""Inks of charts, light and dark."""

LENGTH_LABEL = (
    "datum.value >= 1 ? datum.value + ' m' : datum.value > 9e-4 ? round(datum.value * 1e3) + ' mm' : "
    "datum.value > 9e-7 ? round(datum.value * 1e6) + ' µm' : round(datum.value * 1e9) + ' nm'"
)
TIME_LABEL = (
    "datum.value >= 1e3 ? datum.value / 1e3 + ' ms' : datum.value >= 1 ? datum.value + ' µs' : round(datum.value * 1e3) + ' ns'"
)
"""Vega expressions of axis labels: of lengths in metres, of times in microseconds."""


def palette(extra: Mapping[str, tuple[str, str]]) -> dict[str, dict[str, str]]:
    """Return the colours of both themes by token; ``extra`` are those of engines that no file describes."""
    both = {**INKS, **{one.name: (one.colour, one.dark) for one in engines().values()}, **extra}
    return {theme: {name: pair[k] for name, pair in both.items()} for k, theme in enumerate(("light", "dark"))}


def coloured(spec: Spec, colours: Mapping[str, str]) -> Spec:
    """Return a specification with the colours of one theme in place of its tokens."""
    text = json.dumps(spec)
    for name, colour in colours.items():
        text = text.replace(f'"@{name}"', json.dumps(colour))
    found: Spec = json.loads(text)
    return found


def tooltip(**titles: str) -> list[Spec]:
    """Return the channel of fields that a pointed mark shows, by their titles."""
    return [{"field": name, "type": "nominal", "title": title} for name, title in titles.items()]


def by_engine(names: Sequence[str]) -> Spec:
    """Return the colour channel of a field `engine`."""
    return {
        "field": "engine",
        "type": "nominal",
        "legend": None,
        "scale": {"domain": list(names), "range": [f"@{name}" for name in names]},
    }


def place_of(name: str) -> float:
    """Return a fixed place from -1 to 1 for a scene, so that its dots are at one height in every chart."""
    return (sum(ord(letter) * (k + 7) for k, letter in enumerate(name)) % 101) / 50.0 - 1.0


def labels(ticks: Mapping[float, str]) -> str:
    """Return a Vega expression that labels an axis with these texts."""
    return "".join(f"abs(datum.value / {value!r} - 1) < 1e-6 ? {text!r} : " for value, text in ticks.items()) + "''"
