"""A picture's coordinates are rounded, what is written on it is not."""

import resource
from xml.etree import ElementTree

import pytest

from reports.drawing.picture import picture


def test_what_is_written_on_a_picture_keeps_its_digits() -> None:
    """"0.01 µs" rounded like a coordinate would be "0 µs"."""
    spec = {
        "$schema": "https://vega.github.io/schema/vega-lite/v6.json", "data": {"values": [{"a": 1.0 / 3.0}]},
        "mark": {"type": "text", "text": "0.012345 µs"}, "encoding": {"x": {"field": "a", "type": "quantitative"}},
    }
    svg = picture(spec, "said", "p")
    assert ">0.012345 µs<" in svg and 'aria-label="said"' in svg
    assert "0.333" not in svg


@pytest.mark.parametrize("sign", ["\0", "\x1b", "\x7f", "\ud800", "\ufffe", "&"])
def test_a_sign_that_no_picture_can_hold_costs_that_sign(sign: str) -> None:
    """The converter ends the process at a NUL, so names from files must not bring it there."""
    spec = {
        "data": {"values": [{"a": 1.0, "name": f"wall{sign}"}]}, "mark": "point",
        "encoding": {"x": {"field": "a", "type": "quantitative"}, "y": {"field": "name", "type": "nominal"}},
    }
    svg = picture(spec, f"wall{sign}", "p")
    assert ElementTree.fromstring(svg).attrib["aria-label"] == "wall" + (sign if sign in "\x7f&" else "?")
    assert "wall" in svg.split(">", 1)[1]


def test_too_little_address_space_is_an_error_and_not_the_end_of_the_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resource, "getrlimit", lambda which: (2 * 10**9, 2 * 10**9))
    with pytest.raises(MemoryError, match="vl_convert"):
        picture({"mark": "point"}, "said", "p")
