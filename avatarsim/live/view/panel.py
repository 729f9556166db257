"""Widgets of the page: overlaps over the scene, buttons, switches, clips, keys, and timing folded away."""

import re
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from functools import partial
from typing import TYPE_CHECKING, Any, cast

import viser
from viser._messages import HotkeyKey

from avatarsim.live.drive.keys import KEYS
from avatarsim.live.messages import Order, Switch
from avatarsim.live.view.cameras import VIEWS
from avatarsim.live.view.page_text import FIRST_VISIT, STYLE
from avatarsim.live.view.server import AdmittingServer

if TYPE_CHECKING:
    from avatarsim.live.view.page import Page

EFFECTS = {
    "friction": "friction", "restitution": "restitution (bounces)", "coupling": "coupling (what is struck pushes back)",
    "self_contact": "self-contact", "limits": "joint limits", "dynamics": "loose bodies move",
}
"""Effects that can be switched, and their labels on the panel."""
NAMED = {" ": "space"}
"""Names of keys that are not shown as they are."""
TAKE: HotkeyKey = "C"
"""Key that takes or releases the bodies that the avatar touches; neither the driver nor the camera uses it."""
METHODS = {"default": "default: certified", "paper": "paper: equations as printed"}
"""Presets of the driven engine, and their labels on the panel."""


class Panel:
    """Widgets, and their actions on the page's session and driver; each runs in the page's own thread."""

    def __init__(self, server: AdmittingServer, page: "Page", clips: Sequence[str], dark: bool) -> None:
        self._server, self._page = server, page
        self._switched = Switch((), page.method)
        gui = server.gui
        gui.set_panel_label("avatarsim live")
        gui.configure_theme(dark_mode=dark, show_logo=False, show_share_button=False)
        gui.add_html(STYLE + FIRST_VISIT)
        self.numbers = gui.add_html("")
        if page.shows.offered:
            group = gui.add_button_group("Compare with", tuple(plan.name for plan in page.shows.offered))
            self._on(group.on_click, lambda: page.compare(group.value))
        self._run_buttons()
        # below the buttons, which would move under the pointer as lines come and go
        self._words = gui.add_markdown("**Loading**")
        self._trouble = gui.add_markdown("", visible=False)
        if clips:
            with gui.add_folder("Clips", expand_by_default=False):
                self._clip_buttons(clips)
        with gui.add_folder("Effects and method", expand_by_default=False):
            self._effects = {name: gui.add_checkbox(text, True) for name, text in EFFECTS.items()}
            self._method = gui.add_dropdown("Method", tuple(METHODS.values()), initial_value=METHODS[page.method])
            for box in self._effects.values():
                self._on(box.on_update, self._switch)
            self._on(self._method.on_update, self._switch)
        with gui.add_folder("View", expand_by_default=False):
            self._view_boxes()
        with gui.add_folder("Keys", expand_by_default=False):
            gui.add_markdown("\n".join(f"- **{NAMED.get(key.key, key.key)}** {key.what}" for key in KEYS))
            gui.add_markdown(f"- **{TAKE.lower()}** take what the avatar touches, or let go")
            gui.add_markdown("Drag any part of the avatar with the mouse; with shift it goes away from you and back.")
            gui.add_markdown("The keys w a s d q e and the arrows fly the camera; Home brings it back.")
            for key in KEYS:
                hotkey = cast(HotkeyKey, NAMED.get(key.key, key.key.upper()))
                self._on(gui.add_command(key.what, hotkey=hotkey).on_trigger, partial(self._press, key.key))
        with gui.add_folder("Timing", expand_by_default=False):
            self._timing = gui.add_markdown("")
            self._table = gui.add_markdown("")

    def _on(self, bind: Callable[[Callable[..., Any]], Any], act: Callable[[], object]) -> None:
        """Run `act` in the page's thread whenever a widget fires."""
        async def fired(event: object) -> None:
            self._page.post(act)

        bind(fired)

    @staticmethod
    def _here(bind: Callable[[Callable[..., Any]], Any], act: Callable[[], object]) -> None:
        """Run `act`, which only draws, in the server's thread whenever a widget fires."""
        async def fired(event: object) -> None:
            act()

        bind(fired)

    def _run_buttons(self) -> None:
        gui = self._server.gui
        rows: tuple[tuple[str, dict[str, Callable[[], object]]], ...] = (
            ("Time", {"Pause": self._pause, "Step": lambda: self._ordered(Order.STEP), "Reset": self._reset}),
            ("Hands", {"Take or let go": self._take}),
            ("State", {
                "Keep": lambda: self._ordered(Order.KEEP), "Back": lambda: self._ordered(Order.BACK),
                "Save recording": self._save,
            }),
        )
        for label, acts in rows:
            group = gui.add_button_group(label, tuple(acts))
            self._on(group.on_click, partial(self._chosen, group, acts))
        pinch = gui.add_checkbox("Take what is pinched", False, hint="while fingers press on it from opposite sides")
        self._on(pinch.on_update, lambda: self._ordered(Order.PINCH, pinch.value))
        self._on(gui.add_command(f"{TAKE}: take what the avatar touches, or let go", hotkey=TAKE).on_trigger, self._take)
        share = gui.add_button_group("Share", ("Record 6 s", "Share"), hint="a GIF; a page that plays the last seconds")
        share.on_click(self._share)
        camera = gui.add_button_group("Camera", tuple(VIEWS))
        camera.on_click(self._look)
        gui.add_command("Home: the first view again", hotkey="home").on_trigger(self._look)

    async def _share(self, event: viser.GuiEvent[viser.GuiButtonGroupHandle]) -> None:
        """Send the viewer of an event a moving picture or a page."""
        if event.client is not None:
            (self._page.share if event.target.value == "Share" else self._page.film)(event.client)

    async def _look(self, event: viser.GuiEvent[viser.GuiButtonGroupHandle] | viser.CommandEvent) -> None:
        """Give the viewer of an event one of the views: that of the button, or the first one."""
        view = event.target.value if isinstance(event, viser.GuiEvent) else next(iter(VIEWS))
        if event.client is not None:
            self._page.worlds.look(event.client.camera, view)

    def _clip_buttons(self, clips: Sequence[str]) -> None:
        gui = self._server.gui
        chosen = gui.add_dropdown("Clip", tuple(clips))
        self._on(gui.add_button("Play").on_click, lambda: self._page.driver.play(self._page.shows.clips[chosen.value]))
        self._on(gui.add_button("Take over").on_click, self._page.driver.take_over)

    def _view_boxes(self) -> None:
        gui, page = self._server.gui, self._page
        ghost = gui.add_checkbox("Your own posture, as a ghost", True)
        self._here(ghost.on_update, lambda: page.worlds.meshes[page.session.first.plan.name].see_ghost(ghost.value))
        if page.shows.stage.visuals:
            tested = gui.add_checkbox("Shapes that are tested", False, hint="the convex pieces that overlap is tested with")
            self._here(tested.on_update, lambda: self._test(tested.value))
        gizmos = gui.add_checkbox("Gizmos", False)
        self._here(gizmos.on_update, lambda: page.see_gizmos(gizmos.value))

    def _test(self, tested: bool) -> None:
        for one in self._page.worlds.meshes.values():
            one.test(tested)

    def _ordered(self, order: Order, value: object = None) -> bool:
        """Send a command to all loops and show the driven one's refusal or report; return True if it was not refused."""
        answer = self._page.session.command(order, value)[self._page.session.first.plan.name]
        self.show_message(answer.refused or answer.text)
        return not answer.refused

    def _take(self) -> None:
        self._ordered(Order.TAKE)

    @staticmethod
    def _chosen(group: viser.GuiButtonGroupHandle, acts: Mapping[str, Callable[[], object]]) -> None:
        acts[group.value]()

    def _press(self, key: str) -> None:
        self.show_message(self._page.driver.press(key))

    def _pause(self) -> None:
        state = self._page.session.first.look()
        self._ordered(Order.GO_ON if state is not None and state.is_paused else Order.PAUSE)

    def _reset(self) -> None:
        if self._ordered(Order.RESET):
            self._page.driver.reset()

    def _switch(self) -> None:
        off = tuple(name for name, box in self._effects.items() if not box.value)
        preset = next(name for name, text in METHODS.items() if text == self._method.value)
        wanted = Switch(off, preset)
        if wanted == self._switched:
            return
        if self._ordered(Order.SWITCH, wanted):
            self._switched = wanted
            return
        self._server.post(self._show_switched)

    def _show_switched(self) -> None:
        """Set the boxes to the current settings, after a refused switch."""
        for name, box in self._effects.items():
            box.value = name not in self._switched.off  # type: ignore[misc]
        self._method.value = METHODS[self._switched.preset]  # type: ignore[misc]

    def _save(self) -> None:
        # a name that a shell takes as one word
        name = re.sub(r"\W+", "-", self._page.session.scene.name)
        path = self._page.shows.folder / f"{name}-{datetime.now():%Y%m%d-%H%M%S}.live"
        self._page.session.save(path)
        self.show_message(f"Saved as {path}. `avatarsim replay {path}` runs it again.")

    @property
    def off(self) -> tuple[str, ...]:
        """Effects that are switched off."""
        return self._switched.off

    def show_message(self, words: str) -> None:
        """Show an error or a result; nothing for an empty text. Callable from any thread."""
        self._server.post(self._set_message, words)

    def _set_message(self, words: str) -> None:
        self._trouble.content, self._trouble.visible = words, bool(words)

    def show_numbers(self, numbers: str, words: str) -> None:
        """Show overlaps over the scene and words on the panel."""
        self.numbers.content, self._words.content = numbers, words

    def time(self, table: str, words: str) -> None:
        """Show timing: a table and words."""
        self._table.content, self._timing.content = table, words
