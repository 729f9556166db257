"""The comparison as text: a line per scene, how often each is nearer, and what is known of every figure in which the other is."""

from collections.abc import Iterator, Sequence

from scenarios.beside.pair import ALIKE, Beside

FIGURES = ("offset", "angle")
"""What is promised to be no larger than the other engine's; the body's distance is a third, of both together."""
UNSAID = "it cannot say in full"
"""What precedes the features of a scene that the other engine cannot be asked for."""


def table(found: Sequence[Beside], theirs: str) -> str:
    """A line per scene, how often each is nearer, and a line per figure in which theirs is."""
    lines = [
        f"Distance from the user, rms over the frames in which {theirs} leaves at most 1 mm of overlap on the legal side:",
        "offset of link origins, angle of joints, body: of all points of the links, which both of them move.",
        f"{'scene':24s} {'frames':>10s} {'offset mm: ours':>16s} {'theirs':>9s} {'nearer':>7s} {'angle deg: ours':>16s} "
        f"{'theirs':>9s} {'nearer':>7s} {'body mm: ours':>16s} {'theirs':>9s} {'nearer':>7s}",
    ]
    for r in found:
        offset, angle = r.winner
        lines.append(
            f"{r.scenario:24s} {r.counted:5d}/{r.frames:<4d} {1e3 * r.offset:16.3f} {1e3 * r.their_offset:9.3f} {offset:>7s} "
            f"{r.angle:16.3f} {r.their_angle:9.3f} {angle:>7s} {1e3 * r.body:16.3f} {1e3 * r.their_body:9.3f} {r.body_winner:>7s}"
        )
    return "\n".join((*lines, *_counted(found, theirs), *_explained(found, theirs)))


def _counted(found: Sequence[Beside], theirs: str) -> Iterator[str]:
    kept = f", only frames in which {theirs} keeps the joints' limits too"
    alike = f", only frames in which all loose bodies are within {1e3 * ALIKE:g} mm of where they are in ours"
    for what, among, winners in (
        *((what, "", [r.winner[k] for r in found]) for k, what in enumerate(FIGURES)),
        ("body", "", [r.body_winner for r in found]),
        *((what, kept, [r.kept.winner[k] for r in found]) for k, what in enumerate(FIGURES)),
        *((what, alike, [r.alike.winner[k] for r in found]) for k, what in enumerate(FIGURES)),
    ):
        said = (f"{side} {winners.count(side)}" for side in ("ours", "theirs", "same", "-"))
        yield f"{what}, scenes by who is nearer{among}: {', '.join(said)}"


def _explained(found: Sequence[Beside], theirs: str) -> Iterator[str]:
    lost = [(what, k, r) for k, what in enumerate(FIGURES) for r in found if r.winner[k] == "theirs"]
    if lost:
        yield f"Where {theirs} is nearer:"
    for what, k, r in lost:
        yield f"  {r.scenario}, {what}: {known(r)[k] or 'nothing to add'}"


def known(r: Beside) -> tuple[str, str]:
    """What is to be known of the offset and of the angle where the other engine is nearer; else nothing."""
    offset, angle = (_kept(r, k) for k in range(len(FIGURES)))
    if r.their_angle < r.least_angle:
        angle = [f"no posture within the joints' limits has less than {r.least_angle:.1f} deg"]
    also = [f"{r.body_winner} is nearer with all of the body"] if r.body_winner in ("ours", "theirs") else []
    also += [f"{UNSAID}: {r.unsaid}"] if r.unsaid else []
    told = ("; ".join([*said, *_alike(r, k), *also]) if r.winner[k] == "theirs" else "" for k, said in enumerate((offset, angle)))
    return next(told), next(told)


def _kept(r: Beside, figure: int) -> list[str]:
    """Whether theirs is nearer only by leaving the limits."""
    if r.kept.winner[figure] == "theirs":
        return []
    if r.kept.frames == 0:
        return ["it keeps the joints' limits in no frame"]
    return [f"only where it leaves the joints' limits, not in the {r.kept.frames} of {r.counted} frames in which it keeps them"]


def _alike(r: Beside, figure: int) -> list[str]:
    """Whether theirs is nearer only in another world: a hand that let a mug fall is at its user's."""
    if r.alike.winner[figure] == "theirs":
        return []
    if r.alike.frames == 0:
        return ["its loose bodies are elsewhere than in ours in every frame"]
    near = f"the {r.alike.frames} of {r.counted} frames in which they are within {1e3 * ALIKE:g} mm"
    return [f"only where loose bodies are elsewhere than in ours, not in {near}"]
