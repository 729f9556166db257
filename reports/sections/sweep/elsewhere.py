"""Presets that a run has in a scene of the sweep and the sweep has not: named beside its cells, since these leave them out."""

from reports.reading.load import Results
from reports.sections.sweep.cheapest import Block
from reports.sections.sweep.points import Sweep
from reports.words.wording import listed, quantity
from runfiles.accuracy import counts, length

TIME = "frame_time_p50"


def elsewhere(results: Results | None, sweep: Sweep, block: Block) -> str:
    """Of engines of the sweep every preset that the run timed in the scene of `block` and that is no setting there: its median
    and the largest of its errors that count; "" without."""
    if results is None:
        return ""
    here = {point.run for point in sweep.points if point.scenario == block.scenario}
    said = []
    for run in dict.fromkeys(row.run for row in results.of(block.scenario) if row.engine in sweep.engines):
        rows = [row for row in results.of(block.scenario) if row.run == run]
        time = next((row.value for row in rows if row.metric == TIME), None)
        if run in here or time is None:
            continue
        errors = [length(row.metric, row.value) for row in rows
                  if row.value is not None and row.metric in block.metrics and counts(row.metric, row.unit)]
        left = f", leaves {quantity(max(errors), 'm')}" if errors else ""
        said.append(f"{run} {quantity(time, 'us')}{left}")
    if not said:
        return ""
    return ("Presets that are no settings of this sweep, and so in no cell; medians of all frames by the run's own timing pass: "
            f"{listed(tuple(said), len(said))}.")
