"""The report in a browser: opened from disk it reports no error, requests nothing, draws everything and plays.

Not part of `make test`, which needs no browser: `make look` runs it on a small run made by hand and on the last run, and leaves
screenshots in reports/out/look/ for inspection.
"""

import html
import json
import re
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy
import pytest
from PIL import Image, ImageSequence

from reports import write_report
from tests.look import shown_pages as pages
from tests.look.browser import Browser
from tests.look.conftest import SCREENSHOTS

OUT = Path(__file__).resolve().parents[2] / "reports" / "out"
TALLEST = 6_000
"""Largest height [px] of the index of a full run that is still read to its end, at the width of `wide`."""
LARGEST_GIF = 20_000_000
"""Bytes of the largest moving picture of a whole scene that can still be sent."""
STRIPS = ("overlap", "bounce", "limits", "time")


@pytest.fixture(scope="module", params=["by hand", "last"])
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a report: made here, and the last run's if it has recordings."""
    last = OUT / "latest"
    if request.param == "by hand" or not (last / "scenes").exists():
        return pages.by_hand(tmp_path_factory.mktemp("look") / "run")
    write_report(last)
    return last


def test_the_index_draws_all_its_charts(run: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    page = run / "index.html"
    pages.show(one, page)
    assert set(one.value("Object.keys(views)")) >= {*STRIPS, "settings", "hard", "effects", "losses"}
    assert one.value(pages.BLANK) == []
    if name.startswith("wide"):
        assert one.value("document.documentElement.scrollHeight") < TALLEST
    one.picture(SCREENSHOTS / f"index-{run.name}-{name}.png")
    pages.quiet(one, page)


def test_pages_beside_it_are_quiet_and_links_lead_somewhere(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    for page in [*sorted(run.glob("*.html")), pages.scenes(run)[0]]:
        one.open(page)
        time.sleep(0.5)
        links = one.value("[...document.querySelectorAll('a[href]')].map((one) => one.getAttribute('href'))")
        assert links
        for path, _, place in (link.partition("#") for link in links if not link.startswith("https:")):
            assert not path or (page.parent / path).exists(), path
            assert path or not place or one.value(f"Boolean(document.getElementById({place!r}))"), place
        pages.quiet(one, page)


def answer(settings: Sequence[Mapping[str, Any]], engine: str, level: float) -> Mapping[str, Any] | None:
    """Return the cheapest measured setting of an engine; of times within 3 % the simplest to copy."""
    able = [one for one in settings if one["engine"] == engine and one["measured"] and one["error"] is not None]
    able = sorted((one for one in able if one["error"] <= level), key=lambda one: float(one["median"]))
    alike = [one for one in able if one["median"] <= 1.03 * able[0]["median"]]
    return max(alike, key=lambda one: (one["setting"] in ("default", "tuned"), one["preset"], one["alone"]), default=None)


def test_scene_and_accuracy_change_the_answers(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    pages.show(one, run / "index.html")
    settings, told = one.value("page.settings"), set()
    for name in list(settings)[:4]:
        pages.choose(one, "scene", name)
        engines = list(dict.fromkeys(each["engine"] for each in settings[name]))
        for number, level in enumerate((1e-2, 1e-3, 1e-4, 1e-6)):
            one.value(f"document.querySelectorAll('[data-level]')[{number}].click()")
            pressed = one.value("[...document.querySelectorAll('[data-level]')].map((one) => one.ariaPressed)")
            assert pressed == [str(k == number).lower() for k in range(4)]
            rows = one.value(
                "[...document.getElementById('cheapest-rows').rows].map((r) => [...r.cells].map((c) => c.innerText))"
            )
            for engine, cells in zip(engines, rows, strict=True):
                best = answer(settings[name], engine, level)
                if best is None:
                    assert cells[2:6] == ["–"] * 4, (name, engine, level)
                    continue
                expected = [best["setting"], *(best["shown"][figure] for figure in ("median", "p95", "slowest", "error"))]
                # times that do not compare engines are in brackets
                shown = [cell.removesuffix(" asleep").strip("()") for cell in cells[1:6]]
                assert shown == expected, (name, engine, level)
            told.add(json.dumps(rows))
            one.value("views.settings.runAsync().then(() => 0)")
            assert one.value("views.settings.data('limit')[0].place") == max(level, 1e-7)
        drawn = one.value("views.settings.data('points').map((one) => one.text)")
        assert drawn == [each["shown"]["error"] for each in settings[name] if each["measured"]]
    assert len(told) > 2 and one.errors == []


def test_the_shown_setting_is_copied(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    pages.show(one, run / "index.html")
    one.tell("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
    one.tell("Emulation.setFocusEmulationEnabled", enabled=True)
    for button in one.value("[...document.querySelectorAll('[data-copy]')].map((one) => one.dataset.copy)"):
        one.value(f"document.querySelector('[data-copy=\"{button}\"]').click(); document.getElementById('copy').click()")
        shown = one.value("document.getElementById('setting').textContent")
        one.until(f"navigator.clipboard.readText().then((text) => text === {json.dumps(shown)})")
        label, setting, copied = one.value(f"(({{ label, setting, copy }}) => [label, setting, copy])(chosen()[{button}])")
        assert one.value("document.getElementById('copied-of').textContent") == f"{label} {setting}"
        assert shown.startswith(f"# {label}") and copied in shown
    assert one.errors == []


def test_a_dot_dims_other_scenes_and_opens_the_player(run: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    pages.show(one, run / "index.html")
    x, y, picked = one.value(pages.DOT)
    dimmed = pages.DIMMED.replace("NEAR", json.dumps(picked))
    assert not one.value(dimmed)
    one.mouse("Moved", x, y, is_down=False)
    one.until(dimmed)
    one.click_at(x, y)
    one.until("document.getElementById('player').open")
    one.until("window.frames.length === 1")
    for part in ("player-frame').src", "player-page').href"):
        assert one.value(f"document.getElementById('{part}").endswith(f"/scenes/{picked}.html")
    time.sleep(1.5)
    one.picture(SCREENSHOTS / f"player-{run.name}-{name}.png")
    assert any(asked.endswith(f"/scenes/{picked}.html") for asked in one.requests) and one.errors == []
    one.value("document.querySelector('#player form button').click()")
    one.until("!document.getElementById('player').open && document.getElementById('player-frame').src === 'about:blank'")
    one.mouse("Moved", 1, 1, is_down=False)
    one.until("STRIPS.every((name) => views[name].signal('near') === '')")


def test_a_bar_leads_to_its_scenes(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    pages.show(one, run / "index.html")
    bars = """(() => { const place = document.querySelector('[data-chart="losses"]');
        place.scrollIntoView({ block: "start", behavior: "instant" });
        return [...place.querySelectorAll('.mark-rect.role-mark path')].map((bar) => {
          const { x, y, width, height } = bar.getBoundingClientRect(), { metric, lost } = bar.__data__.datum;
          return [x + width / 2, y + height / 2, metric, lost];
        }); })()"""
    for x, y, metric, lost in one.value(bars)[:6]:
        one.click_at(x, y)
        one.until(f"document.getElementById('loss').value === {metric!r} && views.losses.signal('chosen') === {metric!r}")
        shown = "[...document.querySelectorAll('[data-loss]')].filter((body) => body.checkVisibility())"
        assert one.value(f"{shown}.map((body) => [body.dataset.loss, body.rows.length])") == [[metric, lost]]
    assert one.errors == []


def test_a_loss_opens_the_two_engines_side_by_side(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    text = (run / "index.html").read_text(encoding="utf-8")
    for name, place in re.findall(r'href="(scenes/[^"#]+\.html)#([^"]*only=[^"]*)"', text):
        wanted = unquote(html.unescape(place)).partition("only=")[2].split("|")
        page = (run / name).read_text(encoding="utf-8")
        if all(f'"label":{json.dumps(label)}' in page for label in wanted):
            break
    else:
        pytest.skip("no replay of two engines")
    one.open(run / name)
    one.value(f"location.hash = {html.unescape(place)!r}")
    shown = "[...document.querySelectorAll('.view')].filter((view) => !view.hidden)"
    one.until(f"{shown}.length === 2")
    assert one.value(f"{shown}.map((view) => view.querySelector('.called').textContent)") == wanted
    assert one.errors == []


def test_stills_follow_the_chooser(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    pages.show(one, run / "index.html")
    stills = one.value("page.stills")
    assert len(stills) > 1
    for name, pictures in stills.items():
        pages.choose(one, "replay-scene", name)
        captions = one.value("[...document.querySelectorAll('#replays figcaption')].map((one) => one.textContent)")
        assert captions == [f"{label} {words}" for label, _, words in pictures]
        assert one.value("[...document.querySelectorAll('#replays svg')].every((one) => one.getBoundingClientRect().height > 50)")
    one.value("document.getElementById('play').click()")
    assert f"/scenes/{name}.html" in one.value("document.getElementById('player-frame').src")


def test_the_table_of_all_figures_is_filtered(run: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    page = run / "index.html"
    pages.show(one, page)
    one.value("document.getElementById('load').click()")
    one.until("document.querySelectorAll('#grid tbody tr').length > 1")
    one.value("document.getElementById('figures').scrollIntoView({behavior: 'instant'})")
    one.picture(SCREENSHOTS / f"table-{run.name}-{name}.png")
    total = int(one.value("document.querySelector('#figures h2').textContent").split()[1].replace(",", ""))

    def left(words: str) -> int:
        one.value(f"""(() => {{ const box = document.querySelector('#grid input'); box.value = {json.dumps(words)};
            box.dispatchEvent(new Event('input', {{bubbles: true}})); }})()""")
        time.sleep(0.6)
        told = str(one.value("document.querySelector('#grid .dt-info').textContent"))
        found = re.search(r"of ([\d,]+) entr", told)
        assert found, told
        return int(found[1].replace(",", ""))

    assert left("") == total
    first = one.value("document.querySelector('#grid tbody td').textContent")
    assert 0 < left(first) < total
    assert left("no figure has these words") == 0
    if run.name == "run":
        assert left("odd") == 1
        assert pages.MARKUP in one.value("[...document.querySelectorAll('#grid tbody td')].map((cell) => cell.textContent)")
        assert one.value("document.querySelectorAll('#grid b, #grid img').length") == 0
    pages.quiet(one, page)


def test_charts_follow_the_theme(run: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    before = name.partition("-")[2]
    other = {"light": "dark", "dark": "light"}[before]
    for page in (run / "index.html", pages.scenes(run)[0]):
        pages.show(one, page)
        for theme in (other, before):
            assert one.value("document.getElementById('theme').textContent") == theme
            one.value("document.getElementById('theme').click()")
            muted = one.value(f"page.palette.{theme}.muted")
            words = "document.querySelector('[data-chart=overlap] .role-axis-label text')"
            one.until(f"{words}.getAttribute('fill') === '{muted}'")
            assert one.value("document.documentElement.dataset.theme") == theme
            ink = one.value("getComputedStyle(document.body).color")
            assert (sum(map(int, re.findall(r"\d+", ink)[:3])) > 384) == (theme == "dark")
        assert one.value(pages.BLANK) == [] and one.errors == []


def _is_focusable(node: Mapping[str, Any]) -> bool:
    return any(one["name"] == "focusable" and one["value"]["value"] for one in node.get("properties", ()))


def test_every_control_is_reached_by_tab_and_has_a_name(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    for page in (run / "index.html", pages.scenes(run)[0]):
        pages.show(one, page)
        one.tell("Emulation.setFocusEmulationEnabled", enabled=True)
        one.value(f"window.left = new Set({pages.CONTROLS}); window.before = window.left.size")
        for _ in range(one.value("window.before") + 40):
            one.key("Tab")
            one.value("window.left.delete(document.activeElement)")
        assert one.value("window.before") > 8
        assert one.value("[...window.left].map((one) => one.outerHTML.slice(0, 80))") == []
        nodes = [node for node in one.tell("Accessibility.getFullAXTree")["nodes"] if _is_focusable(node)]
        assert len(nodes) > 8
        assert [node["role"]["value"] for node in nodes if not node.get("name", {}).get("value", "").strip()] == []


def test_a_scene_plays(run: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    for page in pages.scenes(run):
        pages.replayed(one, page)
        assert one.value(pages.BLANK) == []
        assert one.value(pages.COLOURS) > 20
        one.picture(SCREENSHOTS / f"{page.stem}-{run.name}-{name}.png")
        one.value("document.dispatchEvent(new CustomEvent('seek-time', {detail: 0}))")
        one.until(f"{pages.SHOWN} === 0")
        one.value("document.querySelector('[data-part=play]').click()")
        assert one.value("document.getElementById('replay').dataset.state") == "playing"
        one.until(f"{pages.SHOWN} >= 3")
        # a short scene may have ended by now, which pauses it too: a click would play it again
        playing = "document.getElementById('replay').dataset.state === 'playing'"
        one.value(f"{playing} && document.querySelector('[data-part=play]').click()")
        assert one.value("document.getElementById('replay').dataset.state") == "paused"
        one.until(f"Object.values(views).every((view) => Math.abs(view.signal('now') - page.replay.times[{pages.SHOWN}]) < 1e-9)")
        pages.quiet(one, page)


def test_a_click_on_a_chart_leads_to_its_time(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    pages.replayed(one, pages.scenes(run)[0])
    one.value("document.querySelector('[data-chart=overlap]').scrollIntoView({block: 'center', behavior: 'instant'})")
    wanted = float(one.value("views.overlap.scale('x').domain()[1]")) / 2
    place = f"""(() => {{ const view = views.overlap, box = view.container().getBoundingClientRect(), [left, top] = view.origin();
        return [box.left + left + view.scale('x')({wanted}), box.top + top + 60]; }})()"""
    x, y = one.value(place)
    one.click_at(x, y)
    step, pixel = float(one.value("page.replay.times[1]")), 2 * wanted / float(one.value("views.overlap.width()"))
    one.until(f"Math.abs({pages.SHOWN} * {step} - {wanted}) <= {step + 2 * pixel}")
    one.until(f"Math.abs(views.overlap.signal('now') - page.replay.times[{pages.SHOWN}]) < 1e-9")


def test_keys_and_links_lead_the_replay(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    page = pages.scenes(run)[0]
    pages.replayed(one, page)
    for key, state in (("Home", "0"), ("ArrowRight", "1"), ("End", "Number(document.querySelector('[data-part=bar]').max)")):
        one.press([key])
        one.until(f"{pages.SHOWN} === {state}")
    for state in ("playing", "paused"):
        one.press(" ")
        assert one.value("document.getElementById('replay').dataset.state") == state
    step = float(one.value("page.replay.times[1]"))
    one.value(f"location.hash = 't={7 * step:.6g}'")
    one.until(f"{pages.SHOWN} === 7")
    one.value(f"document.dispatchEvent(new CustomEvent('seek-time', {{detail: {3 * step}}}))")
    one.until(f"{pages.SHOWN} === 3")
    one.value("document.querySelector('[data-part=link]').click()")
    linked = str(one.value("location.hash"))
    assert float(linked.removeprefix("#t=")) == pytest.approx(3 * step, rel=1e-5)
    # and at load, as from the index
    pages.show(one, run / "index.html")
    pages.replayed(one, page, linked)
    one.until(f"{pages.SHOWN} === 3")
    one.value("location.hash = 't=nonsense'")
    assert one.value(pages.SHOWN) == 3 and one.errors == []


def test_buttons_lead_to_the_worst_moments(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    for page in pages.scenes(run)[:2]:
        pages.replayed(one, page)
        data = one.value("({times: page.replay.times, worst: page.replay.views.map((view) => view.moments)})")
        wanted = [(number, moment) for number, moments in enumerate(data["worst"]) for moment in moments]
        assert one.value("[...document.querySelectorAll('[data-worst]')].map((one) => Number(one.dataset.worst))") == [
            moment["state"] for _, moment in wanted
        ]
        one.value("document.querySelectorAll('.worst details').forEach((one) => { one.open = true; })")
        for k, (number, moment) in list(enumerate(wanted))[:12]:
            one.value(f"document.querySelectorAll('[data-worst]')[{k}].click()")
            one.until(f"{pages.SHOWN} === {moment['state']}")
            linked = float(one.value("location.hash").removeprefix("#t="))
            # the address has five decimals, and the state is the nearest to it
            assert linked == pytest.approx(data["times"][moment["state"]], abs=0.5000001e-5)
            assert numpy.argmin(numpy.abs(numpy.array(data["times"]) - linked)) == moment["state"]
            # the view of the button's engine is on the screen
            box = f"document.querySelectorAll('.view')[{number}].getBoundingClientRect()"
            assert one.value(f"{box}.top >= -1 && {box}.bottom <= window.innerHeight + 1")
            if found := re.match(r"overlap of ([0-9.,]+ (?:nm|µm|mm|m)\b)", moment["said"]):
                caption = str(one.value(f"document.querySelectorAll('.view')[{number}].querySelector('.said').textContent"))
                assert caption.startswith(f"{found[1]}: "), caption
        assert one.errors == []


def test_a_scene_is_saved_as_a_moving_picture(run: Path, opened: tuple[Browser, str], tmp_path: Path) -> None:
    one, _ = opened
    page = pages.shortest(run)
    one.downloads(tmp_path)
    pages.replayed(one, page)
    one.value("document.querySelector('[data-part=film]').click()")
    one.until("document.getElementById('replay').dataset.filmed !== undefined", patience=300.0)
    saved, until = tmp_path / f"{page.stem}.gif", time.monotonic() + 10.0
    while not saved.exists() and time.monotonic() < until:
        time.sleep(0.1)
    assert 1000 < saved.stat().st_size == int(one.value("document.getElementById('replay').dataset.filmed")) < LARGEST_GIF
    with Image.open(saved) as film:
        pictures = [numpy.asarray(frame.convert("RGB")) for frame in ImageSequence.Iterator(film)]
        assert film.format == "GIF" and film.info["loop"] == 0 and len(pictures) > 5
    # many colours, and something moves
    assert len(numpy.unique(pictures[0].reshape(-1, 3), axis=0)) > 10
    assert any((later != pictures[0]).any() for later in pictures[1:])
    pages.quiet(one, page)
