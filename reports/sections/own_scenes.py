"""A run of scenes that a user brings: which setting of which engine leaves less than a millimetre for the least time there.

The settings, their errors and their times are those of the run's own sweep: a work-precision comparison (Hairer, Norsett and
Wanner, Solving Ordinary Differential Equations I, section II.10) of one scene.
"""

from collections.abc import Sequence

from reports.reading.load import Results
from reports.sections.sweep.cheapest import Attempt, Block, table
from reports.sections.sweep.points import Sweep
from reports.words.wording import limit, quantity
from runfiles.accuracy import LEVELS
from runfiles.naming import OWN_PREFIX

LEVEL = 1e-3
"""[m] what is left at most: less than a millimetre is hardly seen in a rendered scene."""

STANDS_ALONE = (
    "These are scenes from files: every engine is built from them by the adapters that build the catalogue's scenes. Sections that "
    "need the catalogue are left out."
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
    missed = [f"{line.engine} {line.at_best} ({line.of} settings measured)" for line in block.lines if line.engine not in reached]
    order = sorted(reached.values(), key=lambda attempt: attempt.time)
    if not order:
        return f"{block.scenario}: no setting of any engine leaves less than {limit(LEVEL, 'm')}: {'; '.join(missed)}."
    said = f"{block.scenario}: less than {limit(LEVEL, 'm')} is left for the least time by {_one(order[0])}"
    others = [*_each(order[1:]), *missed]
    beside = "; our avatar is kinematic and theirs have dynamics, so times stand side by side" if block.avatar else ""
    return f"{said}{'; then ' if others else ''}{'; '.join(others)}{beside}."


def _each(attempts: Sequence[Attempt]) -> list[str]:
    return [_one(attempt) for attempt in attempts]


def _one(attempt: Attempt) -> str:
    return f"{attempt.any_point.run} ({quantity(attempt.time, 'us')} a frame, leaves {quantity(attempt.error, 'm')})"
