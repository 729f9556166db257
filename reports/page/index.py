"""`index.html`: one self-contained page, built from results alone. The template lays out; here the words are gathered."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from reports.deciding import bounds_by_kind, cut_short, losses, tuned
from reports.deciding.columns import COLUMNS
from reports.deciding.conclusions import (
    CAVEAT,
    KINEMATIC,
    OVERLAP_BOUND,
    gap_sentence,
    hover_notes,
    overlap_summary,
    peak,
    ratio_sentence,
    slowest_sentence,
    table_sentence,
    time_summary,
)
from reports.deciding.marked import cell_note
from reports.deciding.moments import Instants, address
from reports.deciding.ranking import COUNTED, ranks, runs_of, tolerances
from reports.deciding.ranking import sentence as ranking_sentence
from reports.deciding.tables import Block, blocks, more_truths
from reports.deciding.tuned import tunings
from reports.deciding.verdict import Verdict, loosest, reading_order, scenes_sentence
from reports.drawing.charts import Panel, overlap_panels, time_panels, time_percentiles
from reports.drawing.palette import Stroke, dark_rules, strokes
from reports.page import gallery, glossary, three_answers
from reports.page.extra_sections import Section, drawn, tried
from reports.page.finished import labelled, linked
from reports.page.gallery import Picture
from reports.page.scene_page import environment, strokes_data
from reports.page.scripts import data, policy, source
from reports.reading.load import EngineNote, Results
from reports.replay.courses import CourseCharts, over_all
from reports.sections import (
    bad_news,
    broad_phase,
    closeness,
    convergence,
    effects,
    explained,
    figure_7,
    first_contact,
    growth,
    judge,
    law_map,
    narrow_phase,
    own_scenes,
    paper_figures,
    stability,
    summary_charts,
    table_2,
    unseen,
    your_project,
)
from reports.sections import broad_phase as broad_phase_chart
from reports.sections import law_map as law_map_chart
from reports.sections import table_2 as table_2_chart
from reports.sections.broad_phase import BroadPhase
from reports.sections.closeness import Closeness
from reports.sections.convergence import Converging
from reports.sections.effects import Ablation
from reports.sections.figure_7 import Trace
from reports.sections.growth import Growth
from reports.sections.judge import Trust
from reports.sections.law_map import LawMap
from reports.sections.narrow_phase import NarrowPhase, call_costs, conclusion, factor, inks, panels, start_up
from reports.sections.page_paths import path_of
from reports.sections.stability import Stability
from reports.sections.sweep import chart as sweep_chart
from reports.sections.sweep import points as sweep
from reports.sections.sweep.points import Sweep
from reports.sections.table_2 import Table2
from reports.words import timing_words
from reports.words.metric_words import words
from reports.words.wording import count, limit, listed, quantity, ratio
from runfiles.behind import by_family
from runfiles.explained import PINNED
from runfiles.naming import COMPILED
from runfiles.timing_protocol import repeats_of

TEMPLATES = Path(__file__).parents[1] / "templates"
SHARED: Mapping[str, object] = {"moment_at": address, "quantity": quantity, "limit": limit, "count": count, "words_of": words}
"""What templates of all sections know."""
SHORT_COMMIT = 12
"""Characters of a commit's hash that are printed: enough to be the only one that begins so."""
# Printed on every page, whatever the figures say.
FAIRNESS = (
    "Our avatar is kinematic: the user's motion drives it, and it meets simulated bodies with a coupled mass. It is not full "
    "articulated dynamics. MuJoCo and PyBullet compute the dynamics of the whole articulated body and pay for it in frame time.",
    "One scene description; every engine is built from it: the same shapes, masses, pairs that may meet, and tracker samples at "
    "the same instants, with the exceptions named below.",
    "One judge finds the overlap of every engine, ours included, from exported poses alone; no engine's own contact depth "
    "is used.",
    "Accuracy and time are measured in separate passes. Sub-steps count, because time is per rendered frame. What the first "
    "frames load or compile is reported beside it, never inside.",
    "Of the presets of MuJoCo and PyBullet, default is their default parameters in our rig and tuned what we found best for "
    "accuracy in scenes of its kind, with sleep off. Single scenes have better settings, see Accuracy against time; settings and "
    "reasons are listed above. A preset that is not in the table was not run.",
    PINNED,
    "Only the gated engine and preset can pass or fail. Every other row is information.",
)
UNLIKE = (
    "The same shapes, masses, pairs that may meet, and tracker samples at the same instants, except: MuJoCo has vertices in "
    "single precision, in falling_rod and painleve an infinite plane for the floor's box, and tuned, with avatars, an "
    "armature of 30 % of each link's inertia on its joints. PyBullet has hulls of 162 points for ellipsoids, hulls inflated "
    "by 1 mm by default and by 1 um tuned, at most 16 pieces a body, so that it has several bodies where a scene has more, "
    "and stand-in links of 0.1 % of a link's mass between hinges that share a centre; tuned, avatars have hulls for boxes, "
    "and each of several pieces on a massless link of its own.",
    "The rig of MuJoCo is one weld per link, of mujoco/servos a weld of the root and a servo per joint; that of PyBullet one "
    "constraint of the root, whose largest force is our setting, and a motor per joint. In every MuJoCo preset, default too, "
    "filterparent and autoreset are disabled and pairs excluded as the scene has them, with reasons under Settings.",
    "Figures in reasons of settings, and in what is said of large figures of others, are of the studies that found them, not of "
    "this run, whose own stand in its tables.",
)
"""What engines do not have alike, and how each is rigged."""


@dataclass(frozen=True)
class SettingLine:
    """One setting of one engine: its values, each with the scenes it was used in (none listed if it was all of them)."""

    name: str
    values: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class EngineCard:
    """What an engine and preset says about itself, gathered over all scenes."""

    run: str
    version: str
    settings: tuple[SettingLine, ...]
    cannot: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class Extras:
    """What a run may hold besides its results: a section each."""

    narrow: NarrowPhase | None = None
    broad: BroadPhase | None = None
    two: Table2 | None = None
    growth: Growth | None = None
    close: Closeness | None = None
    ablation: Ablation | None = None
    figure_7: tuple[Trace, ...] = ()
    sweep: Sweep | None = None
    converging: Converging | None = None
    law_map: LawMap | None = None
    steady: Stability | None = None
    judge: Trust | None = None
    files: frozenset[str] = frozenset()
    """Names of the files that lie in the run's folder."""


class Layout(NamedTuple):
    """The table of a run, which of its scenes and engines come in which order and colour, and the charts of all scenes."""

    blocks: tuple[Block, ...]
    colours: Mapping[str, Stroke]
    order: tuple[str, ...]
    overlaps: list[Panel]
    spreads: list[Panel]

    def by_scene(self) -> dict[str, list[Panel]]:
        """The charts of each scene, which stand on its own page."""
        found: dict[str, list[Panel]] = defaultdict(list)
        for panel in (*self.overlaps, *self.spreads):
            found[panel.scene].append(panel)
        return found


def layout(results: Results, verdict: Verdict) -> Layout:
    """What the page holds; its charts are drawn while Python goes on."""
    shown = blocks(results, reading_order(results, verdict))
    runs = [line.run for block in shown for line in block.lines]
    colours = strokes(dict.fromkeys([verdict.gated, *runs] if verdict.gated in runs else runs))
    order = tuple(dict.fromkeys([*(block.scene for block in shown), *results.series]))
    return Layout(shown, colours, order, overlap_panels(results, colours, order), time_panels(results, colours, order))


def page(results: Results, verdict: Verdict, extras: Extras | None = None, courses: CourseCharts | None = None,
         laid_out: Layout | None = None, pictures: Mapping[str, Picture] | None = None, damage: list[str] | None = None,
         instants: Mapping[str, Instants] | None = None) -> str:
    """The whole page as text, with a section for each of the `extras` that the run has; `courses`: the charts over time of each
    scene; `laid_out`: its layout, where it was drawn before; `pictures`: of each scene; `damage`: what could not be used, to
    which comes what is noticed here; `instants`: when figures of our engine are largest in each scene."""
    extras, courses = extras or Extras(), {scene: charts for scene, charts in (courses or {}).items() if charts}
    damage, instants = [] if damage is None else damage, instants or {}
    shown, colours, order = (laid_out or layout(results, verdict))[:3]
    percentiles = time_percentiles(results)
    scripts = [source("gallery.js"), *([source("quantity.js"), source("courses.js")] if courses else [])]
    found = gallery.cards(results, shown, verdict, pictures or {})
    ranking, splits = ranks(shown), first_contact.splits(results)
    is_own = own_scenes.are_own(results)
    template = environment().get_template("index.html.j2")
    return labelled(linked(template.render(
        own_said=_own(results, extras, damage) if is_own else (),
        verdict=verdict, results=results, damage=damage, blocks=shown, columns=COLUMNS, strokes=colours, heads=_heads(shown),
        bound_losses=[loss for loss in verdict.losses if loss.kind in ("failed", "above bound")],
        short_answers=three_answers.three(extras.sweep, extras.steady, extras.ablation),
        bad_news=bad_news.news(results, verdict.ranked, verdict.gated, instants),
        **losses.section(results, verdict.ranked, verdict.gated, instants), **explained.section(results),
        scenes_said=scenes_sentence(verdict), kinds=(bounded := bounds_by_kind.kinds(verdict)),
        slowest_said=slowest_sentence(_slowest(results, verdict)[0], verdict.gated, *_slowest(results, verdict)[1:]).strip(),
        promised_said=bounds_by_kind.promised(bounded), loose_said=bounds_by_kind.loose(bounded),
        wider_said=bounds_by_kind.wider(bounded),
        cut_said=cut_short.sentence(results),
        loosest_said=loosest(results, verdict), not_for="" if is_own else your_project.not_for(),
        answers=() if is_own else your_project.answers(results, verdict.gated, extras.growth),
        glossary=glossary.terms(extras.sweep),
        downloads=_downloads(extras), again=_again(results.provenance),
        table_sentence=table_sentence(shown, verdict.gated, by_family(verdict.ranked, results.families)),
        cell_note=lambda cell: cell_note(cell, verdict.gated),
        absent=_absent(shown), caveat=CAVEAT, kinematic=KINEMATIC,
        ratio_sentence=ratio_sentence(), hover_notes=(*hover_notes(results), *filter(None, [gap_sentence(results)])),
        overlap_chart=summary_charts.overlaps(results, colours, verdict.gated),
        overlap_summary=overlap_summary(results, verdict.gated),
        gallery=found, gallery_said=gallery.sentence(found), gallery_families=gallery.families(found),
        gallery_js=source("gallery.js"), lost_on_card=gallery.ON_CARD,
        ranking=ranking, ranking_runs=runs_of(shown), ranking_tolerances=tolerances(),
        ranking_sentence=ranking_sentence(ranking, verdict.gated, runs_of(shown), verdict.ranked, results.families),
        policy=policy(scripts), quantity_js=source("quantity.js"), courses_js=source("courses.js"),
        course_scenes=[scene for scene in order if scene in courses], courses_said=over_all(results, verdict.gated),
        courses_data=data({"scenes": courses} | strokes_data(colours)) if courses else "",
        first_contact=first_contact.by_scene(splits), first_contact_said=first_contact.sentence(splits, verdict.gated),
        **unseen.section(results, verdict.gated),
        time_chart=summary_charts.times(percentiles, colours),
        time_summary=_times(results, verdict, percentiles),
        tunings=tunings(shown, verdict.gated), tuning_sentence=tuned.sentence,
        tuning_aims=lambda tuning: tuned.aims(results.engines, tuning.engine),
        cards=cards(results.engines), provenance=_flat(results.provenance), fairness=FAIRNESS, unlike=UNLIKE,
        machine_said=timing_words.machine(results.provenance), timing_warning=timing_words.warning(results.provenance),
        clock=(timing_words.protocol(results.provenance), *timing_words.CLOCK),
        css=(TEMPLATES / "page.css").read_text(encoding="utf-8") + dark_rules(),
        path_of=path_of, more_truths=lambda block: listed(tuple(words(metric) for metric in more_truths(results, block))),
        disagreement=_disagreement(results, verdict), ratio=ratio, **SHARED,
        drawn=_drawn(results, extras, damage, is_own),
    )))


def _times(results: Results, verdict: Verdict, percentiles: Mapping[str, Mapping[str, tuple[float, float, float]]]) -> str:
    """What the panels of frame times say together, the slowest frame of ours and of how many repeats it is the least first."""
    return time_summary(percentiles, verdict.gated, losses.best_in(verdict.ranked, results.families, COUNTED["p95"]),
                        *_slowest(results, verdict))


def _slowest(results: Results, verdict: Verdict) -> tuple[Mapping[str, float], int, int]:
    """Slowest frame of ours [us] by scene, the number of all scenes, and of how many repeats each frame is the least."""
    own = [row for row in results.rows if row.run == verdict.gated]
    slowest = [row for row in own if row.metric == "frame_time_max" and row.value is not None]
    return ({row.scenario: row.value for row in slowest if row.value is not None}, len({row.scenario for row in own}),
            max((repeats_of(row.note) for row in slowest), default=0))


def _own(results: Results, extras: Extras, damage: list[str]) -> tuple[str, ...]:
    """What stands beside the verdict of a user's own scenes."""
    found = tried(sweep.FILES, partial(own_scenes.least, results, extras.sweep), damage)
    return (*(found or ()), own_scenes.STANDS_ALONE)


def _drawn(results: Results, extras: Extras, damage: list[str], is_own: bool) -> dict[str, str]:
    """The text of each section by its name; in a run of own scenes of what it lacks there is none."""
    every = _sections(results, extras)
    empty = {section.name: "" for section in every}
    return empty | drawn([one for one in every if one.kept or not is_own], _rendered, damage, empty)


def _sections(results: Results, extras: Extras) -> tuple[Section[Any], ...]:
    """The sections that are made of files of their own; one that stands within another comes before it."""
    papers = (extras.two, extras.figure_7) if extras.two or extras.figure_7 else None
    return (
        Section("narrow", "narrow_phase.html.j2", narrow_phase.FILES, extras.narrow, _narrow),
        Section("broad", "broad_phase.html.j2", (broad_phase.ROWS,), extras.broad, broad_phase_chart.section),
        Section("two", "table_2.html.j2", table_2.FILES, extras.two, table_2_chart.section),
        Section("growth", "growth.html.j2", (growth.ROWS,), extras.growth, growth.section),
        Section("effects", "effects.html.j2", (effects.FILE,), extras.ablation, effects.section),
        Section("converging", "convergence.html.j2", (convergence.ROWS,), extras.converging, convergence.section),
        Section("sweep", "sweep.html.j2", sweep.FILES, extras.sweep, lambda kept: sweep_chart.section(kept, results)),
        Section("law_map", "law_map.html.j2", (law_map.ROWS,), extras.law_map, law_map_chart.section),
        Section("stability", "stability.html.j2", (stability.ROWS,), extras.steady, stability.section),
        Section("judge", "judge.html.j2", (judge.FILE,), extras.judge, judge.section),
        Section("close", "closeness.html.j2", closeness.FILES, extras.close, closeness.section),
        Section("paper", "paper.html.j2", (*table_2.FILES, *figure_7.FILES), papers,
                lambda kept: paper_figures.section(results, *kept) | {"two": kept[0]},
                lambda: paper_figures.section(results, None) | {"two": extras.two}),
    )


def _rendered(template: str, names: Mapping[str, object]) -> str:
    """A section as text."""
    return environment().get_template(template).render({**SHARED, **names})


DOWNLOADS = (
    "results.json", "results.csv", "summary.md", "sweep.csv", "ablation.json", "stability.csv", "judge.json", "bench.csv",
)
"""Files of figures that may stand beside the page."""


def _downloads(extras: Extras) -> tuple[str, ...]:
    """Names of the files of figures that stand beside the page; of others there is no link."""
    return tuple(name for name in DOWNLOADS if name in extras.files)


def _again(provenance: Mapping[str, object]) -> str:
    """The commands that make this run again; without the commit where the run does not know it."""
    commit, command = provenance.get("commit"), provenance.get("command")
    checkout = f"git checkout {str(commit)[:SHORT_COMMIT]} && " if commit else ""
    return f"{checkout}make setup && .venv/bin/{command}" if command else f"{checkout}make compare"


def _narrow(narrow: NarrowPhase) -> dict[str, object]:
    """What the section on single queries is made of."""
    facts = {name: value for name in ("plan", "motion", "provenance") if isinstance(value := narrow.about.get(name), Mapping)}
    return {
        "narrow_conclusion": conclusion(narrow), "narrow_panels": panels(narrow), "narrow_inks": inks(narrow),
        "narrow_factor": factor, "narrow_calls": call_costs(narrow), "narrow_start_up": start_up(narrow),
        "narrow_provenance": _flat(facts),
    }


def _heads(shown: tuple[Block, ...]) -> Mapping[str, str]:
    """The line under each column's title: the bound, and up to where it is waived."""
    ceilings = [block.ceiling for block in shown if block.ceiling is not None and block.ceiling > OVERLAP_BOUND]
    text = f"bound {limit(OVERLAP_BOUND, 'm')}"
    if ceilings:
        text += f"; waived up to {limit(max(ceilings), 'm')} in {count(len(ceilings), 'scene')}"
    heads = {column.key: "" for column in COLUMNS} | {"overlap": text, "overlap_frames": "above 1 µm"}
    for index, column in enumerate(COLUMNS):
        limits = {cell.row.limit for block in shown for line in block.lines for cell in line.cells[index : index + 1]
                  if cell.row and cell.row.limit is not None}
        if limits and column.key not in ("overlap", "truth"):
            span = " to ".join(limit(bound, column.unit) for bound in dict.fromkeys((min(limits), max(limits))))
            heads[column.key] = f"{heads[column.key]}; bound {span}".removeprefix("; ")
    return heads


def _absent(shown: tuple[Block, ...]) -> tuple[int, ...]:
    """Indices of the columns that hold no number in any scene; the page names them once instead of printing dashes."""
    return tuple(
        index for index in range(len(COLUMNS))
        if all(line.cells[index].value is None for block in shown for line in block.lines)
    )


def cards(notes: tuple[EngineNote, ...]) -> tuple[EngineCard, ...]:
    """Notes of all scenes, one card per engine and preset; what is the same in all scenes is said once."""
    grouped: dict[str, list[EngineNote]] = defaultdict(list)
    for note in notes:
        grouped[note.run].append(note)
    return tuple(_card(run, own) for run, own in grouped.items())


def _card(run: str, notes: list[EngineNote]) -> EngineCard:
    settings: dict[str, dict[tuple[str, str], list[str]]] = defaultdict(lambda: defaultdict(list))
    cannot: dict[tuple[str, str], list[str]] = defaultdict(list)
    for note in notes:
        # what became of settings in numbers is each scene's own and stands on its page
        for name, value in ((name, value) for name, value in note.settings.items() if not name.startswith(COMPILED)):
            settings[name][value].append(note.scenario)
        for said in note.cannot_say.items():
            cannot[said].append(note.scenario)

    def where(scenes: list[str]) -> str:
        return "" if len(scenes) == len(notes) else listed(tuple(dict.fromkeys(scenes)))

    return EngineCard(
        run, listed(tuple(dict.fromkeys(note.version for note in notes if note.version))),
        tuple(
            SettingLine(name, tuple((value, reason, where(scenes)) for (value, reason), scenes in values.items()))
            for name, values in settings.items()
        ),
        tuple((what, consequence, where(scenes)) for (what, consequence), scenes in cannot.items()),
    )


def _flat(raw: Mapping[str, object], prefix: str = "") -> list[tuple[str, str]]:
    """Nested provenance as (name, text), names joined by dots."""
    lines = []
    for key, value in raw.items():
        name = f"{prefix}{key}"
        if isinstance(value, Mapping):
            lines += _flat(value, f"{name}.")
        else:
            text = "unknown" if value is None else ", ".join(map(str, value)) if isinstance(value, list) else str(value)
            lines.append((name, text))
    return lines


def _disagreement(results: Results, verdict: Verdict) -> str:
    """A sentence if the file contradicts itself: exit code against rows, a pass against its own series; "" otherwise."""
    for row in verdict.passed:
        series = results.series.get(row.scenario, {}).get(row.run)
        if row.metric == "residual_overlap_max" and series and series.overlap.size and row.limit is not None:
            if not peak(series.overlap) <= row.limit:
                return (
                    f"The overlap of {row.run} in {row.scenario} passes at {quantity(row.value, 'm')}, but its series reaches "
                    f"{quantity(peak(series.overlap), 'm')}. Trust neither until this is explained."
                )
    if results.exit_code is None or results.exit_code == verdict.exit_code:
        return ""
    return (
        f"The run ended with exit code {results.exit_code}, but its rows call for {verdict.exit_code}. "
        "Trust neither until this is explained."
    )
