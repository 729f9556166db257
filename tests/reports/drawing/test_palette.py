"""Every run can be told from every other, and every chart colour has a dark partner."""

from reports.drawing.palette import dark_rules, strokes


def test_runs_differ_in_colour_or_dash() -> None:
    engines = ("avatarsim", "mujoco", "pybullet", "one", "two")
    presets = ("tuned", "default", "sleeping", "servos", "hinges", "mine", "fine", "finer", "finest")
    runs = [f"{engine}/{preset}" for engine in engines for preset in presets]
    drawn = strokes(runs)
    assert list(drawn) == runs
    assert len({(stroke.light, stroke.dash) for stroke in drawn.values()}) == len(runs)
    assert drawn["mujoco/default"].dash == (1, 0) and drawn["mujoco/default"].light == drawn["mujoco/tuned"].light


def test_every_colour_turns_dark() -> None:
    rules = dark_rules()
    for stroke in strokes(["avatarsim/default", "other/default"]).values():
        assert f'[stroke="{stroke.light}"]{{stroke:light-dark({stroke.light},{stroke.dark})}}' in rules
