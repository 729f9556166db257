"""The glossary has each of its words once, and explains the names that metrics have on the page."""

from avatarsim.settings import PostureSettings
from reports.glossary import TERMS
from reports.metric_words import WORDS
from scenarios.measure.smoothness import SHAKES


def test_terms_are_unique_sentences() -> None:
    names = [name for terms, _ in TERMS for name in terms.split(", ")]
    assert len(names) == len(set(names)) and all(meaning.endswith(".") for _, meaning in TERMS)


def test_names_that_need_explaining_are_explained_by_the_very_words_of_the_page() -> None:
    explained = {terms for terms, _ in TERMS}
    for metric in ("residual_overlap_max", "chatter_frames", "silent_offset_frames"):
        assert WORDS[metric] in explained
    for word in ("jitter in contact", "waiting", "leap", "jump", "turn"):
        assert word in explained
    assert f"{1e3 * SHAKES / 60:g} mm a frame at 60 Hz ({SHAKES} m/s)" in dict(TERMS)[WORDS["jitter_rms"]]
    assert f"({1e3 * PostureSettings().catch_up_move / 60:.0f} mm at 60 Hz as set)" in dict(TERMS)["jump"]
    assert WORDS["reversal_p95"].startswith("displacement taken back") and WORDS["jerk_ratio"].startswith("roughness of motion")
