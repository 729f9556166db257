"""The paper's shares and Figure 7 beside ours: sums of stages, phases by the raw tracker."""

from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports.reading.load import Results, load
from reports.sections import figure_7 as file_7
from reports.sections import table_2
from reports.sections.figure_7 import FIGURE_7, figure_7, from_series
from reports.sections.paper_figures import collision_share, shares, shares_sentence
from tests.reports.conftest import row
from tests.reports.sections.test_sections import two

Json = dict[str, object]
Write = Callable[[object], Path]


def test_stages_become_the_paper_s_shares(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    more = [row(FIGURE_7, "avatarsim/default", f"stage_share_{name}", share, "%") for name, share in
            (("posture", 55.0), ("motion", 33.0), ("coupling", 12.0))]
    found = shares(load(run_dir(results | {"rows": [*rows, *more]})))
    assert [(share.part, share.printed, share.ours) for share in found] == [
        ("overlap removal", 50.0, (55.0, None)), ("collisions with impulses", 25.0, (45.0, None)),
    ]
    assert "overlap removal 55 % (printed 50 %)" in shares_sentence(found)
    assert shares(load(run_dir(results))) == () and "No share" in shares_sentence(())


def test_figure_7_tells_idle_from_contact(run_dir: Write, results: Json) -> None:
    [panel] = figure_7(from_series(load(run_dir(results))))
    assert panel.scene == "avatarsim/default" and 'role="img"' in panel.svg
    assert panel.conclusion == "avatarsim/default: 31.0 µs while idle, 31.0 µs in contact, slowest 74.4 µs in frame 6 of 200."
    rows = results["rows"]
    assert isinstance(rows, list)
    noted = [one | {"note": "1 x 200 frames, 30 warm-up frames"} if one["metric"] == "frame_time_p50" else one for one in rows]
    [panel] = figure_7(from_series(load(run_dir(results | {"rows": noted}))))
    assert panel.conclusion.endswith("slowest 74.4 µs in frame 6 of 200 (each frame run once).")


def test_figure_7_from_its_own_file(tmp_path: Path) -> None:
    assert file_7.load(tmp_path) == ()
    points = "".join(f"avatarsim/default,{k},{20 if k > 50 else 10},{int(k > 50)}\n" for k in range(1, 101))
    (tmp_path / file_7.FILE).write_text("run,frame,us,contact\n" + points)
    [panel] = figure_7(file_7.load(tmp_path))
    assert panel.conclusion == "avatarsim/default: 10.0 µs while idle, 20.0 µs in contact, slowest 20.0 µs in frame 51 of 100."
    stages = "".join(f"avatarsim/default,{name},{share}\n" for name, share in (("posture", 60), ("motion", 30), ("coupling", 10)))
    (tmp_path / file_7.STAGES_FILE).write_text("run,stage,share\n" + stages)
    empty = Results((), {}, (), {}, 0, {}, ())
    assert [share.ours for share in shares(empty, file_7.load(tmp_path))] == [(60.0, None), (40.0, None)]
    (tmp_path / file_7.FILE).write_text("run,frame,us\na,1,2\n")
    with pytest.raises(InvalidFile, match="figure_7"):
        file_7.load(tmp_path)


def test_without_contact_it_says_what_to_run(run_dir: Write, results: Json) -> None:
    series = {FIGURE_7: {"avatarsim/default": {"overlap_m": [], "frame_time_us": [10.0] * 50}}}
    [panel] = figure_7(from_series(load(run_dir(results | {"series": series}))))
    assert panel.conclusion.endswith("No contact in these frames: `make bench` times all of the scene.")


def test_pairs_against_collision_queries(tmp_path: Path) -> None:
    assert collision_share(table_2.Table2((), {})) == []
    [panel] = collision_share(two(tmp_path))
    assert "printed in the paper: too few scenes to say" in panel.conclusion
