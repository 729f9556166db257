"""A run of scenes that a user brings: which setting of which engine leaves less than a millimetre for the least time there.

The settings, their errors and their times are those of the run's own sweep: a work-precision comparison (Hairer, Norsett and
Wanner, Solving Ordinary Differential Equations I, section II.10) of one scene.
"""

from reports.deciding.alike import Basis
from reports.reading.load import Results
from reports.sections.sweep.attempts import Attempt
from reports.sections.sweep.cheapest import Block, table
from reports.sections.sweep.points import Sweep
from reports.words.wording import limit, quantity
from runfiles.accuracy import LEVELS
from runfiles.naming import OWN_PREFIX

LEVEL = 1e-3
"""[m] what is left at most: less than a millimetre is hardly seen in a rendered scene."""
TIMES = {
    Basis.MEDIAN: "median of all frames", Basis.MOVING: "median of frames in motion",
    Basis.TAIL: "95th percentile, as the median frame rests", Basis.SLOWEST: "slowest frame, as all others rest",
}
"""Which time of a frame is meant, in few words."""

STANDS_ALONE = (
    "These are scenes from files: every engine is built from them by the adapters that build the catalogue's scenes. Sections "
    "that need the catalogue are left out."
)
"""What is said once in place of every section that such a run has not."""


def are_own(results: Results) -> bool:
    """Whether the run is of scenes that a user brings, and of no others."""
    scenes = results.scenes()
    return bool(scenes) and all(scene.startswith(OWN_PREFIX) for scene in scenes)


def least(results: Results, sweep: Sweep | None) -> tuple[str, ...]:
    """A sentence for each own scene of the run: the cheapest setting of all engines at LEVEL; none for a run of other scenes."""
    if not are_own(results):
        return ()
    blocks = {block.scenario: block for block in table(sweep).blocks} if sweep else {}
    return tuple(_said(blocks[scene]) if scene in blocks else
                 f"{scene}: no setting was both measured and timed, so none is named for {limit(LEVEL, 'm')}."
                 for scene in results.scenes())


def _said(block: Block) -> str:
    """The fastest setting that reaches LEVEL, and the fastest of each other engine, or how near it comes."""
    level = LEVELS.index(LEVEL)
    reached = {line.engine: cell.attempt for line in block.lines if (cell := line.cells[level]).attempt is not None}
    missed = [f"{line.engine} {line.at_best} (measured: {line.of})" for line in block.lines if line.engine not in reached]
    order = sorted(reached.values(), key=lambda attempt: attempt.time)
    if not order:
        return f"{block.scenario}: no setting of any engine leaves at most {limit(LEVEL, 'm')}: {'; '.join(missed)}."
    said = f"{block.scenario}: at most {limit(LEVEL, 'm')} is left for the least time by {_one(order[0])}"
    others = [*map(_one, order[1:]), *missed]
    beside = "; our avatar is kinematic and theirs have dynamics, so times stand side by side" if block.avatar else ""
    return f"{said}{'; then ' if others else ''}{'; '.join(others)}. Time: {TIMES[block.basis]}{beside}."


def _one(attempt: Attempt) -> str:
    return f"{attempt.any_point.run} ({quantity(attempt.time, 'us')} a frame, leaves {quantity(attempt.error, 'm')})"
