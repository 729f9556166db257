"""Large figures of other engines on the page, each with its cause and the moment of its replay where it is worst."""

from collections import Counter

from reports.deciding.moments import OVERLAPS
from reports.deciding.moments import moment as moment_of
from reports.reading.load import Results
from reports.words.wording import count
from runfiles.explained import LARGE, LARGE_ANGLE, Large, large


def moment(results: Results, one: Large) -> str:
    """"#t=0.341667", the time [s] at which the overlap of a run is deepest; "" for other metrics and where no series was kept."""
    return moment_of(results, one.row.scenario, one.row.run, one.row.metric) if one.row.metric in OVERLAPS else ""


def sentence(found: tuple[Large, ...]) -> str:
    """What to conclude: how many have which cause, those without one first."""
    if not found:
        return "No other engine has a figure of this size."
    causes = Counter("not yet explained" if one.why is None else one.why.cause.value for one in found)
    order = sorted(causes, key=lambda cause: (cause != "not yet explained", cause not in ("our adapter", "our setting"), cause))
    return f"{count(len(found), 'figure')}: {'; '.join(f'{causes[cause]} {cause}' for cause in order)}."


def begins_with(results: Results, one: Large) -> bool:
    """Whether the figure is the overlap that the scene starts with: then it says nothing of any engine."""
    series = results.series.get(one.row.scenario, {}).get(one.row.run)
    if one.row.metric not in OVERLAPS or one.row.value is None or series is None or not series.overlap.size:
        return False
    # what is compared went through a file of text
    return bool(series.overlap[0] >= (1.0 - 1e-6) * one.row.value)


def section(results: Results) -> dict[str, object]:
    """What the template is made of."""
    every = large(results.rows, results.scales)
    found = tuple(one for one in every if not begins_with(results, one))
    aside = len(every) - len(found)
    more = f" Left out: {count(aside, 'figure')} that a scene starts with." if aside else ""
    return {
        "large_rows": found, "large_said": sentence(found) + more, "large_from": LARGE,
        "large_angle": LARGE_ANGLE, "large_moment": lambda one: moment(results, one),
    }
