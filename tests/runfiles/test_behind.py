"""What is lost to other engines: nothing that is no rival is named, families count once, and no metric is forgotten."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import pytest

from avatarsim.errors import UnknownName
from runfiles.behind import by_family, compared
from runfiles.metrics import FAMILIES, METRICS
from runfiles.ranked import RANKED, TIME, UNRANKED, ranked, why_not
from runfiles.sayable import Unsaid
from scenarios import catalog
from scenarios.cli.table import losing
from scenarios.results.results import Row


class Note(NamedTuple):
    """What one engine said of one scene."""

    scenario: str
    run: str
    cannot_say: Mapping[str, str]


OURS = "avatarsim/default"
GATED = frozenset({("avatarsim", "default")})


def row(run: str, metric: str, value: float | None, seed: int = 0, scene: str = "s") -> Row:
    engine, preset = run.split("/")
    return Row(scene, engine, preset, seed, 1, metric, value, "", None, None, "info", "")


def test_every_metric_ranks_or_says_why_not() -> None:
    for name in METRICS:
        assert (name in RANKED) != (name in UNRANKED), name
    for name in FAMILIES:
        assert name in UNRANKED, name
    assert all(" " in reason and not reason.endswith(".") for reason in UNRANKED.values())


def test_members_of_families_have_their_reason_and_strangers_none() -> None:
    assert ranked("stage_share_posture") is None and "time itself is ranked" in why_not("stage_share_posture")
    assert "units of its own" in why_not("pairs_per_frame")
    for stranger in ("nonsense", "residual_overlap_max"):
        with pytest.raises(UnknownName):
            why_not(stranger)


@pytest.mark.parametrize("metric", RANKED)
@pytest.mark.parametrize("share", [-0.5, 0.5, 1.5])
@pytest.mark.parametrize("mine", [0.7, None, math.nan])
def test_only_a_rival_that_is_better_by_more_than_counts_as_equal_is_ahead(metric: str, share: float, mine: float | None) -> None:
    """Theirs is better by a share of what counts as equal, beside a tracker and another preset that are better by far."""
    same = RANKED[metric].same or RANKED[metric].share * 0.7
    rows = [row(OURS, metric, mine), row("mujoco/tuned", metric, 0.7 - share * same),
            row("tracker/default", metric, 0.0), row("avatarsim/paper", metric, 0.0)]
    found = compared(rows, OURS).behind
    lacking = mine is None and RANKED[metric].may_lack
    expected = not lacking and (mine is None or math.isnan(mine) or share > 1.0)
    assert len(found) == expected == len(losing(rows, GATED, {}))
    assert all(run == "mujoco/tuned" for lost in found for run, _ in lost.rivals)


def test_one_bad_seed_is_a_loss_and_the_worst_one_is_told() -> None:
    rows = [row(run, "frame_time_p50", value, seed) for seed, times in enumerate(((2.0, 1.0), (9.0, 3.0), (5.0, 6.0)))
            for run, value in zip((OURS, "mujoco/tuned"), times, strict=True)]
    (found,) = compared(rows, OURS).behind
    assert (found.row.seed, found.factor) == (1, 3.0)


@pytest.mark.parametrize("metric", ["residual_overlap_max", "tracker_offset_max"])
def test_an_engine_that_left_the_room_is_passed_over_where_that_could_win(metric: str) -> None:
    rows = [row(OURS, metric, 1e-3), row("a/b", metric, 0.0), row("a/b", "wrong_side_frames", 4.0)]
    assert compared(rows, OURS).behind == ()
    (found,) = compared([*rows, row("c/d", metric, 1e-4)], OURS).behind
    assert found.rivals == (("c/d", 1e-4),)


@pytest.mark.parametrize(("ours", "lost"), [(1.0 + 0.9 * TIME, False), (1.0 + 1.1 * TIME, True)])
def test_times_within_a_tenth_are_level(ours: float, lost: bool) -> None:
    rows = [row(OURS, "frame_time_p50", 20.0 * ours), row("a/b", "frame_time_p50", 20.0)]
    assert bool(compared(rows, OURS).behind) is lost is bool(losing(rows, GATED, {}))


def test_variants_of_a_scene_count_once_and_the_worst_is_named() -> None:
    family = {"x_30": "x", "x_240": "x"}
    rows = [
        row(run, "root_jump_max", value, scene=scene)
        for scene, values in (("x", (0.1, 0.1)), ("x_30", (0.2, 0.1)), ("x_240", (0.4, 0.1)), ("y", (0.1, 0.3)))
        for run, value in zip((OURS, "mujoco/tuned"), values, strict=True)
    ]
    (found,) = by_family(compared(rows, OURS), family)
    assert found.said == "1 of 2 families"
    (lost,) = found.lost
    assert (lost.family, lost.worst.row.scenario, lost.scenes, lost.of) == ("x", "x_240", 2, 3)
    (said,) = losing(rows, GATED, family)
    assert said == "losing: root_jump_max in 1 of 2 families, worst x_240: 0.4 against 0.1  (mujoco/tuned)"


def test_where_theirs_is_zero_the_factor_is_infinite_and_the_order_stays_finite() -> None:
    (found,) = compared([row(OURS, "root_jump_max", 4e-3), row("a/b", "root_jump_max", 0.0)], OURS).behind
    assert math.isinf(found.factor) and found.severity == pytest.approx(400.0)


def test_every_scene_of_the_catalogue_has_a_family_that_one_of_its_scenes_explains() -> None:
    families = {name: scenario.family for name, scenario in catalog.scenarios().items()}
    assert all(families.values())
    for rate in ("coupling_sweep", "coupling_sweep_30", "coupling_sweep_240"):
        assert families[rate] == "coupling_sweep"
    assert {families[name] for name in families if name.startswith("mocap_")} == {"mocap"}
    assert families["hand_in_corner_rigid"] == families["hand_in_corner"] == "hand_in_corner"
    assert families["limit_torture_hinges"] == "limit_torture" and families["zeno"] == "zeno"


def test_an_engine_is_not_ranked_by_what_it_has_no_words_for() -> None:
    metric = "reach_cone_excess_max"
    rows = [row(OURS, metric, 4.0), row("a/b", metric, 1.0), row("c/d", metric, 3.0)]
    unsaid = Unsaid([Note("s", "a/b", {"reach cones": "ignored"})])
    (found,) = compared(rows, OURS, unsaid).behind
    assert found.rivals == (("c/d", 3.0),), "the best of those that can be judged"
    alone = compared(rows[:2], OURS, unsaid)
    assert alone.pairs == frozenset() and alone.behind == () and alone.silent == {"a/b": frozenset({("s", metric)})}
    assert len(compared(rows[:2], OURS).behind) == 1
    assert losing(rows[:2], GATED, {}, unsaid) == []


def test_a_world_of_another_size_counts_as_if_it_had_size_1() -> None:
    """Twice behind at size 1000 is twice behind; lengths go with the size, energies with its square, angles not at all."""
    for unit, metric, power in (("m", "root_jump_max", 1), ("J", "energy_added_max", 2), ("deg", "pose_jump_max", 0)):
        rows = [replace(row(run, metric, value * 1e3**power), unit=unit) for run, value in ((OURS, 0.4), ("a/b", 0.2))]
        (found,) = compared(rows, OURS, scales={"s": 1e3}).behind
        assert found.value == pytest.approx(0.4) and found.best == pytest.approx(0.2) and found.factor == pytest.approx(2.0)
    small = [replace(row(run, "root_jump_max", value), unit="m") for run, value in ((OURS, 8e-6), ("a/b", 1e-6))]
    assert compared(small, OURS).behind == () and len(compared(small, OURS, scales={"s": 1e-3}).behind) == 1


def test_the_largest_figure_is_named_though_another_has_the_largest_factor() -> None:
    rows = [row(run, "root_jump_max", value, scene=scene) for scene, values in (("x", (0.01, 0.0001)), ("y", (0.3, 0.1)))
            for run, value in zip((OURS, "a/b"), values, strict=True)]
    (found,) = by_family(compared(rows, OURS), {})
    assert found.lost[0].worst.row.scenario == "x"
    assert found.largest is not None and (found.largest.row.scenario, found.largest.value) == ("y", 0.3)


def test_time_in_an_adapter_ranks_nothing() -> None:
    rows = [row(OURS, "frame_time_python_p50", 9.0), row("a/b", "frame_time_python_p50", 1.0)]
    assert compared(rows, OURS).pairs == frozenset()
    assert "adapter" in why_not("frame_time_python_p50")
