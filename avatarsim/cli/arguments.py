"""Command line: every option of every command, with its help (argparse)."""

import argparse
from pathlib import Path

from avatarsim.cli.reading import reading_options
from avatarsim.console import path_option
from avatarsim.files import VARIABLE

RAW = argparse.RawDescriptionHelpFormatter

MOTION = ".bvh .amc .npz .csv .txt, or a folder of them"

CLEAN = """\
The nearest motions without overlap, within joint limits, in the format they came in. Every written frame is proved free, and so
is every way from one frame to the next, as a player shows it. Folders are taken whole; clips that are done are not done again.

examples:
  avatarsim clean walk.bvh --room floor -o cleaned
      a recording on its own skeleton, on level ground
  avatarsim clean retargeted/ --avatar robot.xml --room kitchen.glb --room-up y -o cleaned --workers 8
      a folder of clips of a robot, in a scanned room
  avatarsim clean 02_01.amc --asf 02.asf --room floor --rate 30 -o cleaned"""

CLEAN_END = """\
in the output folder: the motions, with the layout of the folders that were named; certificate.json, with what was measured of
each clip; index.html, which leads to a page that plays each clip before and after.

exit codes: 0 clean; 1 something is not, or no free posture was found; 2 wrong usage; 3 something could not be read or done, which
is named, and the rest is done; 130 stopped, and the same command goes on."""

AUDIT = """\
Measures of motions as they are: frames and depth in overlap, ways between frames that are not certified free, joints outside
their limits, jerk. Nothing is written, unless -o names a folder for audit.json.

examples:
  avatarsim audit walk.bvh --room floor
  avatarsim audit retargeted/ --avatar robot.xml -o measures"""

AUDIT_END = """\
exit codes: 0 clean; 1 overlap, ways that are not certified, or joints outside limits were found; 2 wrong usage; 3 something could
not be read, which is named, and the rest is done."""


LIVE = """\
Drive an avatar by mouse, keys, clips or a tracker, among things that it touches and never overlaps. Opens a page in the browser;
nothing listens beyond this machine unless --listen says so.

examples:
  avatarsim live
      a hand over a table: drag it with the mouse, push it into the wood
  avatarsim live --scene gallery --dark
      a human in two rooms with things that roll and fall
  avatarsim live --avatar robot.xml --room kitchen.glb --motion retargeted/reach.csv
      a robot of your own, in your own room, and a clip to take over from
  avatarsim live --udp 9870
      driven by your own tracker; docs/live_ports.md has a client of ten lines"""

LIVE_END = """\
exit codes: 0 ended by Ctrl-C; 1 the engine's process ended by itself; 2 wrong usage, or a port that is taken; 3 a file that could
not be read, or too little memory."""

REPLAY = """\
Run a recording of `avatarsim live` again, without a page: the same samples and commands, and after each frame the hash of what is
shown, against the one that was recorded.

example:
  avatarsim replay hand-20260101-120000.live"""

REPLAY_END = """\
exit codes: 0 the same to the bit; 1 another state was shown, and the first such frame is named; 2 wrong usage; 3 no recording, or
too little memory."""


COMPARE_USAGE = "avatarsim compare SCENE ... [--motion FILE] [--gate ENGINE/PRESET] [--max-overlap LENGTH] [options]"
COMPARE = """\
Run a scene of yours in every physics engine that is installed, measure what each shows, and hold some of them to limits.
An engine that is not installed is listed with the command that installs it, and fails nothing unless it is gated.

examples:
  avatarsim compare cell.xml --motion joints.csv
      a table of all engines
  avatarsim compare cell.xml --motion joints.csv --max-overlap 1mm --gate mujoco/tuned --junit out.xml
      a check for CI: ends with 1 if MuJoCo overlaps by more than 1 mm
  avatarsim compare cell.xml --gate mujoco --max joint_limit_excess_max=0.5deg --max frame_time_p95=2ms
      limits on any metric; `avatarsim compare --metrics` lists them
  avatarsim compare cell.xml --drift cell.drift.json
      figures against those that --update-drift kept: fails where a new version of an engine moves one"""

COMPARE_END = """\
exit codes: 0 all limits hold; 1 a gated engine exceeds one, or a figure has drifted; 2 wrong usage, or a file that cannot be
read; 3 a gated engine is missing, crashed or refuses the scene, or a limit was not measured; 130 stopped."""



def parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line."""
    top = argparse.ArgumentParser(prog="avatarsim", description="Without a command: as `avatarsim compile`.")
    top.add_argument("--parts", metavar="PART", nargs="+", help=argparse.SUPPRESS)
    commands = top.add_subparsers(dest="command", title="commands", metavar="COMMAND")
    clean = commands.add_parser(
        "clean", help="motions made free of overlap, with a certificate", description=CLEAN, epilog=CLEAN_END,
        formatter_class=RAW, usage="avatarsim clean MOTION ... -o DIR [--avatar FILE] [--room FILE | floor] [options]",
    )
    clean.add_argument("motions", nargs="+", metavar="MOTION", type=path_option, help=MOTION)
    clean.add_argument("-o", "--out", required=True, metavar="DIR", type=path_option, help="folder of what is written")
    _scene(clean)
    _cleaning(clean)
    _opinion(clean)
    clean.add_argument("--no-page", action="store_true", help="no pages that play clips")
    clean.add_argument("--force", action="store_true", help="do again what is done, and write over files of other programs")
    _running(clean)
    reading_options(clean)
    audit = commands.add_parser(
        "audit", help="what is wrong with motions, measured", description=AUDIT, epilog=AUDIT_END, formatter_class=RAW,
        usage="avatarsim audit MOTION ... [--avatar FILE] [--room FILE | floor] [-o DIR] [options]",
    )
    audit.add_argument("motions", nargs="+", metavar="MOTION", type=path_option, help=MOTION)
    audit.add_argument("-o", "--out", metavar="DIR", type=path_option, help="folder for audit.json")
    _opinion(audit)
    _scene(audit)
    _running(audit)
    reading_options(audit)
    compare = commands.add_parser("compare", help="a scene of your own in every physics engine, with limits", add_help=False)
    compare.add_argument("rest", nargs=argparse.REMAINDER)
    pieces = commands.add_parser("pieces", help="convex pieces of mesh files, with error bounds", add_help=False)
    pieces.add_argument("rest", nargs=argparse.REMAINDER)
    _live(commands)
    _compiling(commands)
    return top


def options_of(command: str) -> frozenset[str]:
    """Return names of a command's options, without dashes; none for an unknown command."""
    for action in parser()._actions:
        if isinstance(action, argparse._SubParsersAction) and command in action.choices:
            return frozenset(name.lstrip("-") for one in action.choices[command]._actions for name in one.option_strings)
    return frozenset()


def _live(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    live = commands.add_parser(
        "live", help="drive an avatar in the browser", description=LIVE, epilog=LIVE_END, formatter_class=RAW,
        usage="avatarsim live [--scene toys | hand | gallery | house] [--avatar FILE] [--room FILE | floor] [options]",
    )
    live_options(live)
    live.add_argument("--scene", choices=("hand", "toys", "gallery", "house"), help="a scene that is built in (default: toys); "
                      "those of the catalogue: python -m scenarios.live in a checkout")
    live.add_argument("--avatar", metavar="FILE", type=path_option, help="an avatar of your own: MJCF, URDF")
    live.add_argument("--room", metavar="FILE", type=path_option, help="your own room: MJCF, URDF, a mesh, or the word floor")
    reading_options(live)
    replay = commands.add_parser(
        "replay", help="run a recording again, and compare it bit for bit", description=REPLAY, epilog=REPLAY_END,
        formatter_class=RAW,
    )
    replay.add_argument("recording", metavar="FILE", type=path_option, help="as `avatarsim live` saves it")
    replay.add_argument("--json", action="store_true", help="one JSON object instead of sentences")
    replay.add_argument("--page", metavar="FILE", type=path_option, help="also write a page that plays it, worst moments marked")


def live_options(live: argparse.ArgumentParser) -> None:
    """Add the options of all commands that drive an avatar live."""
    live.add_argument("--motion", metavar="FILE", nargs="+", type=path_option, default=[], help=f"clips to play: {MOTION}")
    live.add_argument("--rate", type=float, default=60.0, metavar="HZ", help="frames a second (default 60)")
    live.add_argument("--method", choices=("default", "paper"), default="default", help="of our engine (default: default)")
    live.add_argument("--port", type=int, default=8080, metavar="N", help="of the page (default 8080, or the next that is free)")
    live.add_argument("--ws", type=int, metavar="PORT", help="take tracker samples and give poses by WebSocket at this port")
    live.add_argument("--udp", type=int, metavar="PORT", help="take tracker samples by UDP at this port")
    live.add_argument("--listen", metavar="ADDRESS", default="127.0.0.1",
                      help="where page and ports listen (default 127.0.0.1, this machine alone; on another address "
                      "whatever reaches it drives your avatar)")
    live.add_argument("--dark", action="store_true", help="begin with a dark page")
    live.add_argument("--save", metavar="DIR", type=path_option, default=Path(), help="folder for recordings (default: here)")
    live.add_argument("--no-browser", action="store_true", help="print the address only")
    live.add_argument("--seconds", type=float, metavar="S", help="end after so long (default: at Ctrl-C)")


def _scene(one: argparse.ArgumentParser) -> None:
    scene = one.add_argument_group("scene")
    scene.add_argument("--avatar", metavar="FILE", type=path_option,
                       help="MJCF or URDF model of the avatar; a BVH or AMC recording brings its own skeleton")
    scene.add_argument("--room", metavar="FILE", type=path_option,
                       help="MJCF, URDF or mesh (.obj .stl .ply .glb .dae) of the fixed room, or the word floor")
    scene.add_argument("--loose", action="store_true",
                       help="leave out the loose bodies of files; else they stand still where they are")


def height_option(text: str) -> float | None:
    """Convert text to a height [m]; None for "auto"."""
    return None if text == "auto" else float(text)


def _cleaning(one: argparse.ArgumentParser) -> None:
    cleaning = one.add_argument_group("cleaning")
    cleaning.add_argument("--margin", type=float, default=None, metavar="M", help="gap that is kept [m] (default 0.001)")
    cleaning.add_argument("--blend", type=float, default=None, metavar="S",
                          help="how long limbs take to give way at a contact [s] (default 0.1)")
    cleaning.add_argument("--ground", type=height_option, default=None, metavar="auto | M",
                          help="height of the ground in the motion [m], which is put at 0; auto: clips that are in the room in "
                          "every frame are raised by a constant (default)")


def _opinion(one: argparse.ArgumentParser) -> None:
    one.add_argument("--no-opinion", action="store_true",
                     help="do not ask coal, an independent library, for a second opinion where it is installed: twice as fast")


def _running(one: argparse.ArgumentParser) -> None:
    running = one.add_argument_group("running")
    running.add_argument("--rate", type=float, metavar="HZ",
                         help="frames a second at which clips are done, 1 to 2000 (default: the file's)")
    running.add_argument("--workers", type=int, metavar="N",
                         help="clips at a time; 0: one after the other, in this process (default: one a processor)")
    running.add_argument("--scheduler", metavar="ADDRESS",
                         help="do the clips on the Dask cluster of this scheduler, as tcp://HOST:8786")


def _compiling(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    what = "compile the engine's kernels ahead of their first use"
    compiling = commands.add_parser("compile", help=what, description=f"{what.capitalize()}; later starts find them.")
    compiling.add_argument(
        "--to", metavar="DIR", type=Path,
        help=f"make a folder to carry elsewhere: with {VARIABLE} set to it any user starts without compiling, on any machine "
        "with the stated processor",
    )
    compiling.add_argument(
        "--cpu", choices=("baseline", "host"),
        help="with --to: for the stated baseline, x86-64-v3 (the default), or for this very kind of processor",
    )


def parsed(arguments: list[str] | None) -> argparse.Namespace:
    """Parse the command line; argparse ends the process if it is wrong."""
    top = parser()
    found = top.parse_args(arguments)
    if found.command is not None and found.parts is not None:
        top.error("--parts goes without a command")
    if found.command == "compile" and found.cpu is not None and found.to is None:
        top.error("--cpu goes with --to")
    return found
