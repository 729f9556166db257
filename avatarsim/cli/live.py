"""The command `avatarsim live`: a session, its page and its ports, until it is stopped."""

import argparse
import socket
import sys
import time
import webbrowser
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import reduce
from pathlib import Path

from avatarsim.assets.models.model import Model, in_room, with_carried
from avatarsim.assets.models.preflight import MODELS
from avatarsim.cleaning.chords import Chords
from avatarsim.cleaning.start import free_posture
from avatarsim.cli.option_words import in_words
from avatarsim.cli.reading import reading_of
from avatarsim.clips.reading import Reading
from avatarsim.engine import Settings
from avatarsim.errors import InvalidFile, InvalidInput
from avatarsim.live.messages import RATES, Plan
from avatarsim.live.ports.admission import as_address
from avatarsim.live.ports.server import HIGHEST_PORT, Ports
from avatarsim.live.recording import ENGINE
from avatarsim.live.session import LoopDied, Session
from avatarsim.live.show import require_page
from avatarsim.live.stages import Stage, stage
from avatarsim.live.view.depth import Depth, own_depth, still
from avatarsim.scene.carried import joined
from avatarsim.scene.checks import within
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene

ENDED, DIED, UNREADABLE = 0, 1, 3
"""Exit codes."""
SCENE = "toys"
"""Scene that is shown by default."""
MARGIN = 1e-3
"""[m] about the first posture of a user's own avatar, as in cleaning."""
DEFAULT_READING = Reading()
"""Default options for reading files."""


def run(args: argparse.Namespace) -> int:
    """Return the exit code. Raises InvalidInput for options that do not fit, MissingPackage without the page's library."""
    require_page()
    try:
        chosen, model = _stage(args)
        clips = clips_of(args.motion, chosen.scene, model, reading_of(args))
    except InvalidFile as error:
        print(f"avatarsim: {in_words(str(error), 'live')}", file=sys.stderr)
        return UNREADABLE
    return drive(args, chosen, clips, (), own_depth(chosen.scene))


def _stage(args: argparse.Namespace) -> tuple[Stage, Model | None]:
    """Return the scene of the options and the model of a user's own avatar.
    Raises InvalidInput for both a built-in avatar and a file, InvalidFile for unreadable files."""
    if args.avatar is None:
        if args.room is not None:
            raise InvalidInput("--room", str(args.room), "an option beside --avatar, which goes about in it")
        return stage(args.scene or SCENE), None
    if args.scene is not None:
        raise InvalidInput("--scene", args.scene, "no option beside --avatar")
    from avatarsim.assets.models.load import load_avatar, load_room

    reading = reading_of(args)
    model = load_avatar(args.avatar, **reading.of_avatar())  # type: ignore[arg-type]
    is_model = args.room is not None and args.room.suffix.lower() in MODELS
    rooms = () if args.room is None else (load_room(args.room, **reading.of_room(is_model, True)),)  # type: ignore[arg-type]
    for note in (*model.notes, *(note for room in rooms for note in room.notes)):
        print(f"avatarsim: {in_words(note, 'live')}", file=sys.stderr)
    if model.avatar is None:
        raise InvalidFile(f"avatar in {args.avatar.name}", "none", "a file with joints; a room goes with --room")
    together = reduce(in_room, rooms, model)
    if args.motion and reading.object_file is not None:
        # of the first clip: the scene has one object
        from avatarsim.clips.inputs import carried_in, options_for, read

        together = with_carried(together, carried_in(read(args.motion[0], options_for(args.motion[0], reading))[0], reading))
    scene = together.scene(args.avatar.stem)
    own = Stage(scene)
    start = free_posture(Chords(still(own.scene)), own.scene.first_sample, MARGIN)
    return replace(own, scene=replace(own.scene, start=start), visuals=together.visuals), model


def clips_of(
    paths: Sequence[Path], scene: Scene, model: Model | None, reading: Reading = DEFAULT_READING
) -> Mapping[str, Motion]:
    """Return the motions of files for an avatar, with the objects of them that the scene has, by the files' names.

    Raises InvalidFile for files that are unreadable or do not fit."""
    from avatarsim.clips.inputs import carried_in, options_for, read

    clips = {}
    for path in paths:
        if model is None:
            raise InvalidFile(f"motion {path.name}", scene.name, "one beside --avatar, whose joints it moves")
        file = read(path, options_for(path, reading))[0]
        motion, known = file.motion(model), [one.name for one in scene.avatars[1:2]]
        clips[path.name] = joined(motion, [one for one in carried_in(file, reading) if one.body.name in known])
    return clips


def require_place(listen: str, port: int) -> None:
    """Raise InvalidInput for an address of another machine or an invalid port: the page's server would never start."""
    address = as_address(listen)
    if not 0 <= port <= HIGHEST_PORT:
        raise InvalidInput("--port", port, f"a whole number from 0, which lets the system choose, to {HIGHEST_PORT}")
    family = socket.AF_INET6 if ":" in address else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as end:
        try:
            end.bind((address, 0))
        except OSError as error:
            raise InvalidInput("--listen", listen, f"an address of this machine ({error.strerror})") from error


def _print_ports(ports: Ports) -> None:
    """Print the ports at which trackers and renderers find this session."""
    for kind, (host, port) in ports.addresses.items():
        print(f"avatarsim: {kind} at {host}:{port}", file=sys.stderr)
    if ports.hands:
        print(f"avatarsim: tracked hands of a headset: {ports.hands}", file=sys.stderr)


def _print_refusal(source: str, sentence: str) -> None:
    """Print the first refusal of a peer of the ports."""
    print(f"avatarsim: refused from {source}: {sentence}; further refusals are counted on the page", file=sys.stderr, flush=True)


def drive(
    args: argparse.Namespace, chosen: Stage, clips: Mapping[str, Motion], others: Sequence[Plan], depth: Depth | None,
    offered: Sequence[Plan] = (),
) -> int:
    """Run a session of avatarsim and of other engines until it is stopped, and return the exit code.

    Args:
        args: options of the command.
        chosen: the scene to drive.
        clips: motions by name.
        others: loops that run alongside from the start.
        depth: how overlap is measured.
        offered: loops that the page can start.

    Raises:
        InvalidInput: for an option. LoopRefused: for a preset or a scene that an engine does not take."""
    from avatarsim.live.drive.driver import Driver
    from avatarsim.live.view.page import Page, Shows

    rate = within("--rate", args.rate, *RATES, InvalidInput)
    seconds = None if args.seconds is None else within("--seconds", args.seconds, 0.0, 1e6, InvalidInput)
    own_plan = Plan(ENGINE, chosen.scene, Settings(preset=args.method, time_stages=True), rate)
    require_place(args.listen, args.port)
    for name, port in (("--ws", args.ws), ("--udp", args.udp)):
        if port is not None and not 0 <= port <= HIGHEST_PORT:
            raise InvalidInput(name, port, f"a whole number from 0, which lets the system choose, to {HIGHEST_PORT}")
    print("avatarsim: loading", file=sys.stderr)
    try:
        with ExitStack() as stack:
            session = stack.enter_context(Session([own_plan, *others]))
            shows = Shows(chosen, clips, depth, args.listen, args.port, args.dark, args.save, offered)
            page = Page(session, Driver(chosen.scene), shows)
            stack.callback(page.close)
            if args.ws is not None or args.udp is not None:
                page.ports = stack.enter_context(
                    Ports(chosen.scene, page.track, args.listen, args.udp, args.ws, on_refusal=_print_refusal)
                )
                _print_ports(page.ports)
            print(f"avatarsim: {page.address} (Ctrl-C ends it)", file=sys.stderr, flush=True)
            if not args.no_browser:
                webbrowser.open(page.address)
            end = None if seconds is None else time.monotonic() + seconds
            page.rounds(lambda: end is not None and time.monotonic() >= end)
    except KeyboardInterrupt:
        return ENDED
    except LoopDied as error:
        print(f"avatarsim: {error}", file=sys.stderr)
        return DIED
    return ENDED
