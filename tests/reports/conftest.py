"""A small run made by hand: three scenes, four engines, and one case of each fault."""

import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

Json = dict[str, object]


def row(scenario: str, run: str, metric: str, value: float | None, unit: str = "", **more: object) -> Json:
    """Return one row of results.json; the default status is info."""
    engine, preset = run.split("/")
    plain: Json = {"seed": 0, "frames": 200, "bound": None, "ceiling": None, "status": "info", "note": ""}
    named: Json = {"scenario": scenario, "engine": engine, "preset": preset, "metric": metric, "value": value, "unit": unit}
    return plain | named | more


def whole_run() -> Json:
    """Return results.json of a run in which one bound passes, one fails, one engine crashes and one frame is NaN."""
    rows: list[Json] = []
    series: dict[str, dict[str, Json]] = {}
    sizes = {"avatarsim/default": 3e-7, "mujoco/default": 4e-3, "mujoco/tuned": 6e-5, "pybullet/default": 1e-5}
    sizes["tracker/default"] = 0.1
    speeds = {"avatarsim/default": 31.0, "mujoco/default": 190.0, "mujoco/tuned": 420.0, "pybullet/default": 880.0}
    for scene, scale in (("arm_wall", 1.0), ("hand_over_table", 9.0)):
        for run, size in sizes.items():
            gate: Json = {}
            if run == "avatarsim/default":
                young = scene == "hand_over_table"
                gate = {"bound": 1e-6, "ceiling": 1e-3 if young else None, "status": "info" if young else "pass"}
            rows.append(row(scene, run, "residual_overlap_max", size * scale, "m", **gate))
            rows.append(row(scene, run, "overlap_frames", min(100.0, 1e4 * size), "%"))
            rows.append(row(scene, run, "tracker_offset_rms_free", 0.0 if run[0] == "t" else 2e-3 + size, "m"))
            overlap = [size * scale * abs(math.sin(k / 25.0)) for k in range(200)]
            series.setdefault(scene, {})[run] = {"overlap_m": overlap, "frame_time_us": []}
            if run in speeds:
                for name, factor in (("p50", 1.0), ("p95", 1.6), ("p99", 2.4)):
                    rows.append(row(scene, run, f"frame_time_{name}", factor * speeds[run], "us"))
                times = [speeds[run] * (1.0 + 1.4 * (k % 37 == 5)) for k in range(200)]
                series[scene][run]["frame_time_us"] = times
    broken: Json = {"bound": 0.01, "status": "fail", "note": "pair wood-metal"}
    rows.append(row("ball_drop", "avatarsim/default", "restitution_error_max", 0.3, "", **broken))
    rows.append(row("ball_drop", "pybullet/default", "restitution_error_max", 0.02))
    rows.append(row("ball_drop", "mujoco/default", "run", None, status="crashed", note="ValueError: <mesh> & volume"))
    rows.append(row("ball_drop", "mujoco/tuned", "residual_overlap_max", None, "m", status="not-measured", note="not installed"))
    engines = [
        {
            "name": "mujoco", "version": "3.17.0", "preset": "default", "scenario": scene,
            "unsupported": {"restitution": "no coefficient: bounces follow solref"},
            "settings": {"timestep": [1 / 240, "quarter of a frame"], "cone": "elliptic", "solref": [0.02, 1.0 + 0.1 * index]},
        }
        for index, scene in enumerate(("arm_wall", "hand_over_table"))
    ]
    return {
        "schema_version": 1, "exit_code": 1, "rows": rows, "engines": engines, "series": series,
        "provenance": {"cpu": "Abacus 9", "python": "3.11", "versions": {"numpy": "2.3"}, "command": "run", "seconds": 12.5},
    }


@pytest.fixture
def results() -> Json:
    """Return results.json as a dictionary that a test may change before writing it."""
    return whole_run()


@pytest.fixture
def run_dir(tmp_path: Path) -> Callable[[object], Path]:
    """Return a function that writes a results.json (anything json can write, NaN included) and returns its folder."""
    numbers = iter(range(9))

    def write(data: object) -> Path:
        folder = tmp_path / f"run{next(numbers)}"
        folder.mkdir()
        (folder / "results.json").write_text(json.dumps(data), encoding="utf-8")
        return folder

    return write
