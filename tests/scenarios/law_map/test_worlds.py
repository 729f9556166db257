"""The scenes of the map: free at the start, bodies meet the floor alone, and what is asked is what is written."""

import numpy as np
import pytest

from avatarsim.errors import UnknownName
from reference.judging.judge import Judge
from scenarios.law_map import worlds
from scenarios.law_map.asking import job_of, obtained


@pytest.mark.parametrize("law", worlds.LAWS)
@pytest.mark.parametrize("shape", worlds.SHAPES)
def test_it_starts_free_at_the_height_that_is_stated(law: str, shape: str) -> None:
    scene = worlds.get(worlds.name_of(law, shape, 60)).build()
    places = np.array([body.position for body in scene.bodies])
    turns = np.array([body.orientation for body in scene.bodies])
    judge, touch = Judge(scene), worlds.solid_of(law, shape)[2]
    assert judge.overlaps(places, turns).deepest == 0.0
    # sunk to where they touch, and a little more, all overlap the floor by that little
    sunk = places.copy()
    sunk[1:, 2] = touch - 1e-4
    assert judge.overlaps(sunk, turns).deepest == pytest.approx(1e-4, rel=1e-3)
    sunk[1:, 2] = touch + 1e-6
    assert judge.overlaps(sunk, turns).deepest == 0.0


@pytest.mark.parametrize("law", worlds.LAWS)
def test_the_table_asks_what_the_names_say(law: str) -> None:
    scene = worlds.get(worlds.name_of(law, "sphere", 60)).build()
    for asked in worlds.ASKED[law]:
        found = scene.materials.contact("floor", scene.bodies[scene.names.index(worlds.body_name(asked, 0))].material)
        assert (found.restitution if law == "restitution" else found.friction) == asked


@pytest.mark.parametrize("name", ["restitution_sphere", "restitution_cone_60", "friction_sphere_61", "x"])
def test_unknown_scenes_are_refused(name: str) -> None:
    with pytest.raises(UnknownName):
        worlds.get(name)


@pytest.mark.parametrize("law", worlds.LAWS)
@pytest.mark.parametrize("shape", worlds.SHAPES)
def test_ours_gives_what_is_asked_whatever_the_shape(law: str, shape: str) -> None:
    rows = obtained(job_of(law, shape, 60, "avatarsim", "default"))
    assert [row.asked for row in rows] == list(worlds.ASKED[law])
    assert all(row.worst <= 1e-6 and row.note == "" for row in rows)


def test_the_known_faults_of_others_show() -> None:
    # no bounce at all, and a pyramid of friction that is 29 % weak across
    assert all(row.got < 0.06 for row in obtained(job_of("restitution", "sphere", 240, "mujoco", "default")))
    last = obtained(job_of("friction", "sphere", 240, "mujoco", "default"))[-1]
    assert last.low == pytest.approx(0.5**0.5, abs=1e-3) and last.high == pytest.approx(1.0, abs=1e-3)
    assert all(row.worst <= 1e-6 for row in obtained(job_of("friction", "sphere", 240, "mujoco", "tuned")))


def test_an_engine_that_nobody_has_gives_rows_without_figures() -> None:
    rows = obtained(job_of("friction", "sphere", 60, "abacus", "default"))
    assert len(rows) == len(worlds.ASKED["friction"]) and all("abacus" in row.note and row.got != row.got for row in rows)
