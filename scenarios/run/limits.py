"""Limits that a user puts engines to in a scene of their own: metrics of the registry with values, and the checks they make."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from avatarsim.errors import InvalidInput, UnknownName
from runfiles.metrics import METRICS, unit
from runfiles.naming import GATED
from runfiles.table import Row
from scenarios.run.gate import bounds_of
from scenarios.scenario import Bound, Scenario

OVERLAP = "residual_overlap_max"
FINITE = "not_finite_frames"
"""Metric that every gated run is checked for: other figures of poses that are not numbers mean nothing."""
ALIASES = {"overlap": OVERLAP}
"""Columns of the table of `avatarsim.compare` that have a shorter name than their metric."""
SIZES: Mapping[str, Mapping[str, float]] = {
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9},
    "us": {"s": 1e6, "ms": 1e3, "us": 1.0, "µs": 1.0}, "s": {"s": 1.0, "ms": 1e-3},
    "deg": {"deg": 1.0, "°": 1.0}, "%": {"%": 1.0},
}
"""Unit of a metric -> units that a limit may be written in, with their size."""
NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S*)\s*")


def limit_of(name: str, text: str) -> float:
    """Return a limit on metric `name` in the metric's unit: "1mm", "0.5", "2 deg". Raises UnknownName, InvalidInput.

    A length or a time needs its unit: tables show millimetres, and "1" would be a metre."""
    sizes = SIZES.get(unit(name), {unit(name): 1.0})
    match = NUMBER.fullmatch(text)
    units = ", ".join(filter(None, sizes)) or "none"
    if match is None or (match[2] and match[2] not in sizes):
        raise InvalidInput(f"limit of {name}", text, f"a number, in {unit(name) or 'no unit'} or with one of the units {units}")
    if not match[2] and len(set(sizes.values())) > 1 and float(match[1]) != 0.0:
        raise InvalidInput(f"limit of {name}", text, f"a number with its unit, one of {units}")
    return float(match[1]) * sizes.get(match[2], 1.0)


def limits_of(overlap: str | None, others: Sequence[str]) -> dict[str, float]:
    """Return metric -> limit of the options --max-overlap and --max. Raises UnknownName, InvalidInput."""
    limits = {} if overlap is None else {OVERLAP: limit_of(OVERLAP, overlap)}
    for text in others:
        name, equals, value = text.partition("=")
        if not equals:
            raise InvalidInput("--max", text, "METRIC=VALUE, such as residual_overlap_max=1mm")
        name = ALIASES.get(name, name)
        try:
            limits[name] = limit_of(name, value)
        except UnknownName as error:
            raise UnknownName("metric of --max, of those that --metrics lists,", name, METRICS) from error
    return limits


def with_limits(scenario: Scenario, limits: Mapping[str, float]) -> Scenario:
    """Return the scenario with these limits in place of its own bounds, which stay without any."""
    bounds = tuple(Bound(name, value, "a limit of the user") for name, value in limits.items())
    return replace(scenario, bounds=bounds or scenario.bounds)


def checks_of(
    rows: Iterable[Row], scenarios: Mapping[str, Scenario], gates: Sequence[str], limits: Mapping[str, float],
) -> list[Row]:
    """Return the rows of the gated runs that are checked: of their limits, and one for a run without figures."""
    checks = []
    for row in rows:
        checked = {*limits, FINITE} if limits else set(bounds_of(scenarios[row.scenario]))
        if row.run in gates and (row.metric == "run" or row.metric in checked):
            refuses = row.status in ("refused", "cannot-say")
            checks.append(replace(row, status="not-measured", note=f"refuses the scene: {row.note}") if refuses else row)
    return checks


def gates_of(gates: Sequence[str], engines: Sequence[str], limits: Mapping[str, float]) -> list[str]:
    """Return the engines that limits are for: as they are gated, else all that are chosen, else the engine that promises bounds.

    Without a limit it alone is gated, if it is chosen. Raises InvalidInput for a gate without a limit.
    """
    if gates and not limits:
        raise InvalidInput("--gate without a limit", ", ".join(gates), "with --max-overlap 1mm, or --max METRIC=VALUE")
    promises = "/".join(GATED)
    if gates or (limits and engines):
        return list(dict.fromkeys(gates or engines))
    return [promises] if not engines or {promises, GATED[0]} & set(engines) else []
