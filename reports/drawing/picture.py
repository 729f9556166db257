"""From a Vega-Lite specification to a small SVG that can stand in a page among others."""

import os
import re
import resource
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from html import escape
from itertools import pairwise

# The Vega-Lite that altair 6 writes for; the converter carries several.
VEGA_LITE = "6.4"
# [bytes] V8 takes 64 GiB for its heaps and a little more; measured: 60 GB are too few, 70 GB are enough.
ADDRESS_SPACE = 70e9
# One decimal of a pixel: finer cannot be seen, and path data are most of a picture's size.
# Only inside tags: what stands between them is for readers, and "0.01 µs" is not "0 µs".
TAG = re.compile(r"<[^>]*>")
LONG_NUMBER = re.compile(r"-?\d+\.\d{2,}(?:e-?\d+)?")
# Vega describes every mark for screen readers; a picture is one thing here, with one description that says what matters.
INNER_ROLES = re.compile(r' (?:aria-[a-z]+|role|class|pointer-events|xmlns:xlink|version)="[^"]*"')
EMPTY_PATHS = re.compile(r'<path [^>]*(?:d=""|display="none")[^>]*/>|<path d="M0,0h0v0h0Z"/>')
# Said by the style sheet, or the default anyway.
IDLE = re.compile(r' (?:font-family="[^"]*"|font-weight="normal"|opacity="1"|stroke-dasharray="1,0")')
# A path of straight pieces; steps over time are half of them level and half of them upright.
STRAIGHT = re.compile(r"M[-\d.]+,[-\d.]+(?:L[-\d.]+,[-\d.]+)+")
# What XML 1.0 has no place for (its production 2); a name in a file may hold it, and the converter ends the process at one.
NO_SIGN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def picture(spec: Mapping[str, object], label: str, name: str) -> str:
    """The SVG of `spec`, described by `label` in words, in place of the picture; `name` keeps ids apart within one page."""
    require_address_space()
    # brings a JavaScript engine, which ends the process where it has too little memory
    import vl_convert

    svg: str = vl_convert.vegalite_to_svg({key: _writable(part) for key, part in spec.items()}, VEGA_LITE)
    svg = INNER_ROLES.sub("", svg)
    svg = IDLE.sub("", EMPTY_PATHS.sub("", svg))
    svg = TAG.sub(lambda tag: LONG_NUMBER.sub(lambda found: _one_decimal(found.group()), tag.group()), svg)
    svg = svg.replace('id="', f'id="{name}-').replace("url(#", f"url(#{name}-")
    svg = STRAIGHT.sub(lambda found: _short(found.group()), svg)
    return svg.replace("<svg ", f'<svg role="img" aria-label="{escape(NO_SIGN.sub("?", label), quote=True)}" ', 1)


def require_address_space() -> None:
    """Raise MemoryError where the JavaScript engine of the converter could not begin: it would end the process."""
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit != resource.RLIM_INFINITY and limit < ADDRESS_SPACE:
        raise MemoryError(f"vl_convert, which draws charts, reserves {1e-9 * ADDRESS_SPACE:.0f} GB of address space")


def pictures(orders: Sequence[tuple[Mapping[str, object], str, str]]) -> list[Future[str]]:
    """`picture` of each (spec, label, name), several at a time while Python goes on: the converter works outside of its lock."""
    threads = ThreadPoolExecutor(os.cpu_count())
    drawn = [threads.submit(picture, *order) for order in orders]
    # takes no more orders, and ends when it has drawn these
    threads.shutdown(wait=False)
    return drawn


def _writable(part: object) -> object:
    """A part of a specification with a question mark for each sign that a picture cannot hold."""
    if isinstance(part, str):
        return NO_SIGN.sub("?", part)
    if isinstance(part, Mapping):
        return {_writable(key): _writable(value) for key, value in part.items()}
    return [_writable(one) for one in part] if isinstance(part, list | tuple) else part


def _one_decimal(text: str) -> str:
    rounded = f"{float(text):.1f}"
    return "0" if rounded in ("-0.0", "0.0") else rounded.removesuffix(".0")


def _short(path: str) -> str:
    """The same path with level and upright pieces written by their one changing number, and repeated points left out."""
    points = [tuple(point.split(",")) for point in path[1:].split("L")]
    pieces = [f"M{points[0][0]},{points[0][1]}"]
    for (x0, y0), (x, y) in pairwise(points):
        if (x, y) != (x0, y0):
            pieces.append(f"H{x}" if y == y0 else f"V{y}" if x == x0 else f"L{x},{y}")
    return "".join(pieces)
