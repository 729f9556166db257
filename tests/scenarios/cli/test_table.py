"""The table of `--verbose`: its rows, and what failed."""

from dataclasses import replace

from runfiles.table import Row, Status
from scenarios.cli.table import WIDTH, figure, table

OURS = frozenset({("avatarsim", "default")})


def row(
    run: str, metric: str, value: float | None, status: Status = "info", bound: float | None = None, *,
    seed: int = 0, note: str = "", ceiling: float | None = None,
) -> Row:
    engine, preset = run.split("/")
    return Row("drop", engine, preset, seed, 90, metric, value, "", bound, ceiling, status, note)


def test_a_row_per_run_with_the_raw_trackers_overlap_beside() -> None:
    text = table([
        row("avatarsim/default", "residual_overlap_max", 2e-7, "pass", 1e-6),
        row("mujoco/tuned", "residual_overlap_max", 3e-4, bound=1e-6),
        row("tracker/default", "residual_overlap_max", 0.185, bound=1e-6),
    ], OURS).splitlines()
    assert text[0].split()[:3] == ["scene", "engine/preset", "overlap"]
    assert text[3].split() == ["drop", "avatarsim/default", "0.0002", "-", "185", *"-------", "PASS"]
    assert text[4].split() == ["mujoco/tuned", "0.3", "-", "185", *"-------", "(breaks", "1)"]
    assert not any(line.startswith("fail") for line in text)


def test_what_fails_is_named_with_its_limit_and_shown_as_failed() -> None:
    text = table([row("avatarsim/default", "still_frames", 7.5, "fail", 1.0, note="above 1")], OURS)
    assert "FAIL (1)" in text and "fail: drop avatarsim/default still_frames 7.5 (limit 1) above 1" in text


def test_a_waived_check_is_no_plain_pass_and_is_named() -> None:
    text = table([row("avatarsim/default", "residual_overlap_max", 4e-4, "waived", 1e-6, ceiling=1e-3)], OURS)
    assert "PASS (1 waived)" in text and "waived: drop avatarsim/default residual_overlap_max 0.0004 (limit 0.001)" in text


def test_crashed_missing_and_wordless_runs_say_so() -> None:
    text = table([
        row("mujoco/default", "run", None, "crashed", note="killed by signal 11"),
        row("pybullet/default", "run", None, "not-measured", note="x" * 300),
        row("other/default", "run", None, "cannot-say"),
    ], OURS)
    assert "crashed: drop mujoco/default run killed by signal 11" in text
    assert "not measured" in text and "cannot say" in text and max(map(len, text.splitlines())) <= WIDTH


def test_seeds_are_told_apart() -> None:
    text = table([row("avatarsim/default", "still_frames", 0.0, "pass", 1.0, seed=s) for s in (1, 2)], OURS)
    assert "drop#1" in text and "drop#2" in text


def test_a_scene_whose_one_seed_is_its_own_goes_by_its_name() -> None:
    other = replace(row("avatarsim/default", "still_frames", 0.0, "pass", 1.0, seed=77), scenario="elsewhere")
    text = table([row("avatarsim/default", "still_frames", 0.0, "pass", 1.0), other], OURS)
    assert "#" not in text and "elsewhere  " in text


def test_figures_have_three_digits() -> None:
    assert [figure(v) for v in (None, float("nan"), float("inf"), 0.0, 1.23456e-7, 12.345, 123456.0)] == [
        "-", "NaN", "inf", "0", "1.23e-07", "12.3", "123456",
    ]
