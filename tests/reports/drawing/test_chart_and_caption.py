"""At each worst moment of a scene's page the words, the caption of the replay and the charts have one figure, to three digits."""

import base64
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reports.replay.packed import unpacked
from reports.words.wording import quantity
from runfiles import array_file
from tests.reports.page.test_scene_page import held, page
from tests.reports.recorded import recording, scene

Json = dict[str, object]
Write = Callable[[object], Path]
NAME, OURS, THEIRS, STATES = "arm_wall", "avatarsim/default", "mujoco/default", 1300


@pytest.fixture
def folder(run_dir: Write, results: Json) -> Path:
    """A run of which a drawn state stands for three: both hands are aside for a state that is not drawn itself, theirs sinks."""
    sinking = [0.0] * STATES
    sinking[9], sinking[10] = 0.01, 0.02
    series = {run: {"overlap_m": overlap, "frame_time_us": []} for run, overlap in ((OURS, [0.0] * STATES), (THEIRS, sinking))}
    found = run_dir(results | {"series": {NAME: series}})
    scene(found, NAME)
    for run, aside in ((OURS, 0.4735), (THEIRS, 0.0371)):
        recording(found, NAME, run, states=STATES, sinks=run == THEIRS)
        path = found / "recordings" / f"{NAME}.{run.replace('/', '.')}.0.npz"
        arrays = array_file.read(path)
        arrays["positions"][1001, 2, 1] += aside
        with path.open("wb") as file:
            array_file.write(file, arrays)
    return found


def told(chart: Json, run: str, time: float, length: float) -> float:
    """The largest value of a line over the `length` [s] from a time on, as the page's script finds it."""
    (line,) = [line for line in chart["lines"] if line["run"] == run]  # type: ignore[attr-defined]
    values = unpacked(line["values"], (line["low"], line["high"]))
    begins = np.frombuffer(base64.b64decode(line["times"]), dtype="<f4")
    ends = np.append(begins[1:], np.inf)
    most = float(values[(begins < time + length - 1e-4) & (ends > time + 1e-4)].max())
    return 10.0**most if chart["log"] else most


def test_words_captions_and_charts_agree_at_every_worst_moment(folder: Path) -> None:
    text = page(folder, NAME)[0]
    replayed, charts = held(text, "replay-data"), held(text, "courses-data")["scenes"][NAME]  # type: ignore[index]
    by_key = {chart["key"]: chart for chart in charts}
    asked = []
    for run in replayed["runs"]:  # type: ignore[attr-defined]
        for moment in run["worst"]:
            figure = re.search(r"overlap of (\S+ \S+)|(\S+ \S+) from its user", moment["said"])
            if not figure:
                continue
            key = "overlap" if figure[1] else "offset"
            time, length = moment["state"] * replayed["dt"], replayed["dt"]
            assert quantity(told(by_key[key], run["run"], time, length), "m") == (figure[1] or figure[2]), moment["said"]
            caption = run["pairs"][moment["state"]][0][2] / 1e3 if figure[1] else None
            assert caption is None or quantity(caption, "m") == figure[1]
            asked.append((run["run"], key))
    overlap = by_key["overlap"]
    for state, pairs in enumerate(next(run["pairs"] for run in replayed["runs"] if run["run"] == THEIRS)):  # type: ignore[attr-defined]
        shown = told(overlap, THEIRS, state * replayed["dt"], replayed["dt"])  # type: ignore[operator]
        assert shown == pytest.approx(pairs[0][2] / 1e3 if pairs else overlap["low"], rel=1e-3), "in every other state too"
    assert replayed["stride"] == 3 and asked == [(OURS, "offset"), (THEIRS, "overlap"), (THEIRS, "offset")]
