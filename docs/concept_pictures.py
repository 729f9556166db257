"""Pictures of docs/concepts.md, drawn from the engine's own default settings: `python -m docs.concept_pictures` writes them."""

from pathlib import Path

from avatarsim.settings import PostureSettings

FOLDER = Path(__file__).resolve().parent / "pictures"
INK, WOOD, AVATAR, USER = "#222222", "#d9b98a", "#3b6fb5", "#8a4fbf"
"""Colours: violet is the user, as in the pages of a run."""
WIDTH, HEIGHT = 640, 260


def text(x: float, y: float, words: str, colour: str = INK, anchor: str = "start") -> str:
    """Words at a place, which is the left, middle or right of their line."""
    return f'<text x="{x:g}" y="{y:g}" fill="{colour}" text-anchor="{anchor}">{words}</text>'


def line(x: float, y: float, to_x: float, to_y: float, colour: str = INK, more: str = "") -> str:
    """A straight line, with arrow heads or dashes by further attributes."""
    return f'<line x1="{x:g}" y1="{y:g}" x2="{to_x:g}" y2="{to_y:g}" stroke="{colour}" stroke-width="1.5" {more}/>'


def slab(x: float, y: float, width: float, height: float) -> str:
    """A piece of a table or a wall."""
    return f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" fill="{WOOD}"/>'


def fist(x: float, y: float, is_user: bool, radius: float = 38.0) -> str:
    """A hand: of the avatar a full disc, of the user an outline, the ghost."""
    look = f'fill="none" stroke="{USER}" stroke-dasharray="5 4"' if is_user else f'fill="{AVATAR}" stroke="{AVATAR}"'
    return f'<circle cx="{x:g}" cy="{y:g}" r="{radius:g}" stroke-width="2.5" {look}/>'


ARROWS = 'marker-start="url(#head)" marker-end="url(#head)"'
DASHED = 'stroke-dasharray="3 4"'


def user_and_avatar() -> str:
    """User, avatar and the offset between them, at a table."""
    top, x, inside = 130.0, 250.0, 60.0
    at, shown = top - 38.0 + inside, top - 38.0
    return "".join((
        slab(60, top, 380, 90), fist(x, shown, False), fist(x, at, True),
        line(x + 52, shown, x + 52, at, INK, ARROWS), text(x + 62, 0.5 * (shown + at) + 5, "offset"),
        text(x - 55, shown, "avatar: on the screen", AVATAR, "end"), text(x - 55, at + 12, "user: the tracker", USER, "end"),
        text(455, top + 18, "a table: nothing"), text(455, top + 38, "goes through it"),
    ))


def stand_off() -> str:
    """The gap that an avatar aims at, the gap that it accepts, and touch, drawn so that a tenth of a millimetre is seen."""
    aimed = 1e3 * PostureSettings().stand_off
    touch, scale = 200.0, 130.0 / aimed
    rows = ((aimed, f"stand-off, {aimed:g} mm: the gap that is aimed at"), (0.25 * aimed, f"{0.25 * aimed:g} mm: still accepted"),
            (0.0, "0: touch; an overlap begins below"))
    levels = "".join(
        line(40, touch - scale * gap, 330, touch - scale * gap, INK, DASHED) + text(340, touch - scale * gap + 5, words)
        for gap, words in rows
    )
    bottom = touch - scale * aimed
    return "".join((
        slab(40, touch, 290, 40), f'<path d="M 60 {bottom - 50:g} Q 185 {bottom + 50:g} 310 {bottom - 50:g} Z" fill="{AVATAR}"/>',
        text(185, bottom - 18, "hand", "#ffffff", "middle"), levels, text(185, touch + 26, "table", INK, "middle"),
    ))


def ghost() -> str:
    """The ghost at three instants: free, held off by a wall, and free again."""
    titles = (110, "free"), (330, "held off"), (525, "catches up")
    parts = [text(x, 30, words, INK, "middle") for x, words in titles]
    parts += [slab(330, 55, 80, 150), fist(110, 130, False), fist(110, 130, True, 42.0)]
    parts += [fist(290, 130, False), fist(370, 130, True), line(290, 130, 370, 130, USER)]
    parts += [fist(470, 130, False), fist(580, 130, True), line(510, 130, 540, 130, INK, 'marker-end="url(#head)"')]
    parts += [text(110, 235, "one behind the other", INK, "middle"), text(330, 235, "the ghost is in the wall", USER, "middle"),
              text(525, 235, "no faster than a limit", AVATAR, "middle")]
    return "".join(parts)


PICTURES = {"user_and_avatar": user_and_avatar, "stand_off": stand_off, "ghost": ghost}


def svg_of(name: str) -> str:
    """The SVG of a picture, on a ground of its own, so that it is read on dark pages too."""
    head = '<marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="8" markerHeight="8" orient="auto-start-reverse">'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" '
        f'font-family="sans-serif" font-size="15"><defs>{head}<path d="M 0 0 L 8 4 L 0 8 z" fill="{INK}"/></marker></defs>'
        f'<rect width="{WIDTH}" height="{HEIGHT}" rx="8" fill="#ffffff"/>{PICTURES[name]()}</svg>\n'
    )


if __name__ == "__main__":
    for picture in PICTURES:
        (FOLDER / f"{picture}.svg").write_text(svg_of(picture), encoding="utf-8")
