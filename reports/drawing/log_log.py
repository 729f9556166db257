"""A small chart with logarithmic axes as SVG text: marks with tooltips, labels that stay clear of each other, no script."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import pairwise

from reports.drawing.palette import ALARM, GRID, MUTED, TEXT

WIDTH, HEIGHT = 300, 196
"""Size of the picture [px]."""
LEFT, RIGHT, TOP, BOTTOM = 40, 8, 12, 18
"""Margins round the plotting area [px]."""
LETTER, LINE = 5.3, 9.0
"""Width and height of a letter of a label [px], at FONT_SIZE: of the wider of common fonts, with capitals among them."""
STRIDE = 4.0
"""Distance [px] of the places at which labels keep clear of a curve."""
FONT_SIZE = 8.5

Rect = tuple[float, float, float, float]
"""Left, top, right, bottom [px]."""


@dataclass(eq=False)
class LogLog:
    """`x` and `y` are the ends of the axes, all above zero; what lies outside is drawn at the nearer end. Parts are drawn in the
    order in which they are asked for."""

    x: tuple[float, float]
    y: tuple[float, float]
    height: int = HEIGHT
    linear_y: bool = False
    parts: list[str] = field(default_factory=list)
    taken: list[Rect] = field(default_factory=list)

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Where a point is drawn [px]."""
        right = LEFT + _share(x, *self.x) * (WIDTH - LEFT - RIGHT)
        up = _share(y, *self.y) if not self.linear_y else min(max((y - self.y[0]) / (self.y[1] - self.y[0]), 0.0), 1.0)
        return round(right, 1), round(self.height - BOTTOM - up * (self.height - TOP - BOTTOM), 1)

    def x_tick(self, value: float, name: str) -> None:
        """An upright line with a name below the axis."""
        self._upright(value, GRID[0], "")
        self._text(self.at(value, self.y[0])[0], self.height - 5, name, MUTED[0], "middle")

    def x_limit(self, value: float, name: str, anchor: str) -> None:
        """A dashed upright line in the colour of limits, with a name above it that ends or starts there."""
        self._upright(value, ALARM[0], ' stroke-dasharray="4 3"')
        x = self.at(value, self.y[0])[0]
        self.taken.append((x - 1.0, float(TOP), x + 1.0, float(self.height - BOTTOM)))
        self._text(self.at(value, self.y[0])[0], TOP - 4, name, ALARM[0], anchor)

    def _upright(self, value: float, colour: str, dashed: str) -> None:
        x = self.at(value, self.y[0])[0]
        self.parts.append(f'<path d="M{x},{TOP}V{self.height - BOTTOM}" stroke="{colour}" fill="none"{dashed}/>')

    def y_tick(self, value: float, name: str) -> None:
        """A level line with a name on its left."""
        y = self.at(self.x[0], value)[1]
        self.parts.append(f'<path d="M{LEFT},{y}H{WIDTH - RIGHT}" stroke="{GRID[0]}" fill="none"/>')
        self._text(LEFT - 4, y + 3, name, MUTED[0], "end")

    def line(self, points: Iterable[tuple[float, float]], colour: str, dash: str = "", width: float = 1.3, opacity: float = 1.0,
             steps: bool = False) -> None:
        """A line through points, or a staircase that keeps the value of the point on its left."""
        places = [self.at(*point) for point in points]
        if not places:
            return
        first, rest = places[0], places[1:]
        way = "".join(f"H{x}V{y}" if steps else f"L{x},{y}" for x, y in rest)
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        if not steps:
            self._keep_clear(places)
        self.parts.append(f'<path d="M{first[0]},{first[1]}{way}" fill="none" stroke="{colour}" stroke-width="{width}" '
                          f'stroke-opacity="{opacity}" stroke-linejoin="round"{dashed}/>')

    def _keep_clear(self, places: Sequence[tuple[float, float]]) -> None:
        """Labels do not stand on a curve."""
        for (ax, ay), (bx, by) in pairwise(places):
            parts = max(math.ceil(math.hypot(bx - ax, by - ay) / STRIDE), 1)
            for k in range(parts + 1):
                x, y = ax + (bx - ax) * k / parts, ay + (by - ay) * k / parts
                self.taken.append((x - 1.0, y - 1.0, x + 1.0, y + 1.0))

    def dot(self, x: float, y: float, colour: str, told: str, radius: float, filled: bool) -> None:
        """A round mark with a tooltip; one that is not filled has a centre all the same, so that it can be pointed at."""
        px, py = self.at(x, y)
        opacity = "" if filled else ' fill-opacity="0.15"'
        self.parts.append(f'<circle cx="{px}" cy="{py}" r="{radius}" fill="{colour}" stroke="{colour}"{opacity}>'
                          f"<title>{escape(told)}</title></circle>")
        self.taken.append((px - radius, py - radius, px + radius, py + radius))

    def cross(self, x: float, y: float, colour: str, told: str) -> None:
        """A crossed mark with a tooltip."""
        px, py = self.at(x, y)
        self.parts.append(
            f'<g><title>{escape(told)}</title><path d="M{px - 3:.1f},{py - 3:.1f}l6,6m0,-6l-6,6" stroke="{colour}" '
            f'stroke-width="1.5" fill="none"/><circle cx="{px}" cy="{py}" r="5" fill="{colour}" fill-opacity="0"/></g>'
        )
        self.taken.append((px - 3, py - 3, px + 3, py + 3))

    def label(self, x: float, y: float, words: str, colour: str) -> bool:
        """A word beside a point, on the first side that is free; whether there was one. To be asked once all marks are drawn."""
        px, py = self.at(x, y)
        wide = LETTER * len(words)
        for left, middle in ((px + 6, py), (px - 6 - wide, py), (px - wide / 2, py - 9), (px - wide / 2, py + 9),
                             (px + 5, py - 8), (px + 5, py + 8), (px - 5 - wide, py - 8), (px - 5 - wide, py + 8)):
            place = (left, middle - LINE / 2, left + wide, middle + LINE / 2)
            inside = place[0] >= LEFT and place[2] <= WIDTH - 1 and place[1] >= TOP - 4 and place[3] <= self.height - BOTTOM + 3
            if inside and not any(_overlap(place, other) for other in self.taken):
                self.taken.append(place)
                self._text(left, middle + 3, words, colour, "start")
                return True
        return False

    def end_label(self, y: float, words: str, colour: str) -> None:
        """A word at the right end below a line that ends at `y`, lower where others stand already."""
        top = self.at(self.x[1], y)[1] + 2
        left, right = WIDTH - RIGHT - 2 - LETTER * len(words), float(WIDTH - RIGHT - 2)
        while any(_overlap((left, top, right, top + LINE), other) for other in self.taken):
            top += LINE
        self.taken.append((left, top, right, top + LINE))
        self._text(right, top + LINE - 2, words, colour, "end")

    def _text(self, x: float, y: float, words: str, colour: str, anchor: str) -> None:
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" font-size="{FONT_SIZE}" fill="{colour}" text-anchor="{anchor}">'
                          f"{escape(words)}</text>")

    def svg(self, described: str) -> str:
        """The whole picture, described for readers that do not see it."""
        label = escape(described, quote=True)
        return (f'<svg role="img" aria-label="{label}" viewBox="0 0 {WIDTH} {self.height}" width="{WIDTH}" '
                f'height="{self.height}" stroke="none" fill="{TEXT[0]}">{"".join(self.parts)}</svg>')


def decades(low: float, high: float) -> Sequence[float]:
    """The powers of ten from `low` to `high`, both included."""
    return [10.0**k for k in range(math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9) + 1)]


def _share(value: float, low: float, high: float) -> float:
    """Where a value lies between two others on a logarithmic scale, 0 to 1."""
    if not value > low:
        return 0.0
    return min(math.log(value / low) / math.log(high / low), 1.0)


def _overlap(a: Rect, b: Rect) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
