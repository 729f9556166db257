"""The moving picture of README: a hand that is pushed into a table by the mouse, in a headless browser.

    python -m tests.look.live_picture

Needs a Chromium. Writes docs/pictures/live.webp, which belongs to no run, unlike those in reports/pictures.
"""

import base64
import io
import tempfile
import time
from pathlib import Path

from PIL import Image

from tests.look.browser import browser
from tests.look.look_live import HUD, Running

PLACE = Path(__file__).resolve().parents[2] / "docs" / "pictures" / "live.webp"
WIDE, HIGH = 980, 640
"""Window [px]; the panel is at its right."""
SHOWN = (640, 418)
"""Size of the picture [px]."""
PAUSE = 0.08
"""[s] between two frames of the picture."""
WAYS = ((0, 300, 22), (60, 0, 10), (-60, -300, 18))
"""Mouse paths [px], and their numbers of frames."""


def main() -> None:
    """Drive, take pictures, write them as one."""
    frames: list[Image.Image] = []
    with tempfile.TemporaryDirectory() as folder, Running("hand", Path(folder)) as running, browser(WIDE, HIGH) as one:
        one.visit(running.page.address)
        one.until(HUD)
        time.sleep(2.0)
        # the browser's own messages are no part of the picture
        one.value("document.querySelectorAll('.mantine-Notifications-root').forEach(e => e.remove())")
        root = running.page.driver.links[0]
        x, y = running.on_screen(running.state.positions[running.session.scene.names.index(root)])
        one.mouse("Moved", x, y, is_down=False)
        one.mouse("Pressed", x, y)
        for across, down, count in WAYS:
            for _ in range(count):
                x, y = x + across / count, y + down / count
                one.mouse("Moved", x, y)
                time.sleep(PAUSE)
                taken = base64.b64decode(one.tell("Page.captureScreenshot", format="png")["data"])
                frames.append(Image.open(io.BytesIO(taken)).convert("RGB").resize(SHOWN, Image.Resampling.LANCZOS))
        one.mouse("Released", x, y)
    frames[0].save(PLACE, save_all=True, append_images=frames[1:], duration=round(1e3 * PAUSE), loop=0, quality=60, method=6)
    print(f"{PLACE.name}: {len(frames)} frames, {PLACE.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
