"""Pages beside the index: what each preset lacks, and what that leaves out of comparison."""

import re

from reports.pages import articles
from reports.reading.load import EngineNote
from tests.reports.small_runs import MUJOCO, OVERLAP, figure, run_of

PRESETS = ("mujoco/default", MUJOCO)


def test_what_is_lacking_is_told_by_preset() -> None:
    rows = [figure("a", run, metric, 0.0) for run in PRESETS for metric in (OVERLAP, "apex_error_max")]
    notes = [EngineNote(run, "a", "1", {"restitution": "a note", "vertices": "another"}, {}) for run in PRESETS]
    run = run_of(rows, notes=notes)
    cells = re.findall(r"<td>(.*?)</td>", articles.articles(run)["engines.html"])
    bounce, vertices = cells.index("restitution"), cells.index("vertices")
    assert cells[bounce + 2] == "default" and cells[bounce + 4] == "a note"
    assert cells[vertices + 1 : vertices + 4] == ["", "default, tuned", ""]
    (why,) = set(run.rows.why) - {""}
    assert cells[cells.index(why) + 1] == "default 1"
