"""Pages of cleaned clips in a browser: opened from disk they report no error, request nothing, draw, play, lead to moments.

Not part of `make test`, which needs no browser: `make look` runs it on clips made here, and leaves screenshots in
reports/out/look/ for inspection.
"""

import json
from pathlib import Path
from typing import Any

import pytest

from avatarsim.cli import main
from tests.clips.made import bvh, csv, robot
from tests.look.browser import Browser
from tests.look.conftest import SCREENSHOTS
from tests.look.shown_pages import COLOURS, PICTURE, SHOWN

OVERLAPS = "document.querySelector('.view').classList.contains('overlaps')"
PLAY = "document.querySelector('[data-part=play]').click()"
HOSTILE = "</script><script>document.title='taken'</script>.bvh"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return cleaned clips: of a figure that enters the floor in the middle, one in a folder, one with a script as its name, and
    one of a robot; with a file that is no clip."""
    base = tmp_path_factory.mktemp("look")
    bvh(base / "in" / "sinks.bvh", frames=40)
    bvh(base / "in" / "deep" / "er" / "free.bvh", frames=6, sinks=-0.3)
    bvh(base / "in" / HOSTILE.replace("/", "_"), frames=8, seed=1)
    (base / "in" / "cut.bvh").write_text("HIERARCHY")
    assert main(["clean", str(base / "in"), "--room", "floor", "-o", str(base / "out"), "--workers", "0"]) == 3
    robot_clip = [str(csv(base / "robot.csv")), "--avatar", str(robot(base)), "--room", "floor"]
    assert main(["clean", *robot_clip, "-o", str(base / "out"), "--workers", "0"]) == 0
    return base / "out"


def quiet(one: Browser, page: Path) -> None:
    """Check that the console is empty, only the page's own address is requested, and nothing is wider than the window."""
    assert one.errors == []
    assert [asked for asked in one.requests if not asked.endswith((page.resolve().as_uri(), "/out/pages/three.js"))] == []
    assert one.value("document.documentElement.scrollWidth <= window.innerWidth")
    assert one.value("document.title") != "taken"


def test_the_summary_leads_to_every_clip_and_back(folder: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    one.open(folder / "index.html")
    quiet(one, folder / "index.html")
    links = one.value("[...document.querySelectorAll('tbody a')].map((one) => decodeURIComponent(one.getAttribute('href')))")
    clips: list[dict[str, Any]] = json.loads((folder / "certificate.json").read_text())["clips"]
    assert links == [f"pages/{clip['motion']}.html" for clip in clips] and len(links) == 4
    one.picture(SCREENSHOTS / f"clips-index-{name}.png")
    for link in links:
        one.open(folder / link)
        assert one.value("new URL(document.querySelector('a').href).pathname").endswith("/out/index.html")
        quiet(one, folder / link)


def test_a_clip_opens_at_its_deepest_moment(folder: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    page = folder / "pages" / "sinks.bvh.html"
    one.open(page)
    one.until(f"{SHOWN} > 0")
    clip = json.loads((folder / "certificates" / "sinks.bvh.json").read_text())
    assert clip["overlap"]["before"]["frames"] > 0
    assert one.value(f"{SHOWN} === Number(document.querySelector('.moments button').dataset.worst)")
    assert one.value(OVERLAPS)
    for shown in (f"!{OVERLAPS}", OVERLAPS):
        one.value("document.querySelector('[data-part=ghost]').click()")
        one.until(shown)
    assert one.value(COLOURS) > 30
    # both figures, the room, and the time line with overlaps in red in the row above and nowhere in the one below
    red = one.value("[...document.querySelectorAll('#line .red')].map((one) => one.getAttribute('y'))")
    assert red and set(red) == {"4"}
    quiet(one, page)
    one.picture(SCREENSHOTS / f"clips-clip-{name}.png")


def test_a_clip_plays_and_is_led_by_slider_keys_and_line(folder: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    page = folder / "pages" / "sinks.bvh.html"
    one.open(folder / "index.html")
    one.open(page, "#t=0.1")
    one.until(f"{SHOWN} === 3")
    assert not one.value(OVERLAPS)
    one.value(PLAY)
    one.until(f"{SHOWN} > 8")
    one.value(PLAY)
    assert one.value("document.getElementById('replay').dataset.state") == "paused"
    one.press(["End"])
    bar = "document.querySelector('[data-part=bar]')"
    one.until(f"{SHOWN} === 39 && {bar}.value === '39'")
    one.press(["ArrowLeft", "ArrowLeft"])
    one.until(f"{SHOWN} === 37")
    one.value(f"(() => {{ {bar}.value = 11; {bar}.dispatchEvent(new Event('input')); }})()")
    one.until(f"{SHOWN} === 11")
    box = "document.getElementById('line').getBoundingClientRect()"
    click = f"new MouseEvent('click', {{clientX: {box}.left + {box}.width * 0.51}})"
    one.value(f"document.getElementById('line').dispatchEvent({click})")
    one.until(f"{SHOWN} === 20")
    assert one.value("document.getElementById('now').getAttribute('x')") == "20"
    # plays to the end, and again from the start
    one.press(["End"])
    one.press(" ")
    one.until(f"{SHOWN} < 30 && {SHOWN} > 0")
    quiet(one, page)


def test_parts_are_drawn_as_chosen_and_free_clips_not_red(folder: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    page = folder / "pages" / "robot.csv.html"
    one.open(page)
    one.until(f"{SHOWN} >= 0")
    one.value("document.querySelector('[data-worst]')?.click()")
    pictures = [one.value(PICTURE)]
    for part in ("data-part=tested", "data-part=room", "data-view='0'", "data-part=ghost"):
        one.value(f"document.querySelector(\"[{part}]\").click()")
        pictures.append(one.value(PICTURE))
    assert len(set(pictures)) == 5
    # the lines on the ground remain
    lines = one.value(COLOURS)
    one.value("document.querySelector('[data-view]').click()")
    assert 1 < lines < one.value(COLOURS)
    quiet(one, page)
    one.open(folder / "pages" / "deep" / "er" / "free.bvh.html")
    one.until(f"{SHOWN} >= 0")
    assert one.value("document.querySelectorAll('#line .red, #line .chord').length") == 0


def test_the_view_turns_by_dragging(folder: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    page = folder / "pages" / "sinks.bvh.html"
    one.open(page)
    one.until(f"{SHOWN} > 0")
    before = one.value(PICTURE)
    left, top = (one.value(f"document.querySelector('.stage').getBoundingClientRect().{side}") for side in ("left", "top"))
    for kind, x in (("Pressed", 60), ("Moved", 130), ("Released", 130)):
        one.mouse(kind, left + x, top + 60)
    assert one.value(PICTURE) != before
    quiet(one, page)
