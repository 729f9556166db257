"""The paper's shares and Figure 7 beside ours: sums of stages, phases by the raw tracker."""

from collections.abc import Callable
from pathlib import Path

from reports import table_2
from reports.load import load
from reports.paper_figures import FIGURE_7, collision_share, figure_7, shares, shares_sentence
from tests.reports.conftest import row
from tests.reports.test_sections import two

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
    [panel] = figure_7(load(run_dir(results)))
    assert panel.scene == "avatarsim/default" and "in contact" in panel.conclusion and "200 timed frames" in panel.conclusion
    assert 'role="img"' in panel.svg


def test_pairs_against_collision_queries(tmp_path: Path) -> None:
    assert collision_share(table_2.Table2((), {})) == []
    [panel] = collision_share(two(tmp_path))
    assert "printed in the paper: too few scenes to say" in panel.conclusion
