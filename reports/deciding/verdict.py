"""The verdict: what held, what failed, what crashed, what was not measured, and what we lose, worst first."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from reports.deciding.alike import told
from reports.deciding.losses import beside
from reports.deciding.tables import RAW_TRACKER, gated_run
from reports.reading.load import Results, Row
from reports.words.metric_words import words
from reports.words.wording import count, limit, quantity
from runfiles.behind import Compared, Lost, by_family, compared
from runfiles.like_for_like import with_avatar

PROMISED = {
    "residual_overlap_max": "no overlap", "joint_limit_excess_max": "joint limits", "wrong_side_frames": "the right side",
    "not_finite_frames": "finite numbers",
}
"""What holds whatever the scene and the motion, by metric."""
LOOKS = (
    "link_jump_max", "root_jump_max", "pose_jump_max", "reversal_max", "reversal_p95", "chatter_frames", "jitter_rms",
    "jerk_ratio", "still_frames", "tracker_offset_max", "tracker_offset_rms", "tracker_offset_rms_free", "silent_offset_frames",
)
"""Metrics of how motion looks; where one has a bound, that says less than a promise does."""
WAIVED = "waived"
"""Status of a check whose bound does not hold and is waived up to its scene's ceiling."""
MOSTLY = 0.5
"""Share of the figures of how motion looks below which it is said beside the verdict how many have a bound, and which measures
have none."""
# Kinds of loss, worst first: a check failed; one is waived, for its bound does not hold; another engine did better;
# one that passed through what it should have met is passed over where that could win.
KINDS = ("failed", "above bound", "behind")


@dataclass(frozen=True)
class Loss:
    """One thing we lose: `kind` is one of KINDS, `factor` orders losses of a kind, `beside` is it as text beside the figures.
    What is lost to another engine stands once for a family of scenes, by its worst scene."""

    scene: str
    what: str
    ours: str
    theirs: str
    kind: str
    factor: float
    beside: str = ""

    @property
    def severity(self) -> tuple[int, float]:
        """Orders losses: a failed check outweighs a waived one, and that any comparison."""
        return (-KINDS.index(self.kind), self.factor)


@dataclass(frozen=True)
class Verdict:
    """Rows of the gate by outcome; `waived` are above their bound and within the scene's ceiling. Crashed
    and unmeasured also hold one row per run of the other engines. `finished` is False for results of a run that never ended,
    `rivals` False when no other engine brought a number; `scenes` counts the scenes of the run by what became of the gated run in
    them, one word each; `looks`: how many of our figures of how motion looks have a bound, and of how many;
    `unbounded`: measures of these that have one nowhere."""

    gated: str
    passed: tuple[Row, ...]
    waived: tuple[Row, ...]
    failed: tuple[Row, ...]
    crashed: tuple[Row, ...]
    unmeasured: tuple[Row, ...]
    neutral: tuple[Row, ...]
    losses: tuple[Loss, ...]
    ranked: Compared
    scenes: Mapping[str, int]
    exit_code: int
    finished: bool
    rivals: bool
    looks: tuple[int, int] = (0, 0)
    unbounded: tuple[str, ...] = ()

    @property
    def word(self) -> str:
        """One word for the whole run; it is "passed" only when nothing failed or is missing."""
        if self.failed:
            return "failed"
        if self.crashed:
            return "crashed"
        if self.unmeasured or not self.finished:
            return "incomplete"
        return "passed" if self.passed or self.waived else "empty"

    @property
    def sentence(self) -> str:
        """The verdict line."""
        total = len(self.passed) + len(self.waived) + len(self.failed)
        if self.word == "empty":
            return f"No verdict: this run has no gated measurement of {self.gated}."
        parts = [f"{len(self.failed):,} of {count(total, 'check')} of {self.gated} failed"] if self.failed else []
        parts += [f"{count(len(self.crashed), 'run')} crashed"] if self.crashed else []
        parts += [f"{len(self.unmeasured):,} not measured"] if self.unmeasured else []
        if not self.finished:
            parts.append("the run did not end")
        if total and not self.failed:
            parts.append(f"{len(self.passed):,} of {count(total, 'check')} of {self.gated} pass")
        if self.waived:
            parts.append(f"{len(self.waived):,} waived")
        if len(parts) == 1 and self.passed and not self.failed:
            promised = [told for metric, told in PROMISED.items() if any(row.metric == metric for row in self.passed)]
            kept = f", among them what is promised everywhere: {', '.join(promised)}" if promised else ""
            passed = f"All {count(total, 'check')} of {self.gated} pass{kept}" if total > 1 else "The one check passes"
            return f"{passed}{self.but}."
        return "; ".join(parts)[:1].upper() + "; ".join(parts)[1:] + f"{self.but}."

    @property
    def but(self) -> str:
        """That most figures of how motion looks have no bound, and which measures have none anywhere; "" where most have one, or
        there are none."""
        bounded, of = self.looks
        if not bounded < MOSTLY * of:
            return ""
        none = f", {count(len(self.unbounded), 'measure')} nowhere" if self.unbounded else ""
        return f"; of how motion looks {bounded} of {count(of, 'figure')} {'has' if bounded == 1 else 'have'} a bound{none}"


def believed(row: Row, ours: str) -> str:
    """What a gated row says, unless its numbers contradict it: a pass needs a finite value within the limit. A gated row
    above its bound and within its ceiling reads "waived", also where the run of an earlier version says "info"; info rows of
    other engines stay info."""
    gated = row.status in ("pass", WAIVED) or (row.status == "info" and row.run == ours and row.bound is not None)
    if not gated:
        return row.status
    if row.value is None:
        return "not-measured"
    if not math.isfinite(row.value) or (row.limit is not None and not row.value <= row.limit):
        return "fail"
    return "pass" if row.bound is None or row.value <= row.bound else WAIVED


def verdict(results: Results) -> Verdict:
    """Judge a run from its rows alone."""
    ours = gated_run(results.rows)
    ranked, looks = compared(results.rows, ours, results.unsaid, results.scales, told(results)), _looks(results, ours)
    by_word: dict[str, list[Row]] = {word: [] for word in ("pass", WAIVED, "fail", "crashed", "not-measured", "neutral")}
    runs_seen: set[tuple[str, str, int, str]] = set()
    for row in results.rows:
        word = believed(row, ours)
        if word in ("pass", WAIVED, "fail"):
            by_word[word].append(row)
        elif word in ("crashed", "not-measured"):
            key = (row.scenario, row.run, row.seed, row.metric if row.run == ours and word == "not-measured" else word)
            if key not in runs_seen:
                runs_seen.add(key)
                by_word[word].append(row)
        elif row.run == ours and word in ("cannot-say", "refused"):
            by_word["neutral"].append(row)
    by_word["not-measured"] += _gaps(results, ours)
    failed = tuple(sorted(by_word["fail"], key=lambda row: -excess(row)))
    code = 1 if failed else 3 if by_word["crashed"] or by_word["not-measured"] else 0 if results.rows else 5
    return Verdict(
        ours, tuple(by_word["pass"]), tuple(by_word[WAIVED]), failed, tuple(by_word["crashed"]),
        tuple(by_word["not-measured"]), tuple(by_word["neutral"]),
        _losses(results, failed, tuple(by_word[WAIVED]), ranked), ranked,
        _states(results, ours, failed, by_word[WAIVED]), code, results.exit_code is not None,
        any(row.engine not in (RAW_TRACKER, ours.split("/")[0]) and row.value is not None for row in results.rows),
        (sum(row.bound is not None for row in looks), len(looks)),
        tuple(metric for metric in LOOKS if {row.bound for row in looks if row.metric == metric} == {None}),
    )


def _looks(results: Results, ours: str) -> list[Row]:
    """Our figures of how motion looks."""
    return [row for row in results.rows if row.run == ours and row.metric in LOOKS and row.value is not None]


STATES = ("passed", WAIVED, "failed", "crashed", "refused", "not measured")
"""What can become of a scene; worst of those that fit: crashed, not measured, failed, refused, waived, passed. In a waived
scene a bound does not hold yet."""


def _states(results: Results, ours: str, failed: Iterable[Row], waived: Iterable[Row]) -> Mapping[str, int]:
    """Number of scenes by state of `ours`: each scene of the run has exactly one, so they add up."""
    lost, above = {row.scenario for row in failed}, {row.scenario for row in waived}
    counted = dict.fromkeys(STATES, 0)
    for scene in results.scenes():
        own = [row for row in results.of(scene) if row.run == ours]
        said = {believed(row, ours) for row in own}
        if "crashed" in said:
            state = "crashed"
        elif not own or "not-measured" in said:
            state = "not measured"
        elif scene in lost:
            state = "failed"
        else:
            state = "refused" if said & {"refused", "cannot-say"} else WAIVED if scene in above else "passed"
        counted[state] += 1
    return counted


def excess(row: Row) -> float:
    """How many times its bound (where there is none, its limit) a row has; infinite when not finite or the bound is zero."""
    if row.value is None or not math.isfinite(row.value):
        return math.inf
    stands = (row.limit if row.bound is None else row.bound) or 0.0
    return row.value / stands if stands > 0.0 else math.inf


def _gaps(results: Results, ours: str) -> list[Row]:
    """One row for each scene in which the gated run has no row at all, though it took part elsewhere."""
    if not any(row.run == ours for row in results.rows):
        return []
    present = {row.scenario for row in results.rows if row.run == ours}
    engine, preset = ours.split("/", 1)
    return [
        Row(scene, engine, preset, 0, 0, "", None, "", None, None, "not-measured", "no row of this run in results.json")
        for scene in results.scenes() if scene not in present
    ]


def _losses(results: Results, failed: tuple[Row, ...], waived: tuple[Row, ...], ranked: Compared) -> tuple[Loss, ...]:
    found = [
        Loss(
            row.scenario, row.metric, quantity(row.value, row.unit),
            f"limit {limit(row.limit, row.unit)}" + (f"; {row.note}" if row.note else ""), "failed", excess(row),
        )
        for row in failed
    ]
    found += [
        Loss(row.scenario, row.metric, quantity(row.value, row.unit), f"bound {limit(row.bound, row.unit)}, waived up to "
             f"{limit(row.limit, row.unit)}", "above bound", excess(row))
        for row in waived
    ]
    found += [
        _compared(lost) for metric in by_family(ranked, results.families) for lost in metric.lost
    ]
    return tuple(sorted(found, key=lambda loss: loss.severity, reverse=True))


def _compared(lost: Lost) -> Loss:
    """One metric of one family in which another engine is ahead, in the worst scene."""
    found, row = lost.worst, lost.worst.row
    theirs = ", ".join(f"{run} {quantity(value, row.unit)}" for run, value in found.rivals)
    return Loss(
        row.scenario, row.metric, quantity(found.value, row.unit),
        theirs, "behind", found.severity, beside(found),
    )


def scenes_sentence(verdict_: Verdict) -> str:
    """How the scenes add up, and what the gate counts beside them."""
    checks = len(verdict_.passed) + len(verdict_.waived) + len(verdict_.failed)
    above = f", {len(verdict_.waived)} waived" if verdict_.waived else ""
    # a run without waivers need not be told of them
    parts = " + ".join(f"{number} {state}" for state, number in verdict_.scenes.items() if number or state != WAIVED)
    return (f"Scenes: {parts} = {sum(verdict_.scenes.values())}. In them {count(checks, 'check')}: "
            f"{len(verdict_.passed)} pass{above}, {len(verdict_.failed)} failed. A scene that expects a "
            "refusal and got it counts as refused.")


def loosest(results: Results, verdict_: Verdict) -> tuple[str, ...]:
    """A line for each measure of how motion looks: in how many scenes with an avatar it has a bound, the widest of these and our
    largest figure under one, and our largest figure where it has none."""
    rows = _looks(results, verdict_.gated)
    scenes, said = {row.scenario for row in rows}, []
    for metric in LOOKS:
        own = [row for row in rows if row.metric == metric]
        bounds = [(row.bound, row) for row in own if row.bound is not None]
        free = [row for row in own if row.bound is None]
        if not own:
            continue
        where = "bounded nowhere"
        if bounds:
            under = _largest([row for _, row in bounds])
            widest = limit(max(bound for bound, _ in bounds), under.unit)
            bounded = len({row.scenario for _, row in bounds})
            where = (f"bounded in {bounded} of {count(len(scenes), 'scene')} with an avatar, by {widest} at most, largest there "
                     f"{quantity(under.value, under.unit)} ({under.scenario})")
        most = _largest(free) if free else None
        beyond = ""
        if most:
            beyond = f"; largest without a bound {quantity(most.value, most.unit)} ({most.scenario})" if most.value else (
                "; 0 wherever there is no bound")
        said.append(f"{words(metric)}: {where}{beyond}")
    return tuple(said)


def _largest(rows: list[Row]) -> Row:
    """The row with the largest figure; one that is no number is larger than any."""
    return max(rows, key=lambda row: row.value if row.value is not None and math.isfinite(row.value) else math.inf)


def reading_order(results: Results, verdict_: Verdict) -> tuple[str, ...]:
    """Scenes as tables list them: those in trouble, then everyday scenes, then others with an avatar, then the rest; of each kind
    those first that we lose."""
    lost = losing_scenes(verdict_)
    trouble = {row.scenario for row in verdict_.failed + verdict_.waived}
    trouble |= {row.scenario for row in verdict_.crashed + verdict_.unmeasured if row.run == verdict_.gated}
    avatars = with_avatar(results.rows)

    def kind(scene: str) -> int:
        if scene in trouble:
            return 0
        return 1 if scene in results.everyday else 2 if scene in avatars else 3

    return tuple(sorted(dict.fromkeys((*lost, *results.scenes())), key=kind))


def losing_scenes(verdict_: Verdict) -> tuple[str, ...]:
    """Scenes in the order in which a reader should see them: failed and lost first."""
    troubled = [row.scenario for row in verdict_.crashed + verdict_.unmeasured if row.run == verdict_.gated]
    failed = [row.scenario for row in verdict_.failed + verdict_.waived]
    return tuple(dict.fromkeys([*failed, *troubled, *(loss.scene for loss in verdict_.losses)]))
