"""Entry point of the command line: selects the command to run and its exit code."""

import sys

from avatarsim.cli.arguments import COMPARE, COMPARE_END, COMPARE_USAGE, parsed
from avatarsim.cli.option_words import in_words
from avatarsim.console import USAGE
from avatarsim.errors import AvatarsimError, InvalidFile

UNREADABLE = 3
"""Exit code if a file could not be read."""


def main(arguments: list[str] | None = None) -> int:
    """Run a command and return its exit code.
    It is 0 on success, 1 for an overlap or a failed compilation, 2 for impossible options, 3 for unreadable input."""
    words = sys.argv[1:] if arguments is None else arguments
    if words[:1] == ["pieces"]:
        # its options are those of a user's own room
        from avatarsim.cli.pieces import main as pieces

        return pieces(words[1:])
    if words[:1] == ["compare"]:
        return _compare(words[1:])
    args = parsed(words)
    try:
        if args.command in ("clean", "audit"):
            from avatarsim.cli.motions import run

            return run(args)
        if args.command == "live":
            from avatarsim.cli.live import run as live

            return live(args)
        if args.command == "replay":
            from avatarsim.cli.replay import run as again

            return again(args)
        from avatarsim.cli.compiling import run as compiling

        return compiling(args)
    except AvatarsimError as error:
        print(f"avatarsim: {in_words(str(error), args.command or '')}", file=sys.stderr)
        return UNREADABLE if isinstance(error, InvalidFile) else USAGE


def _compare(words: list[str]) -> int:
    """Run a comparison, whose options are those of the harness; return its exit code."""
    from avatarsim.comparing import run

    try:
        return run(words)
    except AvatarsimError as error:
        if {"-h", "--help"} & set(words):
            # without the extra there is no list of options
            print("\n".join([f"usage: {COMPARE_USAGE}", "", COMPARE, "", COMPARE_END, "", f"all options: {error}"]))
            return 0
        print(f"avatarsim: {error}", file=sys.stderr)
        return UNREADABLE
