"""A headless Chromium driven over a pipe by its DevTools protocol; standard library only.

Every request and every console message is recorded. Nothing is downloaded: a browser has to be installed.
"""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--hide-scrollbars",
    "--use-angle=swiftshader-webgl", "--enable-unsafe-swiftshader", "--remote-debugging-pipe",
)
NUMBERS = {"Tab": 9, " ": 32, "Home": 36, "ArrowUp": 38}
"""Numbers of keys that are no letters."""
PATIENCE = 60.0
"""Longest wait [s] for one answer: software WebGL on a busy machine takes seconds to compile its shaders."""

Answer = Mapping[str, Any]


def program() -> str:
    """Return the browser's program; RuntimeError without one. CHROMIUM names another."""
    named = os.environ.get("CHROMIUM") or next((path for name in NAMES if (path := shutil.which(name))), None)
    if named is None:
        raise RuntimeError(f"no browser found: none of {', '.join(NAMES)} is on PATH, and CHROMIUM names none")
    return named


class Browser:
    """One browser with one page. `errors`: console errors and exceptions; `requests`: requested addresses."""

    def __init__(self) -> None:
        self.errors: list[str] = []
        self.requests: list[str] = []
        self.loaded = False
        self._home = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self._number, self._rest, self._session = 0, b"", ""
        orders_out, self._orders = os.pipe()
        self._answers, answers_in = os.pipe()
        command = [program(), *FLAGS, f"--user-data-dir={self._home.name}", "about:blank"]

        def as_three_and_four() -> None:
            # the protocol's fixed descriptors; through high numbers, since either end may already be 3 or 4
            read, write = os.dup2(orders_out, 98), os.dup2(answers_in, 99)
            os.dup2(read, 3)
            os.dup2(write, 4)

        self._child = subprocess.Popen(
            command, preexec_fn=as_three_and_four, close_fds=False, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(orders_out)
        os.close(answers_in)
        page = next(one for one in self.tell("Target.getTargets")["targetInfos"] if one["type"] == "page")
        self._session = self.tell("Target.attachToTarget", targetId=page["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.tell(f"{domain}.enable")

    def __enter__(self) -> "Browser":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        with suppress(OSError, RuntimeError):
            self._send("Browser.close", {})
        try:
            self._child.wait(timeout=10.0)
        except subprocess.TimeoutExpired:
            self._child.kill()
            self._child.wait()
        os.close(self._orders)
        os.close(self._answers)
        self._home.cleanup()

    def _send(self, method: str, about: Mapping[str, object]) -> int:
        self._number += 1
        session = {"sessionId": self._session} if self._session and not method.startswith(("Target.", "Browser.")) else {}
        order = {"id": self._number, "method": method, "params": about, **session}
        os.write(self._orders, json.dumps(order).encode() + b"\0")
        return self._number

    def tell(self, method: str, **about: object) -> Answer:
        """Send one command and return its answer. Raises RuntimeError if it is refused or no answer comes."""
        number, until = self._send(method, about), time.monotonic() + PATIENCE
        for message in self._heard(until):
            if message.get("id") == number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return dict(message["result"])
        raise RuntimeError(f"{method}: no answer within {PATIENCE:g} s")

    def _heard(self, until: float) -> Iterator[dict[str, Any]]:
        while (left := until - time.monotonic()) > 0.0:
            while b"\0" in self._rest:
                text, self._rest = self._rest.split(b"\0", 1)
                message = json.loads(text)
                self._note(message.get("method", ""), message.get("params", {}))
                yield message
            if select.select([self._answers], [], [], min(left, 1.0))[0]:
                more = os.read(self._answers, 1 << 20)
                if not more:
                    raise RuntimeError("the browser has gone")
                self._rest += more

    def _note(self, kind: str, about: Mapping[str, Any]) -> None:
        if kind == "Runtime.exceptionThrown":
            thrown = about["exceptionDetails"]
            self.errors.append(str(thrown.get("exception", {}).get("description") or thrown["text"]))
        elif kind == "Runtime.consoleAPICalled" and about["type"] in ("error", "warning", "assert"):
            self.errors.append(" ".join(str(one.get("value", one.get("description", ""))) for one in about["args"]))
        elif kind == "Log.entryAdded" and about["entry"]["level"] == "error":
            self.errors.append(f"{about['entry']['text']} {about['entry'].get('url', '')}")
        elif kind == "Network.requestWillBeSent":
            self.requests.append(about["request"]["url"])
        elif kind == "Page.loadEventFired":
            self.loaded = True

    def open(self, page: Path, hash_: str = "") -> None:
        """Load a page from disk, at "#..." if given, and wait until it is loaded."""
        self.loaded = False
        self.visit(page.resolve().as_uri() + hash_)
        until = time.monotonic() + PATIENCE
        while not self.loaded:
            if time.monotonic() > until:
                raise RuntimeError(f"{page} was not loaded within {PATIENCE:g} s")
            # a command to the page itself is refused at the moment when the page is replaced
            self.tell("Browser.getVersion")
            time.sleep(0.05)

    def visit(self, address: str) -> None:
        """Go to a page of a server, and clear earlier errors and requests."""
        self.errors.clear()
        self.requests.clear()
        self.tell("Page.navigate", url=address)

    def mouse(self, kind: str, x: float, y: float, is_down: bool = True) -> None:
        """Send a "Moved", "Pressed" or "Released" of the left button at a place in the window [px]."""
        button = "left" if is_down or kind != "Moved" else "none"
        held = 1 if is_down and kind != "Released" else 0
        self.tell("Input.dispatchMouseEvent", type=f"mouse{kind}", x=x, y=y, button=button, buttons=held, clickCount=1)

    def click(self, words: str) -> None:
        """Click the innermost element with exactly this text, once it has come to rest. Raises RuntimeError without one."""
        place = self._place_of(words)
        while place is not None and place != (place := self._place_of(words)):
            pass
        if place is None:
            raise RuntimeError(f"nothing says {words!r}")
        self.click_at(*place)

    def _place_of(self, words: str) -> list[float] | None:
        """Return the middle of the innermost element with exactly this text [px] a tenth of a second later."""
        time.sleep(0.1)
        found: list[float] | None = self.value(f"""(() => {{
          const found = [...document.querySelectorAll('*')].filter(e => e.textContent.trim() === {json.dumps(words)});
          if (!found.length) return null;
          const box = found[found.length - 1].getBoundingClientRect();
          return [box.x + box.width / 2, box.y + box.height / 2];
        }})()""")
        return found

    def click_at(self, x: float, y: float) -> None:
        """Move to a place in the window [px] and click there."""
        self.mouse("Moved", x, y, is_down=False)
        self.mouse("Pressed", x, y)
        self.mouse("Released", x, y)

    def key(self, key: str, seconds: float = 0.0) -> None:
        """Press a key, for some time, and release it."""
        code = key if key in NUMBERS else f"Key{key.upper()}"
        about = {"key": key, "code": {" ": "Space"}.get(key, code), "windowsVirtualKeyCode": NUMBERS.get(key) or ord(key.upper())}
        self.tell("Input.dispatchKeyEvent", type="keyDown", **about)
        time.sleep(seconds)
        self.tell("Input.dispatchKeyEvent", type="keyUp", **about)

    def press(self, keys: str | Sequence[str]) -> None:
        """Send keys to the page's own listener, without the browser's."""
        for key in keys:
            event = f"new KeyboardEvent('keydown', {{key: {json.dumps(key)}, bubbles: true}})"
            self.value(f"document.body.dispatchEvent({event})")

    def value(self, expression: str) -> Any:
        """Return the value of a JavaScript expression in the page. Raises RuntimeError if it throws."""
        found = self.tell("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in found:
            raise RuntimeError(str(found["exceptionDetails"]))
        return found["result"].get("value")

    def until(self, expression: str, patience: float = PATIENCE) -> None:
        """Wait until an expression is true. Raises RuntimeError if it never is."""
        end = time.monotonic() + patience
        while not self.value(expression):
            if time.monotonic() > end:
                raise RuntimeError(f"never true: {expression}")
            time.sleep(0.1)

    def screen(self, width: int, height: int, dark: bool = False, scale: float = 1.0) -> None:
        """Set the size of the window [px] and the preferred colour scheme."""
        self.tell("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=False)
        wish = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.tell("Emulation.setEmulatedMedia", features=[wish])

    def downloads(self, folder: Path) -> None:
        """Let the page save files, into `folder` and nowhere else."""
        self.tell("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(folder.resolve()))

    def picture(self, place: Path, clip: Mapping[str, float] | None = None) -> None:
        """Save a screenshot of the window as PNG, or of `clip` (x, y, width, height, scale) of the page."""
        about: dict[str, object] = {"format": "png"}
        if clip:
            about |= {"clip": dict(clip), "captureBeyondViewport": True}
        place.write_bytes(base64.b64decode(self.tell("Page.captureScreenshot", **about)["data"]))


@contextmanager
def browser(width: int = 1280, height: int = 900, dark: bool = False, scale: float = 1.0) -> Iterator[Browser]:
    """Yield a browser with a window of that size, closed at the end."""
    with Browser() as opened:
        opened.screen(width, height, dark, scale)
        yield opened
