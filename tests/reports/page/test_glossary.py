"""The glossary has each of its words once, and explains the names that metrics have on the page."""

import numpy as np
import pytest

from avatarsim.settings import PostureSettings
from reports.page.glossary import TERMS, TUNED, terms
from reports.sections.sweep.points import Sweep
from reports.words.metric_words import WORDS
from runfiles.metrics import METRICS
from runfiles.visible_motion import SHAKES
from scenarios.measure.posture.smoothness import jitter
from tests.reports.sections.sweep.test_cheapest import point


def test_terms_are_unique_sentences() -> None:
    names = [name for terms, _ in TERMS for name in terms.split(", ")]
    assert len(names) == len(set(names)) and all(meaning.endswith(".") for _, meaning in TERMS)


def test_names_that_need_explaining_are_explained_by_the_very_words_of_the_page() -> None:
    explained = {terms for terms, _ in TERMS}
    for metric in ("residual_overlap_max", "chatter_frames", "silent_offset_frames"):
        assert WORDS[metric] in explained
    for word in ("jitter in contact", "waiting", "leap", "jump", "turn", "change of orientation"):
        assert word in explained
    assert f"({1e3 * PostureSettings().catch_up_move / 60:.0f} mm at 60 Hz as set)" in dict(TERMS)["jump"]
    assert WORDS["reversal_p95"].startswith("displacement taken back") and WORDS["jerk_ratio"].startswith("roughness of motion")


def test_jitter_is_told_as_it_is_measured_larger_motions_clipped() -> None:
    """One event of 90 mm in 16 frames counts as 3 mm in one of them, and decides the figure."""
    most, frames = SHAKES / 60.0, 16
    reversed_by = np.zeros((frames, 1))
    reversed_by[5] = 0.09
    target = np.zeros((frames + 1, 1, 3))
    assert jitter(reversed_by, target, np.ones(frames, dtype=bool), 1.0 / 60.0) == pytest.approx(most / np.sqrt(frames))
    said = dict(TERMS)[WORDS["jitter_rms"]]
    assert f"slower than {SHAKES} m/s" in said and f"{1e3 * most:g} mm at 60 Hz" in said and "not left out" in said
    assert "one such event decides" in said and "below what counts as shaking" not in said + METRICS["jitter_rms"][1]


def test_default_and_tuned_are_what_they_are_here() -> None:
    assert "documented defaults" not in str(TERMS) and "best settings" not in str(TERMS)
    assert "a weld per link; PyBullet: a constraint of the root and a motor per joint" in dict(TERMS)["default"]
    assert terms(None) == terms(Sweep(())) == TERMS
    found = Sweep((point("m/tuned", 1e-3, 100.0), point("m/tuned dt=1/60", 1e-3, 50.0)))
    assert dict(terms(found))[TUNED].endswith(
        "by a setting of their own sweep: m/tuned in 1 scene; 1 of 1 by one that is as near to a free user too: the list stands "
        "under Accuracy against time.")
