"""A report is complete: its pages exist, link to each other, fetch nothing and show no raw word for a missing number."""

import base64
import hashlib
import json
import math
import re
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from reports.pages.index import slow
from tests.reports.pages.reading import Page, data_of, read
from tests.reports.small_runs import MUJOCO, OURS, figure, run_of

RAW_WORDS = {"nan", "inf", "-inf", "None", "null", "undefined", "<NA>", "NaT"}
LARGEST = 3_000_000
SCENES = ("arm_wall", "hand_over_table", "ball_drop")


@pytest.fixture(scope="session")
def pages(report: Path) -> dict[str, Page]:
    """Return all pages by path."""
    return {str(path.relative_to(report)): read(path) for path in sorted(report.rglob("*.html"))}


def test_a_page_for_each_question_and_scene(pages: dict[str, Page], report: Path) -> None:
    beside = {"index.html", "method.html", "engines.html", "glossary.html", "bench.html"}
    assert set(pages) == beside | {f"scenes/{name}.html" for name in SCENES}
    assert all((report / name).stat().st_size for name in ("summary.md", "junit.xml"))
    assert (report / "index.html").stat().st_size < LARGEST
    assert not list(report.rglob("*.part")) and not list(report.rglob(".*"))


def test_tags_are_closed_and_ids_are_unique(pages: dict[str, Page]) -> None:
    for name, page in pages.items():
        assert page.unclosed == [] and len(set(page.ids)) == len(page.ids), name


def test_every_link_leads_somewhere_and_every_page_is_linked(pages: dict[str, Page], report: Path) -> None:
    linked = set()
    for name, page in pages.items():
        for _, _, address in page.links:
            parts = urlsplit(address)
            if parts.scheme == "data":
                continue
            assert not parts.scheme and not parts.netloc, (name, address)
            target = ((report / name).parent / unquote(parts.path)).resolve() if parts.path else (report / name).resolve()
            assert target.is_relative_to(report.resolve()) and target.is_file(), (name, address)
            path = str(target.relative_to(report.resolve()))
            if parts.fragment and not parts.fragment.startswith(("t=", "only=")):
                assert parts.fragment in pages[path].ids, (name, address)
            linked.add(path)
    assert set(pages) <= linked


def test_nothing_is_fetched_from_a_network(pages: dict[str, Page]) -> None:
    for name, page in pages.items():
        assert page.policy.startswith("default-src 'none'") and "http" not in page.policy and "*" not in page.policy, name
        for tag, attribute, address in page.links:
            assert not re.match(r"\s*(\w+:)?//", address), (name, tag, attribute, address)
            beside = (tag, attribute) == ("script", "src") and address.startswith("../lib/")
            assert tag == "a" or address.startswith("data:") or beside, (name, tag, address)


def test_only_scripts_of_the_policy_are_in_a_page(pages: dict[str, Page]) -> None:
    for name, page in pages.items():
        for kind, text in page.scripts:
            if text and kind in ("", "module", "text/javascript"):
                digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
                assert f"'sha256-{digest}'" in page.policy, name
            elif kind == "application/json":
                json.loads(text)


def test_no_cell_shows_a_raw_word_for_a_missing_number(pages: dict[str, Page]) -> None:
    shown = 0
    for name, page in pages.items():
        shown += len(page.cells)
        for cell in page.cells:
            words = cell.split()
            # a definition may mention infinity; a figure has a value, a unit and a mark
            assert len(words) > 3 or not RAW_WORDS & set(words), (name, cell)
    assert shown > 100


def test_charts_that_a_page_names_are_in_its_data(report: Path) -> None:
    for name in ("index.html", *(f"scenes/{scene}.html" for scene in SCENES)):
        [data] = data_of(report / name)
        named = set(re.findall(r'data-chart="(\w+)"', (report / name).read_text(encoding="utf-8")))
        tokens = set(re.findall(r'"@(\w+)"', json.dumps(data["specs"])))
        assert named == set(data["specs"]) and bool(named) == bool(tokens) == (name != "scenes/ball_drop.html"), name
        assert all(tokens <= set(colours) for colours in data["palette"].values()), name


def test_only_the_recorded_scene_has_replay_and_stills(report: Path) -> None:
    found = {}
    for scene in SCENES:
        [data] = data_of(report / f"scenes/{scene}.html")
        found[scene] = data["replay"] is not None
    assert found == {"arm_wall": True, "hand_over_table": False, "ball_drop": False}
    [data] = data_of(report / "index.html")
    assert set(data["stills"]) == {"arm_wall"}


def test_slow_scenes_are_those_whose_tail_is_beyond_the_limit() -> None:
    times = {"a": (2001.0, 9000.0), "b": (1999.0, 9e5), "c": (3000.0, None), "d": (math.nan, 1.0)}
    metrics = ("frame_time_p95", "frame_time_max")
    rows = [figure(scene, OURS, metrics[k], time) for scene, pair in times.items() for k, time in enumerate(pair)]
    found = slow(run_of([*rows, figure("e", MUJOCO, metrics[0], 1e5)]))
    assert [(row.scenario, row.value) for row in found] == [("c", 3000.0), ("a", 2001.0)]
    assert math.isnan(found[0].slowest) and found[1].slowest == 9000.0
