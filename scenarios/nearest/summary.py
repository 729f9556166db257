"""What the samples of a scene say together, as a table and as the rows of a file."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scenarios.nearest.frames import Sample

TIMES = 2.0
"""How many times as far as the nearest free posture the one shown may be."""
SURELY = 0.99
"""How many times as far as the nearest posture one is that is surely nearer: the search ends some micrometres short."""
NOTHING = 1e-12
"""Distance [m, rad] up to which a posture is where the user's is, to rounding: a root at rest is 1e-17 m from its user's."""


@dataclass(frozen=True)
class Summary:
    """Root mean square over the sampled frames of one scene: offsets [m] and angles [rad] of the posture shown, of the nearest
    free one, and of the nearest downhill from the one shown. `distance` weighs both as the search did. `near`: share of the
    frames whose offset, and whose angle, is within TIMES of the nearest posture's. `lost` frames have no nearest posture."""

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
    near_offset: float
    near_angle: float

    @property
    def times(self) -> tuple[float, float, float]:
        """How many times as far as the nearest posture: offset, angle, distance."""
        pairs = (self.offset, self.nearest_offset), (self.angle, self.nearest_angle), (self.distance, self.nearest_distance)
        return tuple(_times(*pair) for pair in pairs)  # type: ignore[return-value]

    @property
    def within(self) -> bool:
        """Whether offset and angle of the scene are both within TIMES."""
        return max(self.times[:2]) <= TIMES

    @property
    def too_near(self) -> bool:
        """Whether it is nearer than any posture that is free and within limits, as far as the search goes: so it is not such a
        one, and no such posture has both its offset and its angle, or its distance would be no larger either."""
        return self.times[2] < SURELY


def _times(ours: float, best: float) -> float:
    """Ratio of two distances; both nothing is as good, something over nothing is infinitely worse."""
    if not ours >= 0.0 or not best >= 0.0:
        return math.nan
    if ours <= NOTHING and best <= NOTHING:
        return 1.0
    return ours / best if best > 0.0 else math.inf


def _rms(values: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else math.nan


def summarised(samples: Sequence[Sample]) -> Summary:
    """The samples of one scene, at least one; frames without a nearest posture are left out and counted."""
    found = [sample for sample in samples if math.isfinite(sample.nearest_offset) and math.isfinite(sample.offset)]

    def far(pairs: Sequence[tuple[float, float]]) -> float:
        return _rms([math.hypot(offset, sample.arm * angle) for sample, (offset, angle) in zip(found, pairs, strict=True)])

    near = [
        (_times(s.offset, s.nearest_offset) <= TIMES, _times(s.angle, s.nearest_angle) <= TIMES) for s in found
    ]
    return Summary(
        samples[0].scenario, len(samples), len(samples) - len(found),
        _rms([s.offset for s in found]), _rms([s.nearest_offset for s in found]),
        _rms([s.angle for s in found]), _rms([s.nearest_angle for s in found]),
        far([(s.offset, s.angle) for s in found]), far([(s.nearest_offset, s.nearest_angle) for s in found]),
        far([(s.downhill_offset, s.downhill_angle) for s in found]),
        *(float(np.mean([pair[k] for pair in near])) if near else math.nan for k in (0, 1)),
    )


def table(summaries: Sequence[Summary], without: Sequence[str]) -> str:
    """A line per scene, worst first; `without` names scenes that have no frame in contact."""
    lines = [
        "Distance from the user, rms over sampled frames in contact: of what is shown, of the nearest free posture, their ratio.",
        f"{'scene':24s} {'frames':>6s} {'offset mm':>20s} {'x':>6s} {'angle deg':>20s} {'x':>6s} {'both x':>7s}"
        f" {'downhill x':>10s} {'within 2x':>11s}  verdict",
    ]
    for s in sorted(summaries, key=lambda s: -max(s.times[:2])):
        offset, angle, both = s.times
        down = _times(s.distance, s.downhill_distance)
        lines.append(
            f"{s.scenario:24s} {s.frames - s.lost:3d}/{s.frames:<2d} {1e3 * s.offset:9.3f} {1e3 * s.nearest_offset:10.3f} "
            f"{offset:6.2f} {np.degrees(s.angle):9.3f} {np.degrees(s.nearest_angle):10.3f} {angle:6.2f} {both:7.2f} {down:10.2f} "
            f"{100 * s.near_offset:4.0f}%, {100 * s.near_angle:3.0f}%  {'within' if s.within else 'OVER'}"
        )
    kept = sum(s.within for s in summaries)
    lines.append(f"offset and angle within {TIMES:g} times in {kept} of {len(summaries)} scenes")
    if near := [f"{s.scenario} ({s.times[2]:.2f})" for s in summaries if s.too_near]:
        found = "nearer than any posture found that is free and within limits, offset and angle together"
        lines.append(f"{found}: {', '.join(near)}")
    if without:
        lines.append(f"no frame in contact, or no posture to compare: {', '.join(without)}")
    return "\n".join(lines)
