"""Columns to joints: by name if the file has names, else by their number; mismatches are named."""

import pytest

from avatarsim.assets.models.coordinates import Coordinates, Slot
from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.matching import Layout, columns, coordinates_of_model
from avatarsim.errors import InvalidFile
from tests.assets.motions.robots import JOINTS, puppet, robot


def of(model: Model) -> Coordinates:
    return model.coordinates


def test_without_names_the_order_is_the_models() -> None:
    assert columns("a", Layout(None, "wxyz"), 11, of(robot())).tolist() == list(range(11))
    assert columns("a", Layout(None, "xyzw"), 11, of(robot())).tolist() == [0, 1, 2, 6, 3, 4, 5, 7, 8, 9, 10]
    assert columns("a", Layout(None, "xyzw"), 13, of(puppet())).tolist() == [0, 1, 2, 6, 3, 4, 5, 10, 7, 8, 9, 11, 12]


def test_a_ball_has_four_columns() -> None:
    layout = Layout(("hand.1", "head", "hand.0"), "wxyz")
    assert columns("a", layout, 13, of(puppet())).tolist() == [*range(7), *range(8, 12), 12, 7]


def test_a_fixed_robot_has_joints_alone() -> None:
    assert columns("a", Layout(JOINTS, "wxyz", rooted=False), 4, of(robot(free=False))).tolist() == [0, 1, 2, 3]
    with pytest.raises(InvalidFile, match="root of a.*free root"):
        columns("a", Layout(JOINTS, "wxyz"), 11, of(robot(free=False)))


@pytest.mark.parametrize(("layout", "width", "says"), [
    (Layout(None, "wxyz"), 12, r"names no joints.*12.*11: floating_base \(7\), waist"),
    (Layout(("waist", "left_shoulder", "tail"), "wxyz"), 10, "missing: right_shoulder, left_elbow; not the avatar's: tail"),
    (Layout(JOINTS, "wxyz"), 12, "columns of a is 12; valid: 11"),
    (Layout((*JOINTS, "waist"), "wxyz"), 12, "joint of a is 'waist'.*once"),
])
def test_what_does_not_fit_is_named(layout: Layout, width: int, says: str) -> None:
    with pytest.raises(InvalidFile, match=says):
        columns("a", layout, width, of(robot()))


def test_a_body_without_joints_is_driven_by_no_robots_motion() -> None:
    cube = Coordinates((Slot("cube", "free", 0),), 1, 0)
    with pytest.raises(InvalidFile, match="joints of a is '?waist, .*at least one of the avatar's: cube"):
        columns("a", Layout(JOINTS, "wxyz"), 11, cube)
    assert columns("a", Layout(("cube",), "wxyz"), 7, cube).tolist() == [*range(7)]
    assert columns("a", Layout((), "wxyz"), 7, cube).tolist() == [*range(7)]


def test_a_room_has_no_joints() -> None:
    with pytest.raises(InvalidFile, match=r"avatar for a\.csv"):
        coordinates_of_model("a.csv", Model(None, None, (), ()))
