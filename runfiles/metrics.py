"""Registry of metrics: `metrics.toml`, one entry per metric."""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from avatarsim.errors import UnknownName


@dataclass(frozen=True)
class Metric:
    """One metric, or a family of metrics whose names begin or end with `name`.

    name        of the metric in tables and files
    unit        of its values
    label       name on pages
    definition  the measured quantity
    kind        group of metrics that measure one quality
    level       difference up to which two values are equal; None where the metric ranks no engine
    share       difference, as a share of the smaller value, up to which two values are equal
    inside      flag: an engine that left its region cannot be best
    optional    flag: a missing value is no statement about the engine
    truth       flag: a distance from a closed form
    watched     flag: compared with the committed baseline
    unranked    reason why the metric ranks no engine
    family      flag: a family
    """

    name: str
    unit: str
    label: str
    definition: str
    kind: str
    level: float | None = None
    share: float = 0.0
    inside: bool = False
    optional: bool = False
    truth: bool = False
    watched: bool = False
    unranked: str = ""
    family: bool = False

    def better(self, one: float, other: float) -> bool:
        """Return whether `one` is better than `other` by more than the metric resolves."""
        if self.level is None or math.isnan(one):
            return False
        return math.isnan(other) or (one < other - self.level and one * (1.0 + self.share) < other)


_ENTRIES = tomllib.loads(Path(__file__).with_name("metrics.toml").read_text(encoding="utf-8"))
_ALL = [Metric(name, **fields) for name, fields in _ENTRIES.items()]

METRICS: Mapping[str, Metric] = MappingProxyType({one.name: one for one in _ALL if not one.family})
"""Metrics by name, in the order of the file."""

FAMILIES: tuple[Metric, ...] = tuple(one for one in _ALL if one.family)
"""Families of metrics."""

RANKED: Mapping[str, Metric] = MappingProxyType({name: one for name, one in METRICS.items() if one.level is not None})
"""Metrics that rank engines."""


def metric(name: str) -> Metric:
    """Return the metric, or the family, of a name. Raises UnknownName."""
    families = [one for one in FAMILIES if name.startswith(one.name) or name.endswith(one.name)]
    if name not in METRICS and not families:
        raise UnknownName("metric", name, METRICS)
    return METRICS.get(name) or families[0]


def unit(name: str) -> str:
    """Return the unit of a metric. Raises UnknownName."""
    return metric(name).unit


def label(name: str) -> str:
    """Return the name of a metric on pages; of a family or an unknown one its own name in words."""
    if name in METRICS:
        return METRICS[name].label
    if name.startswith("stage_share_"):
        return f"share of the frame in {name.removeprefix('stage_share_').replace('_', ' ')}"
    return name.replace("_", " ")
