"""No sentence about times describes another protocol than that of the run whose times they are."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.counters import STAGES
from reports import write_report
from reports.__main__ import README
from reports.deciding.columns import COLUMNS
from reports.page.index import FAIRNESS, UNLIKE
from reports.words import timing_words
from runfiles.metrics import METRICS
from runfiles.timing_protocol import REPEATS
from scenarios.results.machine import Meter
from scenarios.running.timing import timing_facts

Json = dict[str, object]
Write = Callable[[object], Path]
OTHER = {"repeats": 7, "warm_frames": 11, "tail_frames": 333, "phase_frames": 13}
"""A protocol unlike the one in force, as an older or a newer version may have left it."""
SAYS = re.compile(r"(\d+) (?:repeats|times,)|from (\d+) x|first (\d+) frames|up to (\d+) frames")
"""Where a sentence states a number of the protocol."""


def numbers(text: str) -> list[int]:
    return [int(next(filter(None, found))) for found in SAYS.findall(text)]


def with_record(results: Json, **timing: object) -> Json:
    provenance = results["provenance"]
    assert isinstance(provenance, dict)
    return results | {"provenance": provenance | {"timing": timing}}


def page(folder: Path) -> str:
    write_report(folder)
    return (folder / "index.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("protocol", [OTHER, timing_facts(Meter())], ids=["another", "in force"])
def test_the_page_describes_the_protocol_of_its_run_and_no_other(run_dir: Write, results: Json, protocol: Json) -> None:
    text = page(run_dir(with_record(results, **protocol)))
    sentence = timing_words.protocol({"timing": protocol})
    assert sentence in text and sentence != timing_words.UNSAID
    assert numbers(sentence) == [protocol["warm_frames"], protocol["repeats"], protocol["repeats"]]
    assert f"{protocol['repeats']} x {protocol['tail_frames']} frames" in sentence
    # nothing else on the page states a number of it
    assert numbers(text.replace(sentence, "")) == []


def test_a_median_time_says_how_it_was_taken_on_both_pages(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    note = {"note": "3 x 200 frames, 30 warm-up frames; moving 40 us, resting 3 us"}
    folder = run_dir(results | {"rows": [row | note if row["metric"] == "frame_time_p50" else row for row in rows]})
    said = "<small>3 x 200 frames; moving 40 µs, resting 3 µs</small>"
    texts = [page(folder), (folder / "scenes" / "arm_wall.html").read_text(encoding="utf-8")]
    assert [text.replace("\u00a0", " ").count(said) for text in texts] == [8, 4]


def test_words_that_no_run_has_changed_state_no_number_of_it() -> None:
    assert numbers(" ".join((*FAIRNESS, *UNLIKE, *(column.meaning for column in COLUMNS)))) == []


def test_metrics_and_readme_state_the_numbers_in_force() -> None:
    force = timing_facts(Meter())
    said = " ".join(meaning for name, (_, meaning) in METRICS.items() if name.startswith("frame_time") or name == "warmup")
    assert set(numbers(said)) == {REPEATS, force["warm_frames"]}
    assert f"from {REPEATS} x {force['tail_frames']} frames on" in said and f"{force['phase_frames']} of these" in said
    for text in re.findall(r"(\d+) (?:repeats|x \d+ frames)", README.read_text(encoding="utf-8")):
        assert int(text) == REPEATS


@pytest.mark.parametrize("timing", [{}, {"repeats": "many"}, {**OTHER, "tail_frames": None}])
def test_a_run_without_a_record_says_so(run_dir: Write, results: Json, timing: Json) -> None:
    text = page(run_dir(with_record(results, **timing)))
    assert timing_words.UNSAID in text and numbers(text) == []
    assert timing_words.protocol({"timing": "fast"}) == timing_words.UNSAID


def test_the_machine_is_described_as_far_as_it_is_known() -> None:
    full = {"mhz": 2445, "mhz_max": 3500, "busy_elsewhere": 0.05, "load_before": [1.5, 1.0, 1.0], "load_after": [1.25, 1.0, 1.0]}
    assert timing_words.machine({"timing": full}) == (
        "While frames were timed, the clock was 2445 MHz (3500 MHz at most); other work kept 0.05 processors busy; "
        "the load average of a minute was 1.5 before and 1.25 after (it counts this run's own processes too: those that measured "
        "accuracy before, and those that are timed and wait)."
    )
    said = timing_words.machine({"timing": {"mhz": 2445, "mhz_max": None, "busy_elsewhere": None, "load_before": None}})
    assert said == "While frames were timed, the clock was 2445 MHz (its highest is not told)."
    assert timing_words.machine({}) == timing_words.machine({"timing": OTHER}) == ""


@pytest.mark.parametrize(("busy", "warned"), [(None, False), (0.0, False), (timing_words.BUSY, False), (0.26, True), (1.7, True)])
def test_times_beside_other_work_carry_a_warning(run_dir: Write, results: Json, busy: float | None, warned: bool) -> None:
    text = page(run_dir(with_record(results, **OTHER, busy_elsewhere=busy)))
    assert ("times may be too long" in text) == warned == bool(timing_words.warning({"timing": {"busy_elsewhere": busy}}))


def test_what_the_clock_covers_is_what_it_is_read_round() -> None:
    covers = timing_words.CLOCK[0]
    assert f"({', '.join(('posture', 'motion', 'coupling'))})" in covers and set(STAGES) == {"posture", "motion", "coupling"}
    for engine, call in (("in_mujoco", "mj_step"), ("in_pybullet", "stepSimulation")):
        lines = (README.parent / "reference" / engine / "engine.py").read_text(encoding="utf-8").splitlines()
        # MuJoCo's once step by step, once for all steps of a frame
        places = [k for k, line in enumerate(lines) if f".{call}(" in line]
        assert call in covers and len(places) == 1 + (call == "mj_step")
        for place in places:
            assert "perf_counter_ns()" in lines[place - 1] and "perf_counter_ns()" in lines[place + 1]
