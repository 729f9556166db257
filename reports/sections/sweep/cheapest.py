"""The cheapest setting of every engine that reaches an accuracy, scene by scene: what a frame costs, and the options to copy."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

from reports.deciding.alike import Basis, factor, is_more
from reports.sections.sweep.attempts import Attempt, attempts, bases_of
from reports.sections.sweep.ladders import falling, step_words
from reports.sections.sweep.points import OURS, WHICH, Sweep, measured_of
from reports.words.metric_words import words
from reports.words.wording import count, limit, listed, quantity, ratio
from runfiles import ladder
from runfiles.accuracy import FOLLOWING, FOLLOWS, LEVELS, counts

PROFILED = (1e-3, 1e-6)
"""Those of LEVELS that have a performance profile."""
NOISE = 0.03
"""Share by which medians of the same frames differ from one process to the next: nearer times of an engine are not told apart,
and the simplest of such settings is named. Smaller, and the name changes from run to run."""
CHEAPEST = "cheapest (measured of planned)"
"""What the numbers beside the name of a setting are."""
BASE = "/".join(OURS)
"""What every factor is a multiple of: the time of our engine as it comes, in the same scene."""


def cheapest(tried: Sequence[Attempt], level: float) -> Attempt | None:
    """The fastest that reaches `level` [m]; of those within NOISE of it a preset before what was turned, then the more accurate,
    then the first by name. Errors below the finest of LEVELS are not told apart either."""
    able = [attempt for attempt in tried if attempt.reaches(level)]
    least = min((attempt.time for attempt in able), default=math.nan)
    near = [attempt for attempt in able if attempt.time <= (1.0 + NOISE) * least]
    return min(near, key=lambda a: (not a.any_point.is_preset, max(a.error, LEVELS[-1]), a.any_point.setting), default=None)


@dataclass(frozen=True)
class Cell:
    """The cheapest setting of one engine at one accuracy; `factor`: its time over that of BASE, nan if there is none like for
    like; `best` if it is the fastest engine's or level with it, never in a scene with an avatar. `strays`: how many settings
    leave so little and do not follow a free user."""

    attempt: Attempt | None
    factor: float
    best: bool = False
    strays: int = 0


@dataclass(frozen=True)
class Line:
    """One engine in one scene: a cell per level; `tried` settings of those `planned` were measured, the least error among those
    that follow a free user is `least` [m], nan if there is none."""

    engine: str
    cells: tuple[Cell, ...]
    tried: int
    least: float
    planned: int = 0
    unasked: tuple[str, ...] = ()
    """Rungs of the ladder of steps that were planned here and not measured: without them nothing is the cheapest, or missed."""
    strays: int = 0
    """How many of those measured do not follow a free user, and so reach nothing."""
    falling: tuple[Attempt, ...] = ()
    """The finest measured steps of ladders whose errors still fall there: a finer one may reach what they miss."""

    @property
    def of(self) -> str:
        """"10 of 21": so many settings measured of so many planned."""
        return f"{self.tried}" + (f" of {self.planned}" if self.planned > self.tried else "")

    @property
    def none(self) -> str:
        """What is said where no setting reached an accuracy: that none measured does, or which steps were not measured."""
        if self.unasked:
            return f"not said: {count(len(self.unasked), 'step')} of the ladder not measured, none of {self.of}"
        if self.falling:
            ends = tuple(f"{one.any_point.family.partition('/')[2]} {step_words(one.any_point)}" for one in self.falling)
            return f"not said: errors still fall at {listed(ends)}, the finest step measured, none of {self.of}"
        return f"none of {self.measured}"

    def missed(self, level: int, below: float = math.inf) -> bool:
        """Whether a step was not measured that could change what is said of a level: with a setting that reaches it, a coarser
        rung; without one also what is finer than a ladder whose errors still fall at its end. What is finer takes no less time
        than that end: it changes nothing where others take less than `below` [us] and the end does not."""
        attempt = self.cells[level].attempt
        return bool(_coarser(self.unasked, attempt)) or (attempt is None and any(one.time < below for one in self.falling))

    @property
    def measured(self) -> str:
        """"7 settings measured here (of 15 planned)"."""
        return measured_of(self.tried, self.planned, "setting")

    @property
    def at_best(self) -> str:
        """What the engine reaches where it misses an accuracy; those far from a free user do not count."""
        if self.least == self.least:
            near = f" of those within {limit(FOLLOWS, 'm')} of a free user" if self.strays else ""
            return f"at best {quantity(self.least, 'm')}{near}"
        return f"none of them within {limit(FOLLOWS, 'm')} of a free user" if self.tried else "nothing was measured"


def _coarser(unasked: Sequence[str], attempt: Attempt | None) -> tuple[str, ...]:
    """Those rungs that are coarser than the step of an attempt, which may be cheaper than it; all without an attempt, or where
    its step is not known."""
    step = math.nan if attempt is None else attempt.any_point.step
    return tuple(name for name in unasked if not (ladder.step_of(name) or 0.0) <= step)


@dataclass(frozen=True)
class Block:
    """One scene with the errors that count in it, a line per engine; `silent`: engines without words for one of them."""

    scenario: str
    metrics: tuple[str, ...]
    lines: tuple[Line, ...]
    silent: tuple[str, ...] = ()
    unsaid: tuple[str, ...] = ()
    """The errors for which those lack words."""
    basis: Basis = Basis.MEDIAN
    """The time that is compared here."""
    avatar: bool = False
    """Whether there is one: times then stand side by side."""

    def cell(self, engine: str, level: int) -> Cell | None:
        """What an engine has at the level with that index; None for an engine that was not tried."""
        return next((line.cells[level] for line in self.lines if line.engine == engine), None)

    def time(self, engine: str, level: int) -> float:
        """Time [us] of an engine's cheapest setting at the level with that index; nan where it reaches it with none."""
        cell = self.cell(engine, level)
        return math.nan if cell is None or cell.attempt is None else cell.attempt.time

    @property
    def errors(self) -> str:
        """The errors that count here, in words."""
        return " and ".join(words(metric) for metric in self.metrics)


@dataclass(frozen=True)
class Case:
    """One scene at one accuracy: our cheapest setting and the cheapest of all rivals, None where there is none."""

    block: Block
    level: int
    ours: Cell | None
    rival: Cell | None

    @property
    def asked(self) -> bool:
        """Whether every step of every rival was measured that could be cheaper, or reach what none measured does."""
        below = math.inf if self.rival is None else _time(self.rival)
        return not any(line.missed(self.level, below) for line in self.block.lines if line.engine != OURS[0])

    @property
    def where(self) -> str:
        """Scene and accuracy."""
        return f"{self.block.scenario} at {limit(LEVELS[self.level], 'm')}"

    @property
    def lost(self) -> bool:
        """Whether a rival is cheaper and not level, or reaches what ours does not."""
        if self.rival is None:
            return False
        return self.ours is None or is_more(_time(self.ours), _time(self.rival))

    @property
    def times(self) -> str:
        """Both times, the rival's first, with what sleeps in the median frame."""
        ours = "does not reach it" if self.ours is None else quantity(_time(self.ours), "us")
        # the cheapest of ours may be a variant of the preset
        ours = f"{_run(self.ours)} {ours}" if self.ours is not None and _run(self.ours) != BASE else ours
        which = {Basis.TAIL: ", in frames that move", Basis.SLOWEST: ", in the slowest frame"}.get(self.block.basis, "")
        return f"{_run(self.rival)} {quantity(_time(self.rival), 'us')}, ours {ours}{which}"


def _time(cell: Cell | None) -> float:
    return math.nan if cell is None or cell.attempt is None else cell.attempt.time


def _run(cell: Cell | None) -> str:
    return "" if cell is None or cell.attempt is None else cell.attempt.any_point.run


@dataclass(frozen=True)
class Table:
    """All scenes of a sweep that have an error which is a length; `astray`: settings that reach an accuracy and do not follow."""

    blocks: tuple[Block, ...]
    engines: tuple[str, ...]
    astray: tuple[Attempt, ...] = field(default=())

    @cached_property
    def said(self) -> tuple[Block, ...]:
        """Blocks in which every engine has words for the errors."""
        return tuple(block for block in self.blocks if not block.silent)

    @cached_property
    def compared(self) -> tuple[Block, ...]:
        """Those of them without an avatar: only they make cases and profiles."""
        return tuple(block for block in self.said if not block.avatar)

    @cached_property
    def cases(self) -> tuple[Case, ...]:
        """Every compared scene at every accuracy."""
        return self._cases(self.compared)

    @cached_property
    def side_by_side(self) -> tuple[Case, ...]:
        """The same of scenes with an avatar, which are compared by no rule."""
        return self._cases([block for block in self.said if block.avatar])

    def _cases(self, blocks: Sequence[Block]) -> tuple[Case, ...]:
        found = []
        for block in blocks:
            for level in range(len(LEVELS)):
                reached = [cell for engine in self.engines if engine != OURS[0]
                           if (cell := block.cell(engine, level)) is not None and cell.attempt is not None]
                ours = block.cell(OURS[0], level)
                found.append(Case(block, level, ours if ours is not None and ours.attempt is not None else None,
                                  min(reached, key=_time, default=None)))
        return tuple(found)

    def unsaid(self, level: float) -> dict[str, int]:
        """Engine -> in how many compared scenes it is not said whether it reaches an accuracy [m]; none for our own."""
        index, found = LEVELS.index(level), dict[str, int]()
        for line in (line for block in self.compared for line in block.lines if line.engine != OURS[0]):
            if line.cells[index].attempt is None and line.missed(index):
                found[line.engine] = found.get(line.engine, 0) + 1
        return found

    @property
    def lost(self) -> tuple[Case, ...]:
        """Cases in which a rival is cheaper, or reaches what ours does not."""
        return tuple(case for case in self.cases if case.lost)


def table(sweep: Sweep) -> Table:
    """The table of a sweep: scenes in the order of the file, without what stands aside."""
    tried, bases = attempts([point for point in sweep.points if not point.aside]), bases_of(sweep.points)
    avatars = {p.scenario for p in sweep.points if p.avatar or p.metric in FOLLOWING}
    blocks = []
    for scenario in dict.fromkeys(attempt.any_point.scenario for attempt in tried):
        here = [attempt for attempt in tried if attempt.any_point.scenario == scenario]
        metrics = dict.fromkeys(p.metric for p in sweep.points if p.scenario == scenario and counts(p.metric, p.unit))
        own = {engine: [a for a in here if a.any_point.engine == engine] for engine in sweep.engines}
        basis, avatar = bases[scenario], scenario in avatars
        lines = tuple(_line(engine, own[engine], here, basis, avatar) for engine in own if own[engine])
        silent = [p for p in sweep.points if p.scenario == scenario and p.state == "cannot-say" and not own[p.engine]]
        engines, unsaid = (tuple(dict.fromkeys(names)) for names in ([p.engine for p in silent], [p.metric for p in silent]))
        blocks.append(Block(scenario, tuple(metrics), lines, engines, unsaid, basis, avatar))
    astray = tuple(attempt for attempt in tried if attempt.strays and attempt.error <= LEVELS[0])
    return Table(tuple(blocks), sweep.engines, astray)


def _line(engine: str, tried: Sequence[Attempt], here: Sequence[Attempt], basis: Basis, avatar: bool) -> Line:
    base = next((a.any_point for a in here if a.any_point.run == BASE and a.measured), None)
    engines, cells = dict.fromkeys(a.any_point.engine for a in here), []
    unasked = tuple(a.any_point.setting for a in tried
                    if a.any_point.state == "not-measured" and ladder.step_of(a.any_point.setting) is not None)
    for level in LEVELS:
        found = cheapest(tried, level)
        strays = sum(attempt.strays and attempt.error <= level for attempt in tried)
        if found is None:
            cells.append(Cell(None, math.nan, strays=strays))
            continue
        named = [cheapest([a for a in here if a.any_point.engine == other], level) for other in engines]
        best = not avatar and not any(is_more(found.time, one.time) for one in named if one is not None)
        short = base is None or avatar or _coarser(unasked, found)
        times = math.nan if base is None or short else factor(found.any_point, base, basis)
        cells.append(Cell(found, times, best, strays))
    measured = [attempt.error for attempt in tried if attempt.measured and not attempt.strays]
    return Line(engine, tuple(cells), sum(attempt.measured for attempt in tried), min(measured, default=math.nan), len(tried),
                unasked, sum(attempt.strays for attempt in tried), falling(tried))


def sentence(found: Table) -> str:
    """Of scenes without an avatar: where a rival is cheaper than ours first, then what is not reached, then by how much ours is
    cheaper, like for like; then what stands side by side."""
    if not found.blocks:
        return "No error of this sweep is a length: there is no cheapest setting to name."
    cases, lost, parts = found.cases, found.lost, list[str]()
    if cases:
        said = _where(lost)
        parts.append(f"Of {count(len(cases), 'case')} without an avatar (scene × accuracy) a rival is cheaper in {len(lost)}"
                     f"{f': {listed(said)}' if lost else ''}.")
    neither = tuple(case.where for case in cases if case.ours is None and case.rival is None)
    parts += [f"Not reached by any setting measured here of any engine: {listed(neither)}."] if neither else []
    alone = [case for case in cases if case.ours is not None and case.rival is None and case.asked]
    unasked = [case for case in cases if case.ours is not None and not case.asked]
    if alone:
        parts.append(f"In {count(len(alone), 'case')} ours reaches an accuracy that none of the settings measured of "
                     "other engines does.")
    return " ".join([*parts, *_factors(cases), *_unasked(unasked), *_beside(found)])


def brief(found: Table) -> str:
    """The opening in one sentence: in how many cases without an avatar a rival is cheaper than ours, and by how much not."""
    cases, lost = found.cases, found.lost
    if not cases:
        return "no scene without an avatar has a setting that both engines were asked."
    scenes = tuple(dict.fromkeys(case.block.scenario for case in lost))
    said = f"of {count(len(cases), 'case')} without an avatar (scene × accuracy) another engine is cheaper in {len(lost)}"
    return " ".join([f"{said}{f' ({listed(scenes)})' if scenes else ''}.", *_factors(cases)])


def _where(cases: Sequence[Case]) -> tuple[str, ...]:
    """Scene, accuracies and both times; accuracies of a scene at which the times are the same stand together."""
    found: dict[tuple[str, str], list[str]] = {}
    for case in cases:
        found.setdefault((case.block.scenario, case.times), []).append(limit(LEVELS[case.level], "m"))
    return tuple(f"{scene} at {', '.join(levels)} ({times})" for (scene, times), levels in found.items())


def asleep(found: Table) -> list[str]:
    """Both times of the cases in which what rests sleeps in the median frame, so that they have no factor."""
    said: dict[str, list[str]] = {}
    for case in found.cases:
        if case.ours is not None and case.rival is not None and case.rival.factor != case.rival.factor:
            said.setdefault(_asleep(case), []).append(case.where)
    told = tuple(f"{' and '.join(places)}: {text}" for text, places in said.items())
    return [f"No factor where what rests sleeps in the median frame: {listed(told)}."] if told else []


def _factors(cases: Sequence[Case]) -> list[str]:
    """By how much ours is cheaper where frames are alike."""
    both = [(case.rival.factor, case) for case in cases if case.ours is not None and case.rival is not None and case.asked]
    alike = [(times, case) for times, case in both if times == times]
    parts = []
    if alike:
        (low, near), (high, far) = min(alike, key=lambda e: e[0]), max(alike, key=lambda e: e[0])
        parts.append(
            f"Where both reach it, the cheapest rival takes {_times(low)}{_level(near)} ({near.where}, {_run(near.rival)}) "
            f"to {_times(high)} ({far.where}, {_run(far.rival)}) the time of {BASE}, frames in motion where all tell them apart."
        )
    return parts


def _level(case: Case) -> str:
    """"; level" where a rival takes less time, by no more than what counts as level."""
    return ", level" if not case.lost and case.rival is not None and case.rival.factor < 1.0 else ""


def _unasked(cases: Sequence[Case]) -> list[str]:
    """In how many cases steps of a rival are missing, so that neither a factor is made nor that it reaches nothing is said."""
    scenes = tuple(dict.fromkeys(case.block.scenario for case in cases))
    return [f"No factor, and none is said to miss it, in {count(len(cases), 'case')} in which steps of a rival were not measured "
            f"that could be cheaper or more accurate ({listed(scenes)})."] if cases else []


def _asleep(case: Case) -> str:
    """Which of the two sleep in the median frame, with both medians, and the frames that move."""
    assert case.ours is not None and case.rival is not None
    mine, theirs = (cell.attempt.any_point for cell in (case.ours, case.rival) if cell.attempt is not None)
    medians = f"{mine.run} {quantity(mine.p50, 'us')} and {theirs.run} {quantity(theirs.p50, 'us')}, no factor"
    sleep = "both sleep" if mine.is_asleep and theirs.is_asleep else "ours sleeps" if mine.is_asleep else f"{theirs.run} sleeps"
    slowest = case.block.basis is Basis.SLOWEST
    moving = " and ".join(quantity(point.slowest if slowest else point.tail, "us") for point in (mine, theirs))
    return f"{sleep}: {medians}; in frames that move ({'the slowest' if slowest else mine.tail_said}): {moving}"


def _beside(found: Table) -> list[str]:
    """What is said of scenes with an avatar: that they are not compared, and where a rival takes less time all the same."""
    cases = found.side_by_side
    if not cases:
        return []
    less = [case for case in cases if case.lost]
    said = listed(_where(less))
    where = f"a rival takes less time, or reaches what ours does not, in {len(less)} of them: {said}" if less else (
        "in none of them does a rival take less time")
    return [f"With an avatar, in {count(len(cases), 'case')}, ours is kinematic and theirs has dynamics: times stand side by "
            f"side below, without factor, rank or share; {where}."]


def _times(factor: float) -> str:
    return f"×{factor:.2g}" if factor <= 1.0 else ratio(factor) if factor >= 1.005 else "as long as"


def silence(found: Table) -> list[str]:
    """Scenes that are no case because an engine has no words for an error that counts there."""
    return [f"{block.scenario} is no case: {' and '.join(block.silent)} cannot say what counts there "
            f"({' and '.join(words(metric) for metric in block.unsaid)})." for block in found.blocks if block.silent]


def astray(found: Table) -> tuple[str, list[tuple[str, str]]]:
    """What reaches no accuracy because it does not follow, in a sentence and by scene; ("", []) where there is nothing."""
    by_scene: dict[str, list[str]] = {}
    for attempt in found.astray:
        by_scene.setdefault(attempt.any_point.scenario, []).append(f"{attempt.any_point.run} {quantity(attempt.offset, 'm')}")
    if not by_scene:
        return "", []
    said = (f"Not counted as reaching any accuracy, being farther than {limit(FOLLOWS, 'm')} from a user in whose way nothing "
            f"is: {count(len(found.astray), 'setting')} of which no error is above {limit(LEVELS[0], 'm')}, in "
            f"{listed(tuple(by_scene))}")
    return said, [(scene, ", ".join(runs)) for scene, runs in by_scene.items()]


def at_level(block: Block, level: float, engines: Sequence[str]) -> str:
    """One sentence: the errors that count, the time of every engine's cheapest setting at `level` [m], fastest first, and by how
    many settings it is not reached."""
    index = LEVELS.index(level)
    lines = sorted(block.lines, key=lambda line: (math.isnan(block.time(line.engine, index)), block.time(line.engine, index)))
    said = []
    for line in (line for line in lines if line.engine in engines):
        attempt = line.cells[index].attempt
        if attempt is not None:
            said.append(f"{line.engine} {quantity(attempt.time, 'us')} ({attempt.any_point.setting}, {line.of})")
        else:
            said.append(f"{line.engine}: {line.none} ({line.at_best})")
    said += [f"{engine} has no words for it" for engine in block.silent]
    beside = "; ours kinematic, theirs dynamic: not compared" if block.avatar else ""
    tail = "" if block.basis is Basis.MEDIAN else f"; time, as drawn: {WHICH[block.basis]}"
    errors = f"{block.errors[:1].upper()}{block.errors[1:]} at most {limit(level, 'm')}"
    return f"{errors}, {CHEAPEST}: {', '.join(said)}{tail}{beside}."
