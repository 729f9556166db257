"""Grippers: sliding fingers stop at the bodies they close on, open again, and leave the arm where its user has it."""

from pathlib import Path

import numpy as np
import pytest

import avatarsim as av
from avatarsim.errors import InvalidScene
from avatarsim.scene.joint import LONGEST_SLIDE
from tests.assets.motions.robots import Driven, driven

WIDTH, OPEN, MARGIN = 0.03, 0.04, 1e-3
"""[m] width of the box between the fingers, way of an open finger, and gap that a Shield keeps by default."""

ARM = """<mujoco><compiler angle="radian"/><worldbody><body name="upper" pos="0 0 1"><joint name="shoulder" axis="0 1 0"
range="-2 2"/><joint name="swing" axis="0 0 1" range="-2 2"/><geom type="capsule" fromto="0.05 0 0 0.25 0 0" size="0.03"/>
<body name="lower" pos="0.3 0 0"><joint name="elbow" axis="0 1 0" range="-2 2"/><geom type="capsule" fromto="0.05 0 0 0.2 0 0"
size="0.03"/><body name="hand" pos="0.25 0 0"><joint name="wrist" axis="0 0 1" range="-2 2"/>
<geom type="box" size="0.02 0.06 0.02" pos="0.02 0 0"/>
<body name="left" pos="0.08 0 0"><joint name="left" type="slide" axis="0 1 0" range="0 0.04"/>
<geom type="box" size="0.03 0.005 0.01" pos="0 0.006 0"/></body>
<body name="right" pos="0.08 0 0"><joint name="right" type="slide" axis="0 -1 0" range="0 0.04"/>
<geom type="box" size="0.03 0.005 0.01" pos="0 -0.006 0"/></body>
</body></body></body></worldbody></mujoco>"""

CLOSES = np.concatenate([np.linspace(OPEN, 0.0, 40), np.zeros(30), np.linspace(0.0, OPEN, 30)])


def loaded(folder: Path, text: str = ARM) -> Driven:
    """Return the model of a text; by default an arm of four hinges with two fingers, straight along x, 2 mm apart when closed."""
    path = folder / "model.xml"
    path.write_text(text, encoding="utf-8")
    return driven(av.load_avatar(path))


def box(aside: float = 0.0) -> av.Body:
    """Return a box between the fingers, or aside [m] of their middle."""
    return av.fixed("box", (av.Piece(av.Box((0.02, WIDTH, 0.02))),), "wood", (0.63, aside, 1.0))


@pytest.mark.parametrize("aside", [0.0, 0.004])
def test_fingers_close_on_a_box_and_open_again_and_the_arm_stays(aside: float, tmp_path: Path) -> None:
    shield, shown = av.Shield(loaded(tmp_path), (box(aside),)), []
    for way in CLOSES:
        q = np.zeros(6)
        q[4:] = way
        shown.append(shield(q))
    rows = np.array(shown)
    # a finger's face is 1 mm off the middle when closed
    for column, side in ((4, 1.0), (5, -1.0)):
        at_the_box = 0.5 * WIDTH + side * aside - 1e-3
        assert at_the_box < rows[65, column] < at_the_box + 2.0 * MARGIN
    assert np.abs(rows[:, :4]).max() < 1e-3
    np.testing.assert_allclose(rows[-1], [0.0] * 4 + [OPEN] * 2, atol=1e-9)


def test_an_arm_follows_its_user_though_its_fingers_are_light(tmp_path: Path) -> None:
    wall = av.fixed("wall", (av.Piece(av.Box((1.0, 0.1, 1.0))),), "wood", (0.5, 0.35, 1.0))
    shield = av.Shield(loaded(tmp_path), (wall,))
    for share in np.linspace(0.0, 1.0, 60):
        shown = shield(np.array([0.0, share, 0.0, 0.0, OPEN, OPEN]))
    # the wall holds the hand, and the fingers do not keep the arm from coming to it
    assert 0.2 < shown[1] < 0.7 and not shield.is_free


def test_a_clip_that_goes_through_a_box_is_cleaned_in_metres(tmp_path: Path) -> None:
    model = loaded(tmp_path)
    q = np.zeros((len(CLOSES), 6))
    q[:, 4:] = CLOSES[:, None]
    q[50, 4] = -0.01
    cleaned = av.clean(model.coordinates.motion(q, np.arange(len(q)) / 60.0), model, (box(),))
    assert cleaned.after.is_clean and cleaned.after.slide_excess == 0.0 and cleaned.before.slide_excess == pytest.approx(0.01)
    assert cleaned.before.limit_excess == 0.0
    assert cleaned.moved.slides == ("left", "right") and len(cleaned.moved.joints) == 4
    assert (cleaned.moved.slide_p95 > 0.01).all() and (cleaned.moved.slide_p95 < 0.02).all()


def test_a_base_drives_far_and_turns_where_it_is(tmp_path: Path) -> None:
    model = loaded(
        tmp_path, '<mujoco><worldbody><body name="base" pos="0 0 0.2"><joint name="x" type="slide" axis="1 0 0"/>'
        '<joint name="y" type="slide" axis="0 1 0"/><joint name="heading" axis="0 0 1"/><geom type="box" size="0.2 0.15 0.1"/>'
        "</body></worldbody></mujoco>",
    )
    post = av.fixed("post", (av.Piece(av.Capsule(0.1, 1.0)),), "wood", (1.0, 0.0, 0.5))
    shield, previous = av.Shield(model, (post,)), np.zeros(3)
    for k in range(1, 240):
        shown = shield(np.array([0.02 * k, 0.05 * np.sin(0.1 * k), 0.01 * k]))
        assert np.abs(shown - previous).max() < 1.0
        previous = shown
    assert np.hypot(shown[0] - 1.0, shown[1]) > 0.2 and abs(shown[0]) < LONGEST_SLIDE


GEARED = ARM.replace("</worldbody>", '</worldbody><equality><joint joint1="right" joint2="left"/></equality>')
"""The same with the right finger following the left one."""


@pytest.mark.parametrize("aside", [0.0, 0.004])
def test_coupled_fingers_never_come_apart(aside: float, tmp_path: Path) -> None:
    shield, shown = av.Shield(loaded(tmp_path, GEARED), (box(aside),)), []
    for k, way in enumerate(CLOSES):
        q = np.array([0.0, 0.3 * np.sin(0.1 * k) * (k > 60), 0.0, 0.0, way, way])
        shown.append(shield(q))
    rows = np.array(shown)
    assert (rows[:, 4] == rows[:, 5]).all()
    # both stop where the nearer one does
    at_the_box = 0.5 * WIDTH + aside - 1e-3
    assert at_the_box < rows[59, 4] < at_the_box + 2.0 * MARGIN
    np.testing.assert_allclose(rows[-1, 4:], OPEN, atol=1e-9)


def test_a_wild_operator_keeps_a_chain_of_couplings(tmp_path: Path) -> None:
    """Gears of two and ten to one, hinge to slide, whose followers come before their leaders, between a wall and itself."""
    coupled = (
        '<equality><joint joint1="shoulder" joint2="elbow" polycoef="0 -1 0 0 0"/>'
        '<joint joint1="left" joint2="wrist" polycoef="0.02 0.01 0 0 0"/><joint joint1="right" joint2="left"/></equality>'
    )
    model = loaded(tmp_path, ARM.replace("</worldbody>", f"</worldbody>{coupled}"))
    walls = tuple(
        av.fixed(f"wall {side}", (av.Piece(av.Box((1.5, 0.1, 1.5))),), "wood", (0.4, side * 0.4, 1.0)) for side in (-1, 1)
    )
    shield, rng = av.Shield(model, walls), np.random.default_rng(4)
    q, held = np.array([0.0, 0.0, 0.0, 0.0, 0.02, 0.02]), 0
    for k in range(200):
        if k % 20 == 0:
            goal = rng.uniform(-1.5, 1.5, 4)
        q[:4] += 0.08 * (goal - q[:4])
        row = shield(np.array([-q[2], q[1], q[2], q[3], 0.02 + 0.01 * q[3], 0.02 + 0.01 * q[3]]))
        held += not shield.is_free
        assert row[2] == -row[0] and row[4] == row[5] and abs(row[4] - 0.02 - 0.01 * row[3]) <= 1e-15
        assert 0.0 <= row[4] <= 0.04 and np.abs(row[:4]).max() <= 2.0
    assert held > 20


def test_what_comes_apart_in_a_clip_is_cleaned(tmp_path: Path) -> None:
    model = loaded(tmp_path, GEARED)
    q = np.zeros((60, 6))
    q[:, 4] = 0.02
    q[:, 5] = 0.02 + 0.005 * np.sin(np.linspace(0.0, 6.0, 60))
    cleaned = av.clean(model.coordinates.motion(q, np.arange(60) / 60.0), model)
    rows = model.coordinates.rows(cleaned.motion)
    assert np.abs(rows[:, 5] - rows[:, 4]).max() <= 1e-12 and cleaned.before.slide_excess > 0.004
    assert cleaned.after.is_clean


def test_the_printed_method_refuses_slides(tmp_path: Path) -> None:
    with av.AvatarsimEngine() as engine, pytest.raises(InvalidScene, match="Slide"):
        engine.load(loaded(tmp_path).scene(), av.Settings("paper"), dt=1 / 60)
