"""The glossary has each of its words once, and explains the names that metrics have on the page."""

from reports.glossary import TERMS
from reports.metric_words import WORDS


def test_terms_are_unique_sentences() -> None:
    names = [name for terms, _ in TERMS for name in terms.split(", ")]
    assert len(names) == len(set(names)) and all(meaning.endswith(".") for _, meaning in TERMS)


def test_names_that_need_explaining_are_explained_by_the_very_words_of_the_page() -> None:
    explained = {terms for terms, _ in TERMS}
    for metric in ("residual_overlap_max", "chatter_frames", "silent_offset_frames"):
        assert WORDS[metric] in explained
    assert WORDS["reversal_p95"].startswith("displacement taken back") and WORDS["jerk_ratio"].startswith("roughness of motion")
