"""The scenes of the map: free at the start, bodies meet only the floor, and the requested coefficients are those written."""

import math
from pathlib import Path

import pytest

from avatarsim.errors import UnknownName
from reference.judging.judge import Judge
from scenarios.job import Job
from scenarios.studies.contact_law import worlds
from scenarios.studies.contact_law.ask import STUDY, obtained, summed_up
from scenarios.studies.study import Request
from tests.scenarios.scene_rules import first_poses


@pytest.mark.parametrize("law", worlds.LAWS)
@pytest.mark.parametrize("shape", worlds.SHAPES)
def test_it_starts_free_at_the_height_that_is_stated(law: str, shape: str) -> None:
    scene = worlds.get(worlds.name_of(law, shape, 60)).build()
    places, turns = first_poses(scene)
    judge, touch = Judge(scene), worlds.solid_of(law, shape)[2]
    assert judge.overlaps(places, turns).deepest == 0.0
    # lowered to contact and a little more, all overlap the floor by that little
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


def values(law: str, shape: str, rate: int, engine: str, preset: str) -> dict[str, list[float]]:
    options = {} if engine == "avatarsim" else {"dt": 1.0 / rate}
    job = Job(worlds.name_of(law, shape, rate), engine, preset, base=preset, options=options, catalogue=worlds.__name__)
    found: dict[str, list[float]] = obtained(job)["values"]
    return found


@pytest.mark.parametrize("law", worlds.LAWS)
@pytest.mark.parametrize("shape", worlds.SHAPES)
def test_ours_gives_the_stated_coefficient_for_every_shape(law: str, shape: str) -> None:
    found = values(law, shape, 60, "avatarsim", "default")
    assert list(map(float, found)) == list(worlds.ASKED[law])
    assert all(value == pytest.approx(float(stated), abs=1e-6) for stated, each in found.items() for value in each)


def test_the_known_faults_of_others_show() -> None:
    # no bounce at all, and a friction pyramid that is 29 % too weak across
    assert all(max(each) < 0.06 for each in values("restitution", "sphere", 240, "mujoco", "default").values())
    last = values("friction", "sphere", 240, "mujoco", "default")["1"]
    assert min(last) == pytest.approx(0.5**0.5, abs=1e-3) and max(last) == pytest.approx(1.0, abs=1e-3)
    tuned = values("friction", "sphere", 240, "mujoco", "tuned")
    assert all(value == pytest.approx(float(stated), abs=1e-6) for stated, each in tuned.items() for value in each)


def test_figures_are_summed_up_and_missing_ones_counted() -> None:
    assert summed_up([0.3, 0.1, 0.2]) == (0.2, 0.1, 0.3, "") and summed_up([0.1, 0.3])[0] == pytest.approx(0.2)
    middle, low, high, note = summed_up([math.nan, 0.5])
    assert (middle, low, high) == (0.5, 0.5, 0.5) and note and summed_up([math.nan])[:3] == (None, None, None)


def test_rows_of_a_comparison(tmp_path: Path) -> None:
    rows, _ = STUDY.carry_out(Request(tmp_path, {}, {"avatarsim": ("default", "paper"), "abacus": ("default",)}, 0))
    assert {row.preset for row in rows if row.engine == "avatarsim"} == {"default"}, "its methods share one law"
    assert {row.status for row in rows if row.engine == "abacus"} == {"crashed"}
    [one] = [row for row in rows if (row.scenario, row.change, row.metric) == ("friction_sphere", "1/240 s", "obtained_0.5_low")
             and row.engine == "avatarsim"]
    assert one.value == pytest.approx(0.5, abs=1e-6) and (tmp_path / "contact_law.csv").exists()
