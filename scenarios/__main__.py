"""`python -m scenarios`: list, metrics, run, compare, check, bench, drawn, tune, study; scene is `avatarsim compare`."""

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress

from avatarsim.cli.arguments import COMPARE, COMPARE_END, COMPARE_USAGE, RAW
from avatarsim.cli.option_words import in_words
from avatarsim.cli.reading import reading_options
from avatarsim.console import ended, lost_output, path_option
from avatarsim.errors import AvatarsimError, MissingPackage, described
from avatarsim.running.stopping import stoppable
from runfiles.files import OUT
from scenarios.cli import commands, comparison, drawn, listing, scene, tune
from scenarios.cli import study as studies
from scenarios.run.gate import INCOMPLETE, STOPPED, USAGE
from scenarios.run.own_settings import EXAMPLE

COMMANDS: dict[str, Callable[[argparse.Namespace, Sequence[str]], int]] = {
    "list": listing.listing, "metrics": listing.metrics, "run": commands.run, "compare": comparison.compare,
    "check": commands.check, "bench": commands.bench, "drawn": drawn.drawn, "tune": tune.tune, "study": studies.study,
    "scene": scene.scene,
}


def parser() -> argparse.ArgumentParser:
    """Return the parser of all commands and their options."""
    about = "Run scenes in physics engines and measure the frames that they show."
    top = argparse.ArgumentParser(prog="python -m scenarios", description=about)
    chosen = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    shared = argparse.ArgumentParser(add_help=False)
    shared.add_argument("--engine", nargs="+", action="extend", default=[], metavar="NAME", help="engines; all by default")
    names = "scenes whose name matches, several patterns with commas; otherwise all, in bench and study the usual ones"
    shared.add_argument("--filter", metavar="GLOB,...", help=names)
    usual = "presets; by default all but those that run on request only"
    shared.add_argument("--preset", nargs="+", action="extend", default=[], metavar="NAME", help=usual)
    shared.add_argument("--seed", nargs="+", type=int, default=[0], metavar="N", help="seeds of motions and engines")
    own = f"rows of your own: tables [engine.name] of `preset` to begin from and settings, as in {EXAMPLE}"
    shared.add_argument("--settings", type=path_option, metavar="FILE.toml", help=own)
    cpus = os.cpu_count() or 1
    shared.add_argument("--jobs", type=int, default=cpus, metavar="N", help="runs side by side; 0: all in this process")
    shared.add_argument("--full", action="store_true", help="full lengths, every sub-step judged")
    shared.add_argument("--out", type=path_option, default=OUT, metavar="DIR", help="folder for runs (default: reports/out)")
    resumed = "resume the run in this folder; name all of its scenes and engines, or more"
    shared.add_argument("--resume", type=path_option, metavar="RUN", help=resumed)
    shared.add_argument("--verbose", action="store_true", help="a row per scene and engine instead of the summary")
    shared.add_argument("--json", action="store_true", help="rows as JSON instead of the table")
    # for tests: a scene cut short proves nothing about the scene
    shared.add_argument("--frames", type=int, default=None, help=argparse.SUPPRESS)
    listed = chosen.add_parser("list", help="the scenes", parents=[shared])
    listed.add_argument("--effects", action="store_true", help="effects that each scene calls for")
    chosen.add_parser("metrics", help="definitions of all figures", parents=[shared])
    run = chosen.add_parser("run", help="one scene, all presets of an engine, and its table", parents=[shared])
    run.add_argument("scene", nargs="?", help="name of the scene")
    compare = chosen.add_parser("compare", help="all scenes in all engines, accuracy and time, with a report", parents=[shared])
    brought = compare.add_argument_group("a scene of your own, instead of the catalogue")
    brought.add_argument("--scene", nargs="+", metavar="FILE", help="MJCF, URDF, or a mesh as a room; one scene each")
    avatar = "avatar in these scenes, MJCF or URDF, if they hold none"
    brought.add_argument("--avatar", type=path_option, metavar="FILE", help=avatar)
    room = "room about them: MJCF, URDF, a mesh, or the word floor"
    brought.add_argument("--room", type=path_option, metavar="FILE", help=room)
    brought.add_argument("--motion", metavar="FILE", help="motion of the avatar; without one it holds its first posture")
    brought.add_argument("--scene-scale", type=float, metavar="M", help="metres a unit of length of --scene (1)")
    brought.add_argument("--seconds", type=float, default=5.0, help="how long (default 5; with a motion, of it at most)")
    reading_options(compare)
    chosen.add_parser("check", help="the gate: one engine, accuracy only", parents=[shared])
    chosen.add_parser("bench", help="frame times only", parents=[shared])
    by_seed = chosen.add_parser("drawn", help="scenes and motions that nothing was tuned for, by seed", parents=[shared])
    by_seed.add_argument("--count", type=int, default=20, metavar="N", help="motions in each room, and crowds (default: 20)")
    search = chosen.add_parser("tune", help="search for settings of an engine on drawn scenes", parents=[shared])
    search.add_argument("tuned", metavar="ENGINE", help="engine; with --preset the one to begin from (default: tuned)")
    search.add_argument("--count", type=int, default=1, metavar="N", help="motions in each room, and crowds (default: 1)")
    search.add_argument("--rounds", type=int, default=1, metavar="N", help="changes in a row (default: 1)")
    study = chosen.add_parser("study", help="a study at length, added to the last comparison", parents=[shared])
    study.add_argument("name", nargs="+", metavar="NAME", help=", ".join(studies.STUDIES))
    study.add_argument("--run", type=path_option, metavar="RUN", help="run to add it to (default: the last comparison)")
    scene.add_options(chosen.add_parser("scene", prog="avatarsim compare", description=COMPARE, epilog=COMPARE_END,
                                        formatter_class=RAW, usage=COMPARE_USAGE))
    scheduler = "run all that is not timed on the Dask cluster of this scheduler, as tcp://HOST:8786, instead of here"
    for one in (compare, study):
        one.add_argument("--scheduler", metavar="ADDRESS", help=scheduler)
    return top


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; an error of the input is one line."""
    words = list(sys.argv[1:] if argv is None else argv)
    try:
        options = parser().parse_args(words)
    except SystemExit as end:
        return int(end.code or 0)
    try:
        with stoppable():
            code = COMMANDS[options.command](options, words)
            # here, where an error can still be answered, and not at the interpreter's end
            sys.stdout.flush()
        return code
    except AvatarsimError as error:
        # advice of readers in the words of their options, which are those of `avatarsim clean`
        message = in_words(str(error), "clean") if options.command in ("scene", "compare") else str(error)
        code, line = INCOMPLETE if isinstance(error, MissingPackage) else USAGE, f"{type(error).__name__}: {message}"
    except MemoryError as error:
        code, line = INCOMPLETE, described(error)
    except KeyboardInterrupt:
        code, line = STOPPED, "stopped"
    except OSError as error:
        if isinstance(error, BrokenPipeError) or isinstance(lost_output(), BrokenPipeError):
            # the reader of the output has read enough
            return INCOMPLETE
        # every file that this harness writes is named: without a name it was a stream
        where = f"a file at {error.filename}" if error.filename else "the output, or a file"
        code, line = INCOMPLETE, f"the system refused {where}: {error.strerror or error}"
    with suppress(OSError):
        # where a stream takes nothing, the code is all there is
        print(line, file=sys.stderr)
        if options.command != "scene":
            commands.print_end(options, code, None)
        sys.stdout.flush()
    return code


if __name__ == "__main__":
    sys.exit(ended(main))
