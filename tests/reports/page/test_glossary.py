"""The glossary has each of its words once, and explains the names that metrics have on the page."""

from avatarsim.settings import PostureSettings
from reports.page.glossary import TERMS, TUNED, terms
from reports.sections.sweep.points import Sweep
from reports.words.metric_words import WORDS
from runfiles.visible_motion import SHAKES
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
    assert f"{1e3 * SHAKES / 60:g} mm a frame at 60 Hz ({SHAKES} m/s)" in dict(TERMS)[WORDS["jitter_rms"]]
    assert f"({1e3 * PostureSettings().catch_up_move / 60:.0f} mm at 60 Hz as set)" in dict(TERMS)["jump"]
    assert WORDS["reversal_p95"].startswith("displacement taken back") and WORDS["jerk_ratio"].startswith("roughness of motion")


def test_default_and_tuned_are_what_they_are_here() -> None:
    assert "documented defaults" not in str(TERMS) and "best settings" not in str(TERMS)
    assert "a weld per link; PyBullet: a constraint of the root and a motor per joint" in dict(TERMS)["default"]
    assert terms(None) == terms(Sweep(())) == TERMS
    found = Sweep((point("m/tuned", 1e-3, 100.0), point("m/tuned dt=1/60", 1e-3, 50.0)))
    assert dict(terms(found))[TUNED].endswith(
        "by a setting of their own sweep: m/tuned in 1 scene; 1 of 1 by one that is as near to a free user too: the list stands "
        "under Accuracy against time.")
