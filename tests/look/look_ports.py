"""The page of tracked hands and the example of a renderer in a browser: empty console, no request beyond loopback.

Not part of `make test`, which needs no browser: `make look` runs it, and leaves screenshots in reports/out/look/. Hands
come from a scripted headset, since no browser here has one.
"""

import math
import shutil
import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from avatarsim.live.messages import State
from avatarsim.live.ports.protocol import Goals
from avatarsim.player.three_js import library
from tests.live.ports.opened import Opened, state, until
from tests.look.browser import Browser
from tests.look.conftest import COLOURS, SCREENSHOTS

RENDERER = Path(__file__).resolve().parents[2] / "examples" / "renderer"
HEADSET = """
(() => {
  const ends = [], space = {}, hand = { get: (joint) => joint };
  const turned = { x: 0, y: Math.sin(0.25), z: 0, w: Math.cos(0.25) }, still = { x: 0, y: 0, z: 0, w: 1 };
  let frames = 0;
  const pose = (joint) => joint !== "wrist" ? null
    : { transform: { position: { x: 1, y: 2 + (frames > 5 ? 0.5 : 0), z: 3 }, orientation: frames > 5 ? turned : still } };
  const session = {
    inputSources: [{ handedness: "right", hand }, { handedness: "left" }], updateRenderState() {},
    requestReferenceSpace: async () => space, addEventListener: (name, listener) => ends.push(listener),
    requestAnimationFrame(each) { setTimeout(() => { frames++; each(0, { getJointPose: pose }); }, 10); },
    end: async () => ends.forEach((one) => one()),
  };
  Object.defineProperty(navigator, "xr", { value: {
    isSessionSupported: async (kind) => kind === "immersive-vr", requestSession: async () => session,
  } });
  window.XRWebGLLayer = class {};
  WebGLRenderingContext.prototype.makeXRCompatible = async () => {};
  window.headset = session;
})();
"""
"""A headset that tracks one right hand, whose wrist goes up by half a metre and turns about the vertical by half a radian."""


class Silent(SimpleHTTPRequestHandler):
    """A server of files that prints nothing."""

    log_message = staticmethod(lambda *arguments: None)  # type: ignore[assignment]


@pytest.fixture
def ports() -> Iterator[Opened]:
    """Yield ports of a scene with a table and a hand, which show one state."""
    one = Opened()
    one.ports.start()
    yield one
    one.ports.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Yield the address of the example's folder with a copy of three.js, served as a user would: python -m http.server."""
    copied = tmp_path_factory.mktemp("renderer")
    for file in RENDERER.iterdir():
        shutil.copy(file, copied)
    # the available copy is a script from before modules; it makes a global name
    exported = """export const { BufferGeometry, Float32BufferAttribute, Mesh, MeshLambertMaterial, PerspectiveCamera, Scene,
        WebGLRenderer, DirectionalLight, AmbientLight, REVISION } = self.THREE;"""
    (copied / "three.module.js").write_text(f"{library()}\n{exported}\n", encoding="utf-8")
    handler = partial(Silent, directory=str(copied))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()
        thread.join()


def opens(one: Browser, url: str) -> None:
    """Load a page over HTTP."""
    one.visit(url)
    one.until(f"document.readyState === 'complete' && location.href === {url!r}")


def hand_over_table() -> State:
    """Return frame 3, with the hand 20 cm above the table."""
    shown = state(3)
    shown.positions[:] = [[0.0, 0.0, -0.05], [0.0, 0.0, 0.2]]
    return shown


def quiet(one: Browser) -> None:
    """Check that the console is empty, nothing is requested beyond loopback, nothing is wider than the window."""
    assert one.errors == []
    hosts = {urlsplit(address).hostname for address in one.requests if not address.startswith("data:")}
    assert hosts <= {"127.0.0.1", "localhost"}
    assert one.value("document.documentElement.scrollWidth <= window.innerWidth")


def test_without_a_headset_the_page_of_hands_says_so(ports: Opened, opened: tuple[Browser, str]) -> None:
    one, name = opened
    opens(one, ports.ports.hands)
    one.until("document.getElementById('server').textContent.includes('scene a hand, links: 1')")
    one.until("!document.getElementById('browser').textContent.startsWith('Asking')")
    assert "WebXR" in one.value("document.getElementById('browser').textContent")
    assert one.value("document.getElementById('start').disabled")
    assert one.value("document.querySelector('select[data-side=right][data-joint=wrist]').value") == "hand"
    quiet(one)
    one.picture(SCREENSHOTS / f"hands-{name}.png")


def test_a_tracked_wrist_leads_its_link_from_where_it_is_shown(ports: Opened, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    ports.ports.publish(state(7))
    script = one.tell("Page.addScriptToEvaluateOnNewDocument", source=HEADSET)["identifier"]
    try:
        opens(one, ports.ports.hands)
        one.until("!document.getElementById('start').disabled && document.querySelectorAll('select').length === 12")
        one.until("document.getElementById('server').textContent.startsWith('Connected')")
        one.value("new Promise((done) => setTimeout(done, 200))")
        one.value("document.getElementById('start').click()")
        until(lambda: len(ports.targets) > 10)
        one.value("window.headset.end()")
        until(lambda: not ports.targets[-1][0].links)
    finally:
        one.tell("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
    first, last = ports.targets[0][0], ports.targets[-2][0]
    assert isinstance(first, Goals) and isinstance(last, Goals) and list(first.links) == ["hand"]
    before, after = first.links["hand"], last.links["hand"]
    assert before.position.tolist() == [7.0, 7.0, 7.0] and before.orientation is not None
    assert before.orientation.tolist() == [1.0, 0.0, 0.0, 0.0]
    # up in tracked space is up in the scene, and so is the axis of the turn
    assert after.position == pytest.approx([7.0, 7.0, 7.5])
    assert after.orientation == pytest.approx([math.cos(0.25), 0.0, 0.0, math.sin(0.25)])
    assert not ports.ports.refusals.counts
    quiet(one)


def test_the_example_draws_the_newest_poses(ports: Opened, folder: str, opened: tuple[Browser, str], tmp_path: Path) -> None:
    one, name = opened
    # with a copy of three.js that is named
    opens(one, f"{folder}/index.html?ws=127.0.0.1:{ports.web[1]}&three=three.module.js")
    one.until("document.body.dataset.view === 'three'")
    one.picture(tmp_path / "empty.png")
    ports.ports.publish(hand_over_table())
    one.until("document.body.dataset.frame === '3'")
    one.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    place = SCREENSHOTS / f"renderer-three-{name}.png"
    one.picture(place)
    assert place.stat().st_size > 1.5 * (tmp_path / "empty.png").stat().st_size
    quiet(one)
    # and without
    opens(one, f"{folder}/index.html?ws=127.0.0.1:{ports.web[1]}")
    one.until("document.body.dataset.frame === '3'")
    assert one.value("document.body.dataset.view") == "canvas" and one.value(COLOURS) > 20
    one.picture(SCREENSHOTS / f"renderer-{name}.png")
    ports.ports.publish(state(4))
    one.until("document.body.dataset.frame === '4'")
    quiet(one)


@pytest.mark.parametrize(
    ("links", "side", "leads"),
    [
        (["hand/palm", "hand/index0", "hand/index1", "hand/little0"], "right", ["palm", "", "index1", "", "", "little0"]),
        (["human/pelvis", "human/left_elbow", "human/left_hand", "human/right_hand"], "left", ["left_hand", "", "", "", "", ""]),
        (["human/L_wrist", "human/l_index_tip", "human/r_wrist"], "left", ["L_wrist", "", "l_index_tip", "", "", ""]),
        (["box"], "right", [""] * 6),
    ],
)
def test_joints_are_proposed_by_the_names_of_links(
    ports: Opened, opened: tuple[Browser, str], links: list[str], side: str, leads: list[str]
) -> None:
    one, _ = opened
    opens(one, ports.ports.hands)
    found = one.value(f"import('/hand_joints.js').then((m) => Object.values(m.guess({links!r}).{side}))")
    assert [name.rpartition("/")[2] for name in found] == leads
