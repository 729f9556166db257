"""Places on logarithmic axes, tooltips that are escaped, labels that stay clear of each other."""

import math

from reports.drawing.log_log import BOTTOM, HEIGHT, LEFT, RIGHT, TOP, WIDTH, LogLog, decades


def test_decades_are_evenly_spaced_and_what_is_outside_is_drawn_at_the_end() -> None:
    chart = LogLog((1.0, 100.0), (1e-6, 1e-2))
    left, middle, right = (chart.at(x, 1e-4)[0] for x in (1.0, 10.0, 100.0))
    assert left == LEFT and right == WIDTH - RIGHT and math.isclose(middle, (left + right) / 2)
    assert chart.at(1.0, 0.0)[1] == chart.at(1.0, 1e-6)[1] == HEIGHT - BOTTOM and chart.at(1.0, 5.0)[1] == TOP
    assert [round(math.log10(value)) for value in decades(1e-3, 1e2)] == [-3, -2, -1, 0, 1, 2]


def test_what_is_told_is_escaped() -> None:
    chart = LogLog((1.0, 100.0), (1e-6, 1e-2))
    chart.dot(10.0, 1e-4, "#000000", "<b>&", 3.0, True)
    chart.cross(10.0, 1e-4, "#000000", "</title><script>")
    chart.label(10.0, 1e-4, "<i>", "#000000")
    text = chart.svg('a "quoted" <picture>')
    assert "<title>&lt;b&gt;&amp;</title>" in text and "<script>" not in text and "&lt;i&gt;" in text
    assert 'aria-label="a &quot;quoted&quot; &lt;picture&gt;"' in text


def test_labels_keep_clear_of_curves_and_of_limits() -> None:
    chart = LogLog((1.0, 100.0), (1e-6, 1e-2))
    free = LogLog((1.0, 100.0), (1e-6, 1e-2))
    for one in (chart, free):
        one.dot(10.0, 1e-4, "#000000", "", 3.0, True)
    chart.line([(10.0, 1e-4), (100.0, 1e-4)], "#000000")
    for one in (chart, free):
        assert one.label(10.0, 1e-4, "a", "#000000")
    # on the right of the point runs the curve
    assert free.taken[-1][0] > free.at(10.0, 1e-4)[0] and chart.taken[-1] != free.taken[-1]
    limited = LogLog((1.0, 100.0), (1e-6, 1e-2))
    limited.x_limit(12.0, "60 Hz", "start")
    limited.dot(10.0, 1e-4, "#000000", "", 3.0, True)
    assert limited.label(10.0, 1e-4, "a long name", "#000000") and limited.taken[-1][2] <= limited.at(12.0, 1e-4)[0]


def test_a_label_that_has_no_room_is_left_out() -> None:
    chart = LogLog((1.0, 100.0), (1e-6, 1e-2))
    chart.dot(10.0, 1e-4, "#000000", "", 3.0, True)
    drawn = [chart.label(10.0, 1e-4, "a setting", "#000000") for _ in range(12)]
    assert drawn[0] and not drawn[-1] and chart.svg("").count("a setting") == sum(drawn) <= 8
    for k, one in enumerate(chart.taken):
        assert not any(one[0] < o[2] and o[0] < one[2] and one[1] < o[3] and o[1] < one[3] for o in chart.taken[:k])
