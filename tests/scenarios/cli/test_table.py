"""The table of `--verbose`."""

from runfiles.table import Row, Status
from scenarios.cli.table import table


def row(run: str, metric: str, value: float | None, status: Status = "info", bound: float | None = None, **more: object) -> Row:
    engine, preset = run.split("/")
    return Row("drop", engine, preset, 0, 90, metric, value, "", bound, None, status, **more)  # type: ignore[arg-type]


def test_table_has_figures_worst_status_and_broken_bounds() -> None:
    text = table([
        row("avatarsim/default", "residual_overlap_max", 2e-7, "pass", 1e-6), row("avatarsim/default", "still_frames", 2.0),
        row("mujoco/tuned", "residual_overlap_max", 3e-4, bound=1e-6),
        row("other/default", "run", None, "crashed", note="killed by signal 11"),
        row("last/default", "still_frames", 7.5, "fail", 1.0),
    ])
    lines = {line.split("/")[0].split()[-1]: line.split() for line in text.splitlines() if "/" in line}
    shown = {name: [word for word in words if word != "-"][-4:] for name, words in lines.items()}
    assert shown["avatarsim"] == ["0.0002", "2", "pass", "0"] and shown["mujoco"][-3:] == ["0.3", "info", "1"]
    named = [line for line in text.splitlines() if ": drop" in line]
    assert len(named) == 2 and "signal 11" in named[0] and "7.5" in named[1] and table([]) == "nothing was run"
