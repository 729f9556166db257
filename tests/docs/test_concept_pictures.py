"""Pictures of the concepts: those that are kept are those that the program draws."""

import xml.etree.ElementTree as ET

import pytest

from docs.concept_pictures import FOLDER, PICTURES, svg_of


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_is_drawn_anew_as_it_is_kept(name: str) -> None:
    kept = (FOLDER / f"{name}.svg").read_text(encoding="utf-8")
    assert kept == svg_of(name) and ET.fromstring(kept).tag.endswith("svg")
