"""The page is whole, fetches nothing, shows text from outside as text, and survives whatever a run leaves behind."""

import re
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports import write_report
from runfiles.like_for_like import AVATAR
from tests.reports.conftest import row

Json = dict[str, object]
Write = Callable[[object], Path]
VOID = {"meta", "link", "input", "wbr", "path", "line", "rect", "br", "circle"}


class Tree(HTMLParser):
    """Collects ids, links and pictures, and checks that every tag is closed in order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.links: list[str] = []
        self.pictures: list[dict[str, str | None]] = []
        self.tags: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        named = dict(attrs)
        self.ids += [str(named["id"])] if "id" in named else []
        self.links += [str(named[key]) for key in ("href", "src", "xlink:href") if key in named]
        self.pictures += [named] if tag == "svg" else []
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID:
            assert self.open.pop() == tag


def written(folder: Path) -> tuple[str, Tree]:
    write_report(folder)
    text = (folder / "index.html").read_text(encoding="utf-8")
    tree = Tree()
    tree.feed(text)
    assert tree.open == []
    return text, tree


def test_the_page_is_whole_and_self_contained(run_dir: Write, results: Json) -> None:
    text, tree = written(run_dir(results))
    assert len(tree.ids) == len(set(tree.ids))
    pages = {f"scenes/{scene}.html" for scene in ("arm_wall", "hand_over_table", "ball_drop")}
    files = {"results.json", "summary.md"}
    assert {link for link in tree.links if not link.startswith(("#", "data:"))} == pages | files
    assert {link[1:] for link in tree.links if link.startswith("#")} <= set(tree.ids)
    assert not tree.tags & {"iframe", "img", "object"}
    assert text.count("<script>") == text.count("sha256-") == 3
    assert "url(" not in text and "@import" not in text
    assert len(text) < 300_000


def test_every_picture_has_words(run_dir: Write, results: Json) -> None:
    _, tree = written(run_dir(results))
    charts = [picture for picture in tree.pictures if picture.get("aria-hidden") != "true"]
    assert len(charts) == 3 and all(len(str(picture["aria-label"])) > 40 for picture in charts)


def test_sections_stand_in_order(run_dir: Write, results: Json) -> None:
    text, _ = written(run_dir(results))
    parts = ("1 of 3 checks", "Where other engines are better</h2>", "Accuracy against time</h2>",
             "Are only the effects simulated that a scene calls for? (avatarsim only)</h2>",
             "Do hard cases stay numerically stable?</h2>",
             "Scenes</h2>", "Ranking</h2>", "Overlap in all scenes</h2>", "Over the time of a scene</h2>", "Frame times</h2>",
             "The paper's figures beside ours</h2>",
             "Restitution and friction: asked and obtained</h2>", "All figures of the table</h2>",
             "May the judge be trusted?</h2>",
             "Settings as run", "Provenance and fairness</h2>",
             "it meets simulated bodies with a coupled mass", "Abacus 9")
    places = [text.index(part) for part in parts]
    assert places == sorted(places)
    assert "quarter of a frame" in text and "bounces follow solref" in text


def test_every_section_has_a_link_at_the_top(run_dir: Write, results: Json) -> None:
    text, tree = written(run_dir(results))
    sections = re.findall(r"<section\b([^>]*)>", text)
    ids = [found[1] for attributes in sections if (found := re.search(r'\bid="([^"]+)"', attributes))]
    assert len(ids) == len(sections) > 10
    nav = text.split('<nav aria-label="Sections">')[1].split("</nav>")[0]
    assert re.findall(r'href="#([^"]+)"', nav) == ids
    assert all(words.strip() for words in re.findall(r">([^<]*)</a>", nav))


def test_no_panel_per_scene_stands_in_the_index(run_dir: Write, results: Json) -> None:
    """They stand on the pages of the scenes, and the index has one chart of each kind for all."""
    folder = run_dir(results)
    text, _ = written(folder)
    assert text.count('<figure class="plot alone">') == 2
    scene = (folder / "scenes" / "arm_wall.html").read_text(encoding="utf-8")
    part = scene.split('id="panels"')[1].split("</section>")[0]
    assert part.count("<figure") == 2 and "mujoco/default reaches 4.00 mm" in part and "has the lowest p95" in part


def test_text_from_outside_stays_text(run_dir: Write, results: Json) -> None:
    text, _ = written(run_dir(results | {"notes": ["<script>alert(1)</script>"]}))
    assert "<mesh>" not in text and "&lt;mesh&gt; &amp; volume" in text and "<script>alert" not in text


def test_a_file_that_contradicts_itself_is_called_out(run_dir: Write, results: Json) -> None:
    assert "Trust neither" not in written(run_dir(results))[0]
    assert "exit code 0, but its rows call for 1" in written(run_dir(results | {"exit_code": 0}))[0]
    series = {"arm_wall": {"avatarsim/default": {"overlap_m": [0.0, 0.5]}}}
    assert "its series reaches 500 mm" in written(run_dir(results | {"series": series}))[0]


@pytest.mark.parametrize("cut", ["series", "engines", "provenance", "all"])
def test_whatever_is_missing_the_page_stands(run_dir: Write, results: Json, cut: str) -> None:
    empty: Json = {"series": {}, "engines": [], "provenance": {}}
    text, _ = written(run_dir(results | (empty if cut == "all" else {cut: empty[cut]})))
    assert "1 of 3 checks" in text


def test_without_a_row_there_is_no_page(run_dir: Write, results: Json) -> None:
    folder = run_dir(results | {"rows": []})
    with pytest.raises(InvalidFile, match="rows of"):
        write_report(folder)
    assert [path.name for path in folder.iterdir()] == ["results.json"]


def test_without_a_gated_row_there_is_no_verdict(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    text, _ = written(run_dir(results | {"rows": [row for row in rows if row["engine"] == "mujoco" and row["value"]]}))
    assert "No verdict" in text and 'class="verdict empty"' in text


def test_one_engine_alone_has_nobody_to_beat(run_dir: Write, results: Json) -> None:
    rows, series = results["rows"], results["series"]
    assert isinstance(rows, list) and isinstance(series, dict)
    alone = [row for row in rows if row["engine"] == "avatarsim"]
    own = {scene: {"avatarsim/default": runs["avatarsim/default"]} for scene, runs in series.items()}
    text, _ = written(run_dir(results | {"rows": alone, "series": own, "engines": []}))
    assert "has no other engine to be compared with" in text
    assert "no other engine did better" not in text


def test_every_value_nan_or_missing_is_never_held(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    for value in ("NaN", None, "Infinity"):
        text, _ = written(run_dir(results | {"rows": [row | {"value": value} for row in rows]}))
        assert 'class="verdict passed"' not in text


def test_damaged_results_cost_nothing_that_was_written_before(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    write_report(folder)
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file() and path.name != "results.json"}
    (folder / "results.json").write_text("{")
    with pytest.raises(InvalidFile):
        write_report(folder)
    after = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file() and path.name != "results.json"}
    assert after == before and len(before) == 6


def test_a_folder_of_somebody_else_keeps_its_page(tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text("mine")
    with pytest.raises(InvalidFile):
        write_report(tmp_path)
    assert (tmp_path / "index.html").read_text() == "mine"


def test_the_caveat_stands_under_the_heading_of_the_table(run_dir: Write, results: Json) -> None:
    text, _ = written(run_dir(results))
    assert text.index("Ranking</h2>") < text.index("our avatar is kinematic") < text.index('<table class="matrix ranking">')
    assert 'class="sideways"' in text


def test_whoever_holds_bodies_apart_is_named_under_the_overlap(run_dir: Write, results: Json) -> None:
    """Only a length above zero is one, our own stand-off counts as well, and no link hovers in a scene without an avatar."""
    lengths = (("mujoco", "margin", 0.004), ("pybullet", "collision_margin", 0.001), ("mine", "stand_off", 2e-4))
    engines = [{"name": name, "preset": "tuned", "scenario": scene, "settings": {key: [value, "some reason"]}}
               for name, key, value in lengths for scene in ("arm_wall", "ball_drop")]
    rows = [*results["rows"], row("arm_wall", "mujoco/tuned", AVATAR, 0.1, "m")]  # type: ignore[misc]
    text, _ = written(run_dir(results | {"engines": engines, "rows": rows}))
    part = text.split('id="overlap"')[1].split("</section>")[0]
    assert "mujoco/tuned keeps a contact margin of 4 mm in 1 scene with an avatar: its links hover" in part
    assert "mine/tuned keeps a stand-off of 200 µm" in part and "pybullet/tuned keeps" not in part


def test_only_files_that_are_there_are_offered(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    (folder / "bench.csv").write_text("", encoding="utf-8")
    write_report(folder)
    found = (folder / "index.html").read_text(encoding="utf-8")
    assert all(f'<a href="{name}" download>' in found for name in ("results.json", "summary.md", "bench.csv"))
    assert all(f'href="{name}"' not in found for name in ("judge.json", "ablation.json", "sweep.csv", "results.csv"))
