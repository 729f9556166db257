"""Numbers as a reader wants them: three figures, a unit of the right size, and a word where there is no number."""

import math

MISSING = "—"
# Prefixes for lengths and times, largest first: (factor to the base unit, name). The base units are metre and microsecond.
LENGTHS = ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"))
# Below this [m] digits of a length say nothing: the judge resolves 10 nm, and a thousandth of a micrometre is no overlap.
LEAST_LENGTH = 1e-9
# Factors end here: above, all that a reader takes from them is that one of two figures is as good as nothing.
MOST_FACTOR = 1000.0
AGAINST_ZERO = "against 0"
TIMES = ((1e6, "s"), (1e3, "ms"), (1.0, "µs"), (1e-3, "ns"))
UNITS = {"deg": "°", "us": "µs"}


def quantity(value: float | None, unit: str) -> str:
    """`value` in `unit` with three figures: metres and microseconds get a fitting prefix; None is a dash, NaN is NaN."""
    if value is None:
        return MISSING
    if math.isnan(value):
        return "NaN"
    if math.isinf(value):
        return "infinite"
    if unit == "frames":
        return f"{value:,.0f}"
    if value == 0.0:
        return f"0 {unit}" if unit not in ("m", "us", "deg", "") else "0"
    if unit == "m" and abs(value) < LEAST_LENGTH:
        return "< 1 nm"
    if unit == "m" and abs(value) < 1e3:
        return _prefixed(value, LENGTHS)
    if unit == "us":
        return _prefixed(value, TIMES)
    name = UNITS.get(unit, unit)
    return f"{figures(value)}{'' if name in ('', '°') else ' '}{name}"


def _prefixed(value: float, prefixes: tuple[tuple[float, str], ...]) -> str:
    # 0.9995 guards against 999.7 µm being printed as 1,000 µm.
    factor, name = next((p for p in prefixes if abs(value) >= 0.9995 * p[0]), prefixes[-1])
    return f"{figures(value / factor)} {name}"


def figures(value: float) -> str:
    """Three significant figures, thousands separated, powers of ten only where plain digits would be long."""
    size = abs(value)
    if size == 0.0:
        return "0"
    if not 1e-3 <= size < 1e6:
        digits, exponent = f"{value:.1e}".split("e")
        return f"{digits}·10{_superscript(int(exponent))}"
    if size >= 999.5:
        return f"{value:,.0f}"
    rounded = float(f"{value:.2e}")  # first, so that 9.999 becomes 10.0 and not 10.00
    decimals = max(0, 2 - math.floor(math.log10(abs(rounded))))
    text = f"{rounded:.{decimals}f}"
    return text.rstrip("0") if decimals > 2 else text


def limit(value: float | None, unit: str) -> str:
    """A chosen number, such as a bound: as `quantity`, without the zeros that only say how precisely something was measured."""
    number, space, name = quantity(value, unit).partition(" ")
    return (number.rstrip("0").rstrip(".") if "." in number and "·" not in number else number) + space + name


def ratio(value: float | None) -> str:
    """How many times the best: "best" for 1, "level" within 0.5 %, else the factor; a dash where there is nothing to compare."""
    if value is None or math.isnan(value):
        return MISSING
    if value <= 1.0:
        return "best"
    return "level" if value < 1.005 else factor(value)


def factor(value: float) -> str:
    """"×12", above MOST_FACTOR only that it is more, no number where it was taken to zero (infinite); a dash for no number."""
    if math.isnan(value):
        return MISSING
    if math.isinf(value):
        return AGAINST_ZERO
    if value > MOST_FACTOR:
        return f"more than ×{MOST_FACTOR:,.0f}"
    if value < 9.95:
        return f"×{value:.2f}" if value < 1.095 else f"×{value:.1f}"
    return f"×{float(f'{value:.1e}'):,.0f}"


def count(number: int, noun: str) -> str:
    """"1 scene", "3 scenes"."""
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"


def families(number: int) -> str:
    """"1 family", "3 families": of scenes, each a scene with its variants."""
    return f"{number:,} {'family' if number == 1 else 'families'}"


def listed(names: tuple[str, ...], most: int = 6) -> str:
    """Names with commas; the rest as a number."""
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")


def _superscript(number: int) -> str:
    return str(number).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
