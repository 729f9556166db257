"""A picture's coordinates are rounded, what is written on it is not."""

from reports.picture import picture


def test_what_is_written_on_a_picture_keeps_its_digits() -> None:
    """"0.01 µs" rounded like a coordinate would be "0 µs"."""
    spec = {
        "$schema": "https://vega.github.io/schema/vega-lite/v6.json", "data": {"values": [{"a": 1.0 / 3.0}]},
        "mark": {"type": "text", "text": "0.012345 µs"}, "encoding": {"x": {"field": "a", "type": "quantitative"}},
    }
    svg = picture(spec, "said", "p")
    assert ">0.012345 µs<" in svg and 'aria-label="said"' in svg
    assert "0.333" not in svg
