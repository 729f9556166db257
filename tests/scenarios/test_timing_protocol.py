"""What the page says of the timing protocol is what ran: the run writes the sentence from the constants that the pass reads."""

import re

import pytest

from reports.page import FAIRNESS, timing_sentences
from scenarios import glance, timing
from scenarios.measure import timing as measure
from scenarios.timing_protocol import protocol_said


@pytest.mark.parametrize(("at_a_glance", "full"), [(True, False), (False, False), (False, True)])
def test_every_number_of_the_sentence_is_a_constant_of_the_pass(at_a_glance: bool, full: bool) -> None:
    said = protocol_said(at_a_glance, full)
    numbers = {float(number) for number in re.findall(r"\d+(?:\.\d+)?", said)} - {99.0}
    shared = {measure.REPEATS, timing.MOST_FRAMES, measure.ENOUGH_FRAMES}
    if at_a_glance:
        own = {glance.WARM_GLANCE, 1, glance.LEAST, glance.MOST, glance.EACH_ROUND, timing.ENOUGH}
    else:
        own = {timing.WARM_FRAMES} | (set() if full else {timing.ENOUGH})
    assert numbers == shared | own


def test_the_page_says_what_the_run_says_and_no_other_protocol() -> None:
    said = protocol_said(True, False)
    cpus = {"cpus": 2}
    assert timing_sentences({"timing": {"protocol": said, "load_after": 1.2}, **cpus}) == (said,)
    busy = timing_sentences({"timing": {"protocol": said, "load_after": 5.5}, **cpus})
    assert busy[0] == said and "5.5 processes" in busy[1]
    assert timing_sentences({}) == ("The run does not say by which protocol it timed.",)
    assert not any(re.search(r"repeat|warm", sentence) for sentence in FAIRNESS)
