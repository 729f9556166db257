"""Parts that charts share: channels, marks, axes, colours.

Colours are tokens, "@avatarsim" or "@ink": the page puts in those of its theme, and a static picture the light ones.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from runfiles.engines import about, engines

Spec = dict[str, Any]

INKS: Mapping[str, tuple[str, str]] = {
    "ink": ("#31363f", "#cfd4dc"), "muted": ("#6a7280", "#97a0ae"), "grid": ("#e3e6eb", "#2c323c"),
    "alarm": ("#b3261e", "#ff8a80"), "paper": ("#ffffff", "#14171c"), "low": ("#e6eef6", "#18222c"),
    "high": ("#0b3c66", "#2b76b5"), "gain": ("#7cc7a6", "#1f6b4d"),
}
"""Inks of charts, light and dark."""

LENGTH_LABEL = (
    "datum.value == 0 ? '0' : datum.value >= 1 ? datum.value + ' m' : datum.value > 9e-4 ? round(datum.value * 1e3) + ' mm' : "
    "datum.value > 9e-7 ? round(datum.value * 1e6) + ' µm' : round(datum.value * 1e9) + ' nm'"
)
TIME_LABEL = (
    "datum.value == 0 ? '0' : datum.value >= 1e3 ? datum.value / 1e3 + ' ms' : "
    "datum.value >= 1 ? datum.value + ' µs' : round(datum.value * 1e3) + ' ns'"
)
"""Vega expressions of axis labels: of lengths in metres, of times in microseconds."""

BARE: Spec = {"title": None, "domain": False, "tickSize": 0}
"""An axis of labels alone."""

NAMES: Spec = {"title": None, "domain": False, "ticks": False}
"""The same of names."""


def chart(described: str, height: int, layers: Sequence[Spec], values: Sequence[Spec] | None = None, **more: Any) -> Spec:
    """Return a chart as wide as its place and ``height`` [px] high."""
    data = {} if values is None else {"data": {"values": list(values)}}
    return {"width": "container", "height": height, "description": described, **data, "layer": list(layers), **more}


def layer(mark: str, encoding: Spec, **more: Any) -> Spec:
    """Return a layer of marks with these properties."""
    return {"mark": {"type": mark, **more}, "encoding": encoding}


def number(field: str, **more: Any) -> Spec:
    """Return the channel of a field of numbers."""
    return {"field": field, "type": "quantitative", **more}


def name(field: str, **more: Any) -> Spec:
    """Return the channel of a field of names."""
    return {"field": field, "type": "nominal", **more}


def names_in_order(field: str, order: Sequence[str], **axis: Any) -> Spec:
    """Return the channel of a field whose axis has these names in this order."""
    return name(field, sort=list(order), scale={"domain": list(order)}, axis=NAMES | axis)


def tooltip(**titles: str) -> list[Spec]:
    """Return the channel of fields that a pointed mark shows, by their titles."""
    return [name(field, title=title) for field, title in titles.items()]


def by_engine(names: Sequence[str]) -> Spec:
    """Return the colour channel of a field `engine`."""
    return name("engine", legend=None, scale={"domain": list(names), "range": [f"@{one}" for one in names]})


def shades(low: float, high: float, test: str, colour: str) -> Spec:
    """Return the channel of a field `shade` between two numbers; ``colour`` where the flag ``test`` is set."""
    scale = {"domain": [low, high], "range": ["@low", "@high"], "clamp": True}
    return number("shade", legend=None, scale=scale, condition={"test": test, "value": colour})


def palette(more: Iterable[str] = ()) -> dict[str, dict[str, str]]:
    """Return the colours of both themes by token; ``more`` are engines that no file describes."""
    both = {**INKS, **{name: (about(name).colour, about(name).dark) for name in (*engines(), *more)}}
    return {theme: {token: pair[k] for token, pair in both.items()} for k, theme in enumerate(("light", "dark"))}


def coloured(spec: Spec, colours: Mapping[str, str]) -> Spec:
    """Return a specification with the colours of one theme in place of its tokens."""
    text = json.dumps(spec)
    for token, colour in colours.items():
        text = text.replace(f'"@{token}"', json.dumps(colour))
    filled: Spec = json.loads(text)
    return filled


def place_of(scene: str) -> float:
    """Return a fixed place from -1 to 1 for a scene, so that its dots are at one height in every chart."""
    return (sum(ord(letter) * (k + 7) for k, letter in enumerate(scene)) % 101) / 50.0 - 1.0


def labels(ticks: Mapping[float, str]) -> str:
    """Return a Vega expression that labels an axis with these texts."""
    return "".join(f"abs(datum.value / {value!r} - 1) < 1e-6 ? {text!r} : " for value, text in ticks.items()) + "''"
