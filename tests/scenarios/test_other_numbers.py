"""The small world with other positions and scales, and starts that overlap."""

import numpy as np
import pytest

from avatarsim.errors import StartOverlaps
from avatarsim.model.world import build
from avatarsim.pose_queries import require_free
from scenarios import catalog
from scenarios.catalog.hard.other_numbers import FACE, SHOT, TALL, Place, dropped, shot, slides
from scenarios.measure.side import outside

TIMES = np.linspace(0.0, 2.0, 41)
PLACES = {"scale_mm": Place(1e-3), "scale_km": Place(1e3), "far_from_origin": Place(1.0, (6e4, -8e4, 1e3))}


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
@pytest.mark.parametrize("course", [dropped, slides, shot])
def test_a_course_is_the_same_in_other_numbers(course: object, place: Place) -> None:
    assert callable(course)
    plain = np.array([course(Place(), t) for t in TIMES])
    there = (np.array([course(place, t) for t in TIMES]) - place.origin) / place.scale
    # a body placed 2e-8 m above another has this gap at every scale
    assert np.abs(there - plain).max() < 2.1e-8 / min(1.0, place.scale) + 1e-10


def test_coincident_bodies_are_refused_with_exact_depths() -> None:
    """A ball in a ball has depth r1 + r2; the others have the smallest exit distance of A - B, known for each."""
    refused = []
    for _ in range(2):
        with pytest.raises(StartOverlaps) as error:
            require_free(build(catalog.get("coincident_start").build()))
        refused.append(error.value.pairs)
    depths = {a.removesuffix("_one"): depth for a, _, depth in refused[0]}
    assert depths == pytest.approx({"sphere": 0.2, "capsule": 0.2, "box": 0.2, "hull": 0.2, "ellipsoid": 0.16}, abs=1e-9)
    assert refused[0] == refused[1]


@pytest.mark.parametrize(("name", "place"), [("dt_torture", Place()), *PLACES.items()])
def test_ball_lost_in_the_wall_is_on_the_wrong_side(name: str, place: Place) -> None:
    scenario = catalog.get(name)
    scene = scenario.build()
    positions = np.tile(np.array([body.position for body in scene.bodies]), (3, 1, 1))
    ball = scene.names.index("shot")
    for row, past in enumerate((-SHOT, 0.3 * TALL, 0.6 * TALL)):
        positions[row, ball] = place.at(FACE + past, 0.0, 2.0)
    assert outside(positions, scenario.regions, scene.names).tolist() == [False, False, True]
