"""Rows of the table are the shapes, and the one row more says where the last one ends."""

from avatarsim.model.geometry import ELLIPSOID, POINTS, Shapes, make_shapes


def test_fields_are_as_given_and_the_last_row_is_a_start_only():
    shapes = make_shapes([POINTS, ELLIPSOID], [0, 8, 12], [0.1, 0.0], [1.0, 2.0])
    assert isinstance(shapes, Shapes) and len(shapes) == 3
    assert shapes.start.tolist() == [0, 8, 12] and shapes.kind[:2].tolist() == [POINTS, ELLIPSOID]
    assert shapes[0].radius == 0.1 and shapes[1].extent == 2.0 and shapes[2].extent == 0.0
