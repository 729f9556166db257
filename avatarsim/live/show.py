"""A window for the user's own loop, and pages of recordings: `avatarsim.show`."""

import tempfile
import webbrowser
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, overload

from avatarsim.errors import InvalidInput, MissingPackage
from avatarsim.live.recording import read
from avatarsim.simulator import AvatarsimEngine

if TYPE_CHECKING:
    from avatarsim.live.view.window import Window

PACKAGES = ("viser", "websockets")
"""Packages of the extra `view`."""


def require_page() -> None:
    """Raise MissingPackage if a page cannot be shown."""
    for package in PACKAGES:
        if find_spec(package) is None:
            raise MissingPackage(package, "view", "the page of a live session")


@overload
def show(what: AvatarsimEngine, *, port: int = 8080, opens_browser: bool = True) -> "Window": ...
@overload
def show(what: str | Path, *, port: int = 8080, opens_browser: bool = True) -> Path: ...


def show(what: AvatarsimEngine | str | Path, *, port: int = 8080, opens_browser: bool = True) -> "Window | Path":
    """Show a loaded engine in a window on the user's own loop, or a recording as a page that plays it.

    Args:
        what: an engine, or the path of a file of `avatarsim live`.
        port: of the window's page.
        opens_browser: flag: open it in the browser.

    Returns:
        The window, whose `sync` is called after each frame; for a recording the path of the page.

    Raises:
        MissingPackage: without the extra `view`. InvalidFile: if a file is no recording. InvalidInput: for anything else.
    """
    require_page()
    if isinstance(what, AvatarsimEngine):
        from avatarsim.live.view.window import Window

        return Window(what, port, opens_browser)
    if not isinstance(what, str | Path):
        raise InvalidInput("what to show", type(what).__name__, "an AvatarsimEngine, or the path of a recording")
    path = Path(tempfile.mkdtemp(prefix="avatarsim-")) / f"{Path(what).stem}.html"
    path.write_bytes(recording_page(Path(what)))
    if opens_browser:
        webbrowser.open(path.as_uri())
    return path


def recording_page(path: Path) -> bytes:
    """Return a page that plays a recording and marks its worst moments. Raises the errors of `show`."""
    from avatarsim.live.view.share import recorded, shared_page

    found = read(path)
    return shared_page(found.plan.scene, recorded(found), {})
