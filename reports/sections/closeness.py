"""Distance from the user, beside the nearest free posture and beside another engine, from what two commands left."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from reports.words.wording import MISSING, MOST_FACTOR, count, factor, figures, listed, quantity
from runfiles.csv_rows import lines, number, times

FILES = NEAREST, BESIDE = "nearest_free_scenes.csv", "beside.csv"
TIMES = 2.0
"""How many times as far from the user as the nearest free posture the one shown may be."""


@dataclass(frozen=True)
class Near:
    """One scene beside the nearest free posture of `frames` sampled frames, `lost` of which have none: offset [m], angle [rad],
    and both together as the search weighs them, ours, the nearest, the nearest downhill from ours."""

    scenario: str
    frames: int
    lost: int
    offset: float
    nearest_offset: float
    angle: float
    nearest_angle: float
    distance: float
    nearest_distance: float
    downhill_distance: float

    @property
    def offset_times(self) -> float:
        """Ours over the nearest."""
        return times(self.offset, self.nearest_offset)

    @property
    def angle_times(self) -> float:
        """Ours over the nearest."""
        return times(self.angle, self.nearest_angle)

    @property
    def distance_times(self) -> float:
        """Both figures together, ours over the nearest."""
        return times(self.distance, self.nearest_distance)

    @property
    def downhill_times(self) -> float:
        """Both figures together, ours over the nearest that is downhill from ours."""
        return times(self.distance, self.downhill_distance)

    @property
    def within(self) -> bool:
        """Whether offset and angle are both within TIMES; not when one is no number."""
        return self.offset_times <= TIMES and self.angle_times <= TIMES


@dataclass(frozen=True)
class Pair:
    """One scene beside another engine, over the `counted` of `frames` frames that count: offset [m], angle [deg], distance of all
    of the body [m]; which is nearer in each; what is known of an offset and an angle in which the other engine is."""

    other: str
    scenario: str
    frames: int
    counted: int
    offset: float
    their_offset: float
    angle: float
    their_angle: float
    body: float
    their_body: float
    nearer_offset: str
    nearer_angle: str
    nearer_body: str
    known_offset: str
    known_angle: str


@dataclass(frozen=True)
class Closeness:
    """Everything a run knows about it; worst first."""

    near: tuple[Near, ...]
    pairs: tuple[Pair, ...]


def load(run_dir: Path) -> Closeness | None:
    """The files of a run; None when there is neither. Raises InvalidFile for a file that is damaged."""
    near = sorted(lines(run_dir / NEAREST, _near), key=lambda line: -max(line.offset_times, line.angle_times))
    pairs = sorted(lines(run_dir / BESIDE, _pair), key=lambda pair: -times(pair.offset, pair.their_offset))
    return Closeness(tuple(near), tuple(pairs)) if near or pairs else None


def _near(row: Mapping[str, str]) -> Near:
    told = {name: number(row[name]) for name in Near.__dataclass_fields__ if name not in ("scenario", "frames", "lost")}
    return Near(row["scenario"], int(row["frames"]), int(row["lost"]), **told)


def _pair(row: Mapping[str, str]) -> Pair:
    return Pair(
        row["other"].replace(".", "/"), row["scenario"], int(row["frames"]), int(row["counted"]),
        number(row["offset"]), number(row["their_offset"]), number(row["angle"]), number(row["their_angle"]),
        number(row["body"]), number(row["their_body"]), row["nearer_offset"], row["nearer_angle"], row["nearer_body"],
        row["known_offset"], row["known_angle"],
    )


def told(value: float, unit: str) -> str:
    """A quantity, or a dash; radians as degrees."""
    if math.isnan(value):
        return MISSING
    return quantity(math.degrees(value), "deg") if unit == "rad" else quantity(value, unit)


def multiple(value: float) -> str:
    """How many times, to three figures up to where factors end."""
    return f"×{figures(value)}" if value <= MOST_FACTOR else factor(value)


def near_sentence(near: tuple[Near, ...]) -> str:
    """What to conclude, losses first."""
    beyond = [line for line in near if not line.within]
    over = tuple(f"{n.scenario} (offset {multiple(n.offset_times)}, angle {multiple(n.angle_times)})" for n in beyond)
    held = f"within {TIMES:g} times in {len(near) - len(over)} of {count(len(near), 'scene')}"
    return f"Offset and angle are {held}." + (f" Beyond: {listed(over, 99)}." if over else "")


def pair_sentence(pairs: tuple[Pair, ...]) -> str:
    """What to conclude, losses first."""
    said = []
    for what, meant in (("offset", "offset"), ("angle", "angle"), ("body", "the distance of all of the body")):
        nearer = [getattr(pair, f"nearer_{what}") for pair in pairs]
        lost = tuple(pair.scenario for pair, side in zip(pairs, nearer, strict=True) if side == "theirs")
        names, ours = f": {listed(lost, 99)}" if lost else "", nearer.count("ours")
        said.append(f"In {meant}, {pairs[0].other} is nearer in {count(len(lost), 'scene')}{names}; ours in {ours}.")
    return " ".join(said)


def pair_notes(pairs: tuple[Pair, ...]) -> tuple[str, ...]:
    """What is known of each figure in which the other engine is nearer."""
    each = ((pair.scenario, what, getattr(pair, f"known_{what}")) for what in ("offset", "angle") for pair in pairs)
    return tuple(f"{scenario}, {what}: {known}." for scenario, what, known in each if known)


def section(closeness: Closeness) -> dict[str, object]:
    """What a page needs for its section."""
    near, pairs = closeness.near, closeness.pairs
    return {
        "close": closeness, "close_near": near_sentence(near) if near else "",
        "close_pairs": pair_sentence(pairs) if pairs else "", "close_notes": pair_notes(pairs),
        "multiple": multiple, "told": told,
    }
