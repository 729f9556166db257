"""The report in a browser: opened from disk it complains of nothing, requests nothing, draws everything and plays.

Not part of `make test`, which needs no browser: `make look` runs it on a small run made by hand and on the last run, and leaves
screenshots in reports/out/look/ for eyes.
"""

import json
import re
import time
from pathlib import Path

import numpy
import pytest
from PIL import Image, ImageSequence

from reports import write_report
from reports.words.wording import quantity as words_of
from runfiles import array_file
from runfiles.metrics import METRICS
from tests.look.browser import Browser
from tests.look.conftest import SCREENSHOTS, SIZES, WINDOWS
from tests.reports.conftest import whole_run
from tests.reports.recorded import recording, scene

OUT = Path(__file__).resolve().parents[2] / "reports" / "out"
TALLEST = 12_000
"""Height [px] of the index of a full run that is still read to its end, at the width of `wide`."""
LARGEST_GIF = 20_000_000
"""Bytes; a moving picture of a whole scene that is larger is too large to send."""

COLOURS = """
new Promise((done) => {
  window.dispatchEvent(new Event("resize"));
  // after the replay's own drawing, within the same frame, while the picture still is there
  requestAnimationFrame(() => {
    const from = document.querySelector(".stage canvas"), to = document.createElement("canvas");
    to.width = from.width; to.height = from.height;
    const pen = to.getContext("2d");
    pen.drawImage(from, 0, 0);
    const pixels = new Uint32Array(pen.getImageData(0, 0, to.width, to.height).data.buffer);
    done(new Set(pixels).size);
  });
})
"""
"""How many different colours the replay's canvas has."""
DRAWN = """
new Promise((done) => {
  const stage = document.querySelector(".stage"), canvas = stage.querySelector("canvas"), all = stage.getBoundingClientRect();
  window.dispatchEvent(new Event("resize"));
  requestAnimationFrame(() => {
    const copy = document.createElement("canvas"), scale = canvas.width / all.width;
    copy.width = canvas.width; copy.height = canvas.height;
    const pen = copy.getContext("2d");
    pen.drawImage(canvas, 0, 0);
    const share = (part) => {
      const box = part.getBoundingClientRect();
      const place = [box.left - all.left + 1, box.top - all.top + 1, box.width - 2, box.height - 2];
      const drawn = pen.getImageData(...place.map((length) => length * scale)).data;
      return drawn.some((value, k) => k % 4 === 3 && value) ? 1 : 0;
    };
    done([".picture", ".said"].map((name) => share(document.querySelector(name))));
  });
})
"""
"""Whether anything is drawn in the picture of the first view, and in its caption."""
WRITTEN = """
(() => {
  const pen = CanvasRenderingContext2D.prototype, write = pen.fillText;
  window.written = [];
  pen.fillText = function (text, x, y, most) {
    window.written.push([text, this.measureText(text).width, most === undefined ? this.canvas.width - x : most]);
    write.apply(this, arguments);
  };
})()
"""
"""Keeps the words that are written into pictures, the width of each, and the room that it has [px]."""
BLANK = """
[...document.querySelectorAll("figure svg")].filter((svg) => {
  const box = svg.getBoundingClientRect();
  return !(box.width > 50 && box.height > 30 && svg.querySelector("path, circle, rect, line")) || !svg.getAttribute("aria-label");
}).length
"""
"""How many charts are not drawn, or have no words in place of the picture."""
POINTED = """
(() => {
  const chart = document.querySelector("#courses-charts svg"), box = chart.getBoundingClientRect();
  chart.dispatchEvent(new PointerEvent("pointermove", { clientX: box.left + 0.6 * box.width, clientY: box.top + 20 }));
  return Number(document.getElementById("courses-charts").dataset.time);
})()
"""
"""The time [s] to which the cursor goes when a pointer is over a chart."""
LANDED = 40
"""Distance [px] from the top of the screen at which a section is where its link leads."""
SETTLED = """
new Promise((done) => {
  let before = NaN, same = 0;
  const look = () => {
    same = window.scrollY === before ? same + 1 : 0;
    before = window.scrollY;
    if (same > 5) done(); else requestAnimationFrame(look);
  };
  look();
})
"""
"""Resolves once the page no longer scrolls."""


LONG = 1300
"""States of the run made by hand: more than a page draws, so that a drawn state stands for three."""


def _aside(path: Path) -> None:
    """Let all end after 200 states, before it has fallen out of sight, and put the hand aside by 37 mm and by 474 mm in states
    that are not drawn themselves."""
    arrays = array_file.read(path)
    for name in ("positions", "raw_positions"):
        arrays[name][200:] = arrays[name][199]
    arrays["positions"][500, 2, 0] += 0.037
    arrays["positions"][1001, 2, 1] += 0.4735
    with path.open("wb") as file:
        array_file.write(file, arrays)


def by_hand(folder: Path) -> Path:
    """A small run with recordings of one scene."""
    folder.mkdir()
    data, runs = whole_run(), ("avatarsim/default", "mujoco/default", "mujoco/tuned", "pybullet/default")
    sinking, free = [0.0] * LONG, [0.0] * LONG
    sinking[9], sinking[10] = 0.01, 0.02
    series = {run: {"overlap_m": free if run == runs[0] else sinking, "frame_time_us": []} for run in runs}
    (folder / "results.json").write_text(json.dumps(data | {"series": {"arm_wall": series}}))
    scene(folder, "arm_wall")
    for run in runs:
        recording(folder, "arm_wall", run, states=LONG, sinks=run != runs[0])
        _aside(folder / "recordings" / f"arm_wall.{run.replace('/', '.')}.0.npz")
    write_report(folder)
    return folder


@pytest.fixture(scope="module", params=["by hand", "last"])
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a report: made here, and the last run's where there is one with recordings."""
    last = OUT / "latest"
    if request.param == "by hand" or not (last / "scenes").exists():
        return by_hand(tmp_path_factory.mktemp("look") / "run")
    write_report(last)
    return last


def quiet(one: Browser, page: Path) -> None:
    """Nothing on the console, and no address asked for but the page's own."""
    assert one.errors == []
    own = page.resolve().as_uri()
    assert [address for address in one.requests if address != own and not address.startswith("data:")] == []


def scenes(run: Path) -> list[Path]:
    """Pages of scenes that can be played, at most three."""
    found = [page for page in sorted((run / "scenes").glob("*.html")) if 'id="replay-data"' in page.read_text(encoding="utf-8")]
    assert found
    return found[:3]


def shortest(run: Path) -> Path:
    """The page with the fewest states to draw, of those that have more than a few: each is drawn in software."""
    lengths = {}
    for page in (run / "scenes").glob("*.html"):
        bar = re.search(r'data-part="bar" min="0" max="(\d+)"', page.read_text(encoding="utf-8"))
        if bar and int(bar[1]) > 20:
            lengths[page] = int(bar[1])
    return min(sorted(lengths), key=lambda page: lengths[page])


def test_the_index_draws_all_its_charts(run: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    page = run / "index.html"
    one.open(page)
    assert one.value("document.querySelectorAll('figure svg').length") > 4
    assert one.value(BLANK) == 0
    assert one.value("document.documentElement.scrollWidth <= window.innerWidth")
    if name.startswith("wide"):
        assert one.value("document.documentElement.scrollHeight") < TALLEST
    one.value("document.querySelector('#courses details').open = true")
    for choice in one.value("[...document.querySelectorAll('#courses-scene option')].map((one) => one.value)"):
        picked = f"""(() => {{
            const box = document.getElementById("courses-scene");
            box.value = {json.dumps(choice)};
            box.dispatchEvent(new Event("change"));
            return Number(document.getElementById("courses-charts").dataset.drawn);
        }})()"""
        assert one.value(picked) >= 1
        assert one.value("document.querySelectorAll('#courses-charts svg path').length") >= 1
    assert one.value(POINTED) > 0.0
    quiet(one, page)
    one.picture(SCREENSHOTS / f"index-{run.name}-{name}.png")


def test_links_at_the_top_reach_every_section(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    one.open(run / "index.html")
    sections = one.value("[...document.querySelectorAll('section')].map((one) => one.id)")
    assert sections and all(sections)
    assert one.value("[...document.querySelectorAll('nav a')].map((one) => one.getAttribute('href').slice(1))") == sections
    for number, section in enumerate(sections):
        # from the top of the page, and every third one from elsewhere, when nothing of the page has been drawn yet
        if number % 3 or section == sections[-1]:
            one.value("window.scrollTo({top: 0, behavior: 'instant'})")
            one.value(f"document.querySelector('nav a[href=\"#{section}\"]').click()")
        if number % 3 == 0:
            one.open(scenes(run)[0])
            one.open(run / "index.html", f"#{section}")
        assert one.value("location.hash") == f"#{section}"
        one.value(SETTLED)
        top, left = one.value(f"[document.getElementById('{section}').getBoundingClientRect().top, "
                              "document.documentElement.scrollHeight - window.innerHeight - window.scrollY]")
        assert abs(top) <= LANDED or (top > 0 and left < 2), f"{section}: {top} px below the top, {left} px to the end"


def test_every_scene_has_a_card_and_the_filter_leaves_what_fits(run: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    one.open(run / "index.html")
    total = one.value("document.querySelectorAll('.scene-card').length")
    assert total == one.value("document.querySelectorAll('#ranking tbody').length")
    drawn = one.value("""[...document.querySelectorAll('svg.thumb')].filter((svg) => {
        const box = svg.getBoundingClientRect();
        return box.width > 100 && box.height > 60 && svg.querySelector('path, circle')
            && getComputedStyle(svg.querySelector('path, circle')).fill !== 'rgb(0, 0, 0)';
    }).length""")
    assert drawn == sum('id="replay-data"' in page.read_text(encoding="utf-8") for page in (run / "scenes").glob("*.html"))
    left = "[...document.querySelectorAll('.scene-card')].filter((card) => card.getBoundingClientRect().height > 0).length"
    assert one.value(left) == total

    def choose(control: str, value: str) -> int:
        one.value(f"""(() => {{ const box = document.getElementById('gallery-{control}');
            box.value = {json.dumps(value)}; box.dispatchEvent(new Event('input', {{bubbles: true}})); }})()""")
        return int(one.value(left))

    families = one.value("[...document.querySelectorAll('#gallery-family option')].map((one) => one.value)")
    assert sum(choose("family", family) for family in families if family) == total
    assert choose("family", "") == total
    first = one.value("document.querySelector('.scene-card').id.slice(6)")
    assert 1 <= choose("words", f"{first.split('_')[0]} {first.split('_')[-1]}") <= total
    assert choose("words", "no scene has these words") == 0
    assert one.value("document.getElementById('gallery-count').textContent") == f"0 of {total} scenes"
    # a link to a scene that is filtered away brings it back
    one.value(f"location.hash = 'scene-{first}'")
    one.until(f"{left} === {total}")
    one.value("document.getElementById('scenes').scrollIntoView({behavior: 'instant'})")
    one.picture(SCREENSHOTS / f"scenes-{run.name}-{name}.png")
    assert one.errors == []


def test_tables_are_cards_where_there_is_no_room(run: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    one.open(run / "index.html")
    shown = one.value("getComputedStyle(document.querySelector('#ranking tbody td'), '::before').content")
    display = one.value("getComputedStyle(document.querySelector('#ranking tr')).display")
    assert (display, shown != "none") == (("block", True) if name.startswith("narrow") else ("table-row", False))


def test_labels_of_cards_are_inside_the_screen(run: Path, opened: tuple[Browser, str]) -> None:
    """A label lies in the room that its cell keeps free at the left, and begins by so much before its content."""
    one, name = opened
    one.open(run / "index.html")
    one.value("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    outside = one.value("""[...document.querySelectorAll('.scroll [data-label]')].filter((cell) => {
        const box = cell.getBoundingClientRect(), label = getComputedStyle(cell, '::before');
        if (!box.width || label.content === 'none') return false;
        const left = box.left + parseFloat(getComputedStyle(cell).paddingLeft) + parseFloat(label.marginLeft || '0');
        return left < -0.5 || left + parseFloat(label.width) > window.innerWidth + 0.5;
    }).length""")
    assert outside == 0, name


def test_no_metric_is_called_by_its_identifier(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    one.open(run / "index.html")
    one.value("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    one.value("document.querySelectorAll('code').forEach((one) => one.remove())")
    text = str(one.value("document.querySelector('main').innerText"))
    assert [metric for metric in METRICS if "_" in metric and re.search(rf"\b{metric}\b", text)] == []


def test_a_link_leads_to_a_moment(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    page = scenes(run)[0]
    one.open(page)
    one.until("document.getElementById('replay').dataset.frame !== undefined")
    step = float(one.value("JSON.parse(document.getElementById('replay-data').textContent).dt"))
    shown = "Number(document.getElementById('replay').dataset.frame)"
    one.value(f"location.hash = 't={7 * step:.6g}'")
    one.until(f"{shown} === 7")
    one.value("document.dispatchEvent(new CustomEvent('seek-time', {detail: %r}))" % (3 * step))
    one.until(f"{shown} === 3")
    one.value("document.querySelector('[data-part=link]').click()")
    linked = str(one.value("location.hash"))
    assert float(linked.removeprefix("#t=")) == pytest.approx(3 * step, rel=1e-5)
    # and at load, as from a card of the index
    one.open(run / "index.html")
    one.open(page, linked)
    one.until(f"{shown} === 3")
    one.value("location.hash = 't=nonsense'")
    assert one.value(shown) == 3 and one.errors == []


def test_buttons_lead_to_the_worst_moments(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    for page in scenes(run):
        one.open(page)
        one.until("document.getElementById('replay').dataset.frame !== undefined")
        runs = one.value("JSON.parse(document.getElementById('replay-data').textContent).runs.map((run) => run.worst)")
        opens = one.value("JSON.parse(document.getElementById('replay-data').textContent).opens")
        step = float(one.value("JSON.parse(document.getElementById('replay-data').textContent).dt"))
        wanted = [*(opens[name]["state"] for name in ("ours", "others") if name in opens),
                  *(moment["state"] for moments in runs for moment in moments)]
        assert one.value("[...document.querySelectorAll('[data-worst]')].map((one) => Number(one.dataset.worst))") == wanted
        # of the lists ours alone is open, and the button of the others says of which
        lists = one.value("[...document.querySelectorAll('.worst details')].map((one) => [one.innerText, one.open])")
        assert [told.split()[0].startswith("avatarsim") for told, is_open in lists if is_open] == [True]
        if "others" in opens:
            assert opens["others"]["run"] in one.value("document.querySelector('.worst > div').innerText")
        one.value("document.querySelectorAll('.worst details').forEach((one) => { one.open = true; })")
        for number, state in enumerate(wanted):
            button = f"document.querySelectorAll('[data-worst]')[{number}]"
            one.value(f"{button}.scrollIntoView({{block: 'start', behavior: 'instant'}})")
            # a page that still scrolls for the button before is no place to press the next
            one.value(SETTLED)
            one.value(f"{button}.click()")
            one.until(f"document.getElementById('replay').dataset.frame === '{state}'")
            assert float(one.value("location.hash").removeprefix("#t=")) == pytest.approx(state * step, rel=1e-5)
            one.value(SETTLED)
            # the view of the engine that the button is about is on the screen
            box = f"document.querySelectorAll('.view')[{button}.dataset.of].getBoundingClientRect()"
            assert one.value(f"{box}.top >= -1 && {box}.bottom <= window.innerHeight + 1")
        assert one.errors == []


def test_nothing_glides_where_less_motion_is_asked_for(run: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    one.open(scenes(run)[0])
    one.until("document.getElementById('replay').dataset.frame !== undefined")
    one.tell("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    try:
        one.value("window.scrollTo(0, document.documentElement.scrollHeight)")
        box = "document.querySelector('.view').getBoundingClientRect()"
        assert one.value(f"{box}.bottom < 0")
        seen = one.value(f"(() => {{ document.querySelector('[data-worst]').click(); return {box}.bottom; }})()")
        assert 0 < seen <= SIZES["wide"][1] + 1
    finally:
        one.screen(*SIZES[name.partition("-")[0]], dark=name.endswith("dark"))


def test_charts_and_captions_say_the_same_at_every_worst_moment(run: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    # neither size nor colours matter here, and each moment is drawn in software: each window takes the next page
    pages = scenes(run)
    for page in [pages[WINDOWS.index(name) % len(pages)]]:
        one.open(page)
        one.until("document.getElementById('replay').dataset.frame !== undefined")
        data = "JSON.parse(document.getElementById('replay-data').textContent)"
        runs = one.value(f"{data}.runs.map((run) => [run.run, run.worst])")
        for number, (called, moments) in enumerate(runs):
            for k, moment in enumerate(moments):
                figure = re.search(r"[0-9.,]+ (?:nm|µm|mm|m)\b", moment["said"])
                title = "Overlap" if moment["said"].startswith("overlap") else "Distance from the user"
                if not figure or not re.search("overlap of|from its user", moment["said"]):
                    continue
                one.value(f"document.querySelectorAll('[data-of=\"{number}\"]:not(.worst > div *)')[{k}].click()")
                one.until(f"document.getElementById('replay').dataset.frame === '{moment['state']}'")
                told = str(one.value(f"[...document.querySelectorAll('.course')].find((one) => "
                                     f"one.querySelector('h4').textContent === '{title}').querySelector('.told').textContent"))
                assert f"{called} {figure[0]}" in told.split(" · "), f"{page.stem}: {moment['said']}"
                if title == "Overlap":
                    caption = str(one.value(f"document.querySelectorAll('.view')[{number}].querySelector('.said').textContent"))
                    assert caption.startswith(f"{figure[0]}: "), caption
        assert one.errors == []


def test_figures_of_the_scripts_are_those_of_the_pages_words(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    one.open(scenes(run)[0])
    for unit in ("m", "us", "J"):
        for value in (0.0, 3e-10, 3e-9, 1.68e-6, 1.68e-4, 9.996e-4, 0.02, 0.47351, 0.9996, 1.0, 12.3456, 900.0):
            assert one.value(f"quantity({value!r}, '{unit}')") == words_of(value, unit), (value, unit)


def test_captions_leave_the_picture_free_where_there_is_no_room(run: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    one.open(scenes(run)[0])
    one.until("document.getElementById('replay').dataset.frame !== undefined")
    over = one.value("""[...document.querySelectorAll('.view')].map((view) => {
        const parts = ['.called', '.picture', '.said'];
        const [called, picture, said] = parts.map((one) => view.querySelector(one).getBoundingClientRect());
        return [picture.top - called.bottom, said.top - picture.bottom, picture.height / picture.width];
    })""")
    assert all(share == pytest.approx(0.75, abs=0.02) for _, _, share in over)
    sticky = one.value("getComputedStyle(document.querySelector('.controls')).position")
    if name.startswith("narrow"):
        assert all(above >= -0.5 and below >= -0.5 for above, below, _ in over) and sticky == "static"
        assert one.value("[...document.querySelectorAll('.said')].every((said) => said.scrollHeight <= said.clientHeight)")
        # what is drawn is where the pictures are, and nowhere else
        assert one.value(DRAWN) == [1, 0]
    else:
        assert sticky == "sticky"


def test_a_scene_is_saved_as_a_moving_picture(run: Path, opened: tuple[Browser, str], tmp_path: Path) -> None:
    one, _ = opened
    page = shortest(run)
    one.downloads(tmp_path)
    one.open(page)
    one.until("document.getElementById('replay').dataset.frame !== undefined")
    one.value(WRITTEN)
    one.value("document.querySelector('[data-part=film]').click()")
    one.until("document.querySelector('[data-part=film]').textContent.startsWith('Stop: picture')")
    one.until("document.getElementById('replay').dataset.filmed !== undefined", patience=300.0)
    # its words have the width that they need, and no digits that nothing was measured to
    words = one.value("window.written")
    assert words and all(width <= most + 0.5 for _, width, most in words)
    assert not [text for text, *_ in words if re.search(r"\d\.\d{3}", text)]
    saved = tmp_path / f"{page.stem}.gif"
    for _ in range(100):
        if saved.exists():
            break
        time.sleep(0.1)
    assert 1000 < saved.stat().st_size == int(one.value("document.getElementById('replay').dataset.filmed")) < LARGEST_GIF
    with Image.open(saved) as film:
        pictures = [numpy.asarray(frame.convert("RGB")) for frame in ImageSequence.Iterator(film)]
        assert film.format == "GIF" and film.info["loop"] == 0 and len(pictures) > 5
    # many colours, and something moves
    assert len(numpy.unique(pictures[0].reshape(-1, 3), axis=0)) > 10
    assert any((later != pictures[0]).any() for later in pictures[1:])
    quiet(one, page)


def test_the_index_leads_to_every_scene_and_back(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    one.open(run / "index.html")
    every = "[...document.querySelectorAll('a[href*=\"scenes/\"]')].map((one) => one.getAttribute('href'))"
    links = one.value(f"[...new Set({every})]")
    assert links and all((run / link.partition("#")[0]).exists() for link in links)
    one.open(run / links[0].partition("#")[0])
    assert one.value("document.querySelector('.brand a').getAttribute('href')") == "../index.html"


def test_a_scene_plays(run: Path, opened: tuple[Browser, str]) -> None:
    one, name = opened
    for page in scenes(run):
        one.open(page)
        one.until("['paused', 'no-webgl'].includes(document.getElementById('replay').dataset.state)")
        assert one.value("document.getElementById('replay').dataset.state") == "paused", "the browser offers no WebGL"
        one.until("document.getElementById('replay').dataset.frame !== undefined")
        assert one.value(COLOURS) > 20
        assert one.value("document.documentElement.scrollWidth <= window.innerWidth")
        one.picture(SCREENSHOTS / f"{page.stem}-{run.name}-{name}.png")
        shown = "Number(document.getElementById('replay').dataset.frame)"
        one.value("document.dispatchEvent(new CustomEvent('seek-time', {detail: 0}))")
        one.until(f"{shown} === 0")
        one.value("document.querySelector('[data-part=play]').click()")
        assert one.value("document.getElementById('replay').dataset.state") == "playing"
        one.until(f"{shown} >= 3")
        # a short scene may have come to its end by now, which pauses it too: a click would play it again
        one.value(
            "document.getElementById('replay').dataset.state === 'playing' && document.querySelector('[data-part=play]').click()"
        )
        assert one.value("document.getElementById('replay').dataset.state") == "paused"
        assert float(one.value("document.getElementById('courses-charts').dataset.time")) > 0.0
        quiet(one, page)


def test_keys_lead_the_replay(run: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    one.open(scenes(run)[0])
    one.until("document.getElementById('replay').dataset.frame !== undefined")

    def press(key: str) -> None:
        one.value(f"document.body.dispatchEvent(new KeyboardEvent('keydown', {{key: {json.dumps(key)}, bubbles: true}}))")

    press("Home")
    one.until("document.getElementById('replay').dataset.frame === '0'")
    press("ArrowRight")
    one.until("document.getElementById('replay').dataset.frame === '1'")
    press("End")
    one.until("document.getElementById('replay').dataset.frame === document.querySelector('[data-part=bar]').max")
    press("ArrowLeft")
    press(" ")
    assert one.value("document.getElementById('replay').dataset.state") == "playing"
    press(" ")
    assert one.errors == []
