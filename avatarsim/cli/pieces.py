"""`avatarsim pieces MESH ...`: convex decomposition of mesh files from the command line, with error bounds."""

import argparse
import json
import sys

from avatarsim.assets.meshes.convex_pieces import Pieces, pieces_of_mesh
from avatarsim.assets.meshes.decompose import REPAIRS, PieceOptions
from avatarsim.cli.option_words import as_options
from avatarsim.console import USAGE
from avatarsim.errors import AvatarsimError, InvalidInput
from avatarsim.scene.checks import positive

REFUSED = 3
"""Exit code when a mesh was refused; the others are still treated."""
STOPPED = 130
"""Exit code of a program that the user stopped."""

HEAD = f"{'mesh':24} {'source':13} pieces vertices most  Hausdorff of size seconds cache"


def parser() -> argparse.ArgumentParser:
    """Return the parser; each option is one argument of `pieces_of_mesh`."""
    options = argparse.ArgumentParser(
        prog="avatarsim pieces",
        description="Convex pieces of mesh files, with a bound of their Hausdorff distance; kept in the cache folder.",
        epilog="example: avatarsim pieces duck.obj --scale 0.1. Exit codes: 0; 2 wrong usage; 3 a mesh was refused.",
    )
    options.add_argument("meshes", nargs="+", metavar="MESH", help=".obj .stl .ply .off .glb .gltf .dae")
    options.add_argument("--scale", type=float, default=1.0, help="metres per unit of the file (default 1)")
    options.add_argument("--y-up", action="store_true", help="the file's y axis points up")
    options.add_argument("--threshold", type=float, default=0.05, help="concavity a piece may keep, 0.01 to 1 (default 0.05)")
    options.add_argument("--seed", type=int, default=0, help="seed of the decomposition (default 0)")
    options.add_argument("--most-vertices", type=int, default=128, help="vertices of a piece at most (default 128)")
    options.add_argument("--fit", type=float, metavar="M", help="most metres that a piece may be wider than its hull")
    options.add_argument("--most-pieces", type=int, help="pieces at most, if possible (default: no limit)")
    options.add_argument("--hull", action="store_true", help="one piece, the convex hull, even of an open mesh")
    options.add_argument("--repair", choices=REPAIRS, default="auto", help="of open or crossing surfaces (default auto)")
    options.add_argument("--no-cache", action="store_true", help="neither read nor write the cache folder")
    options.add_argument("--quiet", action="store_true", help="no progress on the error stream")
    options.add_argument("--json", action="store_true", help="one JSON object per mesh and line instead of the table")
    return options


def main(words: list[str] | None = None) -> int:
    """Return 0, or REFUSED when a mesh was refused, with the reason on the error stream."""
    options = parser()
    args = options.parse_args(words)
    flags = {name.lstrip("-") for action in options._actions for name in action.option_strings}
    try:
        positive("--scale", args.scale, InvalidInput)
        PieceOptions(args.threshold, args.seed, args.most_vertices, args.most_pieces, args.hull, args.repair, args.fit)
    except InvalidInput as error:
        print(f"avatarsim pieces: {error}", file=sys.stderr)
        return USAGE
    code = 0
    if not args.json:
        print(HEAD)
    for path in args.meshes:
        try:
            found = pieces_of_mesh(
                path, args.scale, y_up=args.y_up, threshold=args.threshold, seed=args.seed, most_vertices=args.most_vertices,
                most_pieces=args.most_pieces, hull=args.hull, repair=args.repair, fit=args.fit, kept=not args.no_cache,
                quiet=args.quiet,
            )
        except AvatarsimError as error:
            print(f"{path}: {as_options(str(error), flags)}", file=sys.stderr)
            code = REFUSED
        except KeyboardInterrupt:
            print("stopped; nothing was left half written", file=sys.stderr)
            return STOPPED
        else:
            print(as_json(path, found) if args.json else as_row(path, found), flush=True)
    return code


def as_row(path: str, found: Pieces) -> str:
    """Return one row of the table, and one more line for each repair."""
    counts = found.vertices
    name = path.replace("\\", "/").rsplit("/", 1)[-1]
    row = (
        f"{name:24} {found.source:13} {len(counts):6} {sum(counts):8} {max(counts):4} {1e3 * found.hausdorff:7.3g} mm "
        f"{100.0 * found.hausdorff / found.size:5.2f} % {found.seconds:7.2f} {'hit' if found.from_cache else 'miss'}"
    )
    return "\n".join([row, *(f"    {repair}" for repair in found.repairs)])


def as_json(path: str, found: Pieces) -> str:
    """Return the results as a dictionary, without the vertices."""
    return json.dumps({
        "mesh": path, "source": found.source, "pieces": len(found.pieces), "vertices": found.vertices, "size": found.size,
        "hausdorff": found.hausdorff, "uncovered": found.uncovered, "added": found.added, "reached": found.reached,
        "repairs": found.repairs, "from_cache": found.from_cache, "cache_note": found.cache_note, "seconds": found.seconds,
    })

