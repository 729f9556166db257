"""Which metrics the verdict table compares, what makes two values equal, and how one run becomes one number per column."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from reports.reading.load import Row
from reports.words.metric_words import words
from runfiles.ranked import CLOSED_FORM, RANKED


@dataclass(frozen=True)
class Column:
    """One column: smaller is better in all. Values that differ by `same` (in `unit`) or less count as equal, as on the terminal;
    `floor` is the least value that two runs of one engine are told apart by. `stays_inside` columns cannot be won by leaving
    the room; what is not `ranked` is shown and has no best; values within a `share` of the smaller count as equal too."""

    key: str
    title: str
    unit: str
    floor: float
    meaning: str
    takes: Callable[[str], bool]
    same: float
    stays_inside: bool = False
    ranked: bool = True
    share: float = 0.0


def _named(*names: str) -> Callable[[str], bool]:
    return lambda metric: metric in names


def is_truth_error(metric: str) -> bool:
    """Whether a metric is a distance from a closed form, as the registry says."""
    return metric in RANKED and RANKED[metric].is_truth_error


def _column(key: str, title: str, unit: str, floor: float, meaning: str, metric: str) -> Column:
    """A column of one metric, which counts as equal when the registry says so."""
    rule = RANKED[metric]
    return Column(key, title, unit, floor, meaning, _named(metric), rule.same, rule.stays_inside, share=rule.share)


COLUMNS = (
    _column("overlap", "deepest overlap shown", "m", 1e-8, "deepest penetration over all shown frames and all pairs, "
            "found from poses by one judge for every engine (the judge resolves 10 nm)", "residual_overlap_max"),
    _column("overlap_frames", "states with overlap", "%", 0.05, "states shown with more than 1 µm of penetration",
            "overlap_frames"),
    _column("wrong_side", "on the wrong side", "frames", 0.5, "frames in which something is where the scene says that it cannot "
            "be: an engine that passes through a wall may overlap nothing and is still wrong", "wrong_side_frames"),
    Column("truth", "error to closed form", "", 1e-4, "distance from the closed form, in the scenes that have one; "
           "the cell names the metric", is_truth_error, CLOSED_FORM),
    _column("offset", "offset from the user, free", "m", 1e-6, "root mean square distance from the user's posture over the "
            "frames in which that posture is free of overlap: how closely the avatar stays with its user",
            "tracker_offset_rms_free"),
    _column("chatter", "frames in contact that shake", "%", 0.05, "share of the frames in contact in which a link goes to and "
            "fro, faster than 0.18 m/s (3 mm at 60 Hz), in 3 of the last 4 frames, while its target does not",
            "chatter_frames"),
    _column("jitter", "jitter in contact", "m", 1e-6, "to and fro while the target rests or slides: of the link that has "
            "most, the root mean square of what it takes back over frames in contact, of which each counts as 3 mm at most (at "
            "60 Hz): in few frames one event decides", "jitter_rms"),
    _column("limits", words("joint_limit_excess_max"), "deg", 1e-3, "largest angle beyond a hinge's limits or a ball joint's "
            "swing and twist", "joint_limit_excess_max"),
    _column("cone", words("reach_cone_excess_max"), "deg", 1e-3, "largest angle by which a limb points outside its reach cone",
            "reach_cone_excess_max"),
    _column("p50", "frame time, median", "us", 0.0, "median time of a rendered frame, sub-steps included, engine only, "
            "each frame's least over the repeats; beside it repeats x frames, and what it mixes of frames in motion and at rest",
            "frame_time_p50"),
    Column("python", "as called from Python", "us", 0.0, "the same median with the Python round the engine: our own, and "
           "round MuJoCo and PyBullet that of our adapters, which is why it ranks nothing", _named("frame_time_python_p50"), 0.0,
           ranked=False),
    Column("slowest", "slowest frame timed", "us", 0.0, "the slowest of all frames of the scene that this engine was timed over, "
           "each the least of its repeats; beside it which frames these are. Ours is timed over whole scenes, the others over as "
           "many frames as there is time for, in which a slower one may be missed, so this ranks nothing here",
           _named("frame_time_max"), 0.0, ranked=False),
    _column("p95", "frame time, 95th percentile", "us", 0.0, "time that 95 % of the frames stay below", "frame_time_p95"),
)


def truth_metric(rows: Iterable[Row]) -> str | None:
    """The one ground-truth error a scene is ranked by: one with a bound first, else the first that was measured."""
    errors = [row for row in rows if is_truth_error(row.metric)]
    first = sorted(errors, key=lambda row: (row.limit is None, row.value is None))
    return first[0].metric if first else None


def worst(rows: Sequence[Row]) -> Row | None:
    """The row to show for several seeds: what is not finite first, then the largest value, then a row without a value."""
    def badness(row: Row) -> tuple[int, float]:
        if row.value is None:
            return (0, 0.0)
        return (2, 0.0) if not math.isfinite(row.value) else (1, row.value)

    return max(rows, key=badness, default=None)


def ratio_to_best(value: float | None, best: float | None, same: float = 0.0, share: float = 0.0) -> float | None:
    """`value` over `best`; 1 where they differ by `same`, or that `share` of the best, or less, infinite against a best of
    0; None where either is missing or not finite."""
    if value is None or best is None or not (math.isfinite(value) and math.isfinite(best)):
        return None
    if 0.0 <= value - best <= max(same, share * best):
        return 1.0
    return value / best if best > 0.0 else math.inf
