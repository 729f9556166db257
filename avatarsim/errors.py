"""Every exception that avatarsim raises on purpose.

    AvatarsimError
    +-- EngineInUse         a second thread calls an engine while the first one's call is under way
    +-- NotCopied           an engine was to be copied or pickled
    +-- InvalidInput        an argument is outside its valid range
    |   +-- InvalidScene    a scene description contradicts itself
    |   +-- InvalidShape    a shape has no volume, a non-finite size, ...
    |   +-- UnsupportedScene    an engine or its preset cannot run a scene; UnsupportedShape: it cannot build one shape of it
    |   +-- InvalidSample   a tracker sample is not finite or does not fit the avatar
    |   +-- InvalidFile     a file is missing, truncated or not of the kind of its name
    |   +-- InvalidSnapshot bytes are no snapshot, are damaged, or are of another scene
    |   +-- UnknownName     an engine, a scene, a preset that is not registered
    +-- StartOverlaps       the first pose already overlaps
    +-- WorldsFailed        some worlds that were to be advanced together could not be
    +-- MissingPackage      an optional package is not installed
    +-- UnsupportedVersion  an installed package is of a version that cannot be used

Each message names the thing, the value it had and the range it must be in.
"""

import re
import shlex
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from errno import ENOMEM
from importlib import metadata
from pathlib import Path
from traceback import walk_tb

ROOT = Path(__file__).resolve().parents[1]
"""The folder that the package lies in: a checkout, or a folder of installed packages."""

ALL_NAMED, NEAREST = 20, 6
"""Most names that are all listed in a message; of more, the number of those listed, most like the given one. In a list of a
hundred names the right one would be hard to find."""

WORLDS_NAMED = 4
"""Most worlds that failed together whose errors are in a message; all of them are in `WorldsFailed.errors`."""

LONGEST_VALUE = 2000
"""Most characters of a value in a message. An array of a million numbers would bury the fault in it."""


class AvatarsimError(Exception):
    """Root of all errors raised on purpose."""


class EngineInUse(AvatarsimError):
    """A call of an engine while another call of it is under way: it has one state and no queue."""

    def __init__(self) -> None:
        super().__init__("this engine is in the middle of another call; give each thread an engine of its own")


class NotCopied(AvatarsimError):
    """An engine was to be copied or pickled; its state is memory that compiled code knows by address."""

    def __init__(self, engine: str) -> None:
        super().__init__(
            f"{engine} cannot be copied or pickled: keep what engine.snapshot() returns, and hand it to restore() of an engine "
            "that has loaded the same scene with the same settings"
        )


class InvalidInput(AvatarsimError):
    """A value outside its valid range; `thing`, `value` and `valid` are kept as attributes."""

    def __init__(self, thing: str, value: object, valid: str) -> None:
        self.thing, self.value, self.valid = thing, value, valid
        super().__init__(f"{thing} is {_shown(value)}; valid: {valid}")


def _shown(value: object) -> str:
    """Return the value in one line of a message: the two ends of a long one, the type of one that cannot be shown."""
    try:
        text = re.sub(r"\n\s*", " ", repr(value))
    except Exception:
        return f"a {type(value).__name__}"
    return text if len(text) <= LONGEST_VALUE else f"{text[: LONGEST_VALUE // 2]}...{text[-LONGEST_VALUE // 2 :]}"


class InvalidScene(InvalidInput):
    """A scene description that contradicts itself."""


class InvalidShape(InvalidInput):
    """A shape without volume or with a non-finite or non-positive size."""


class UnsupportedScene(InvalidInput):
    """A scene that an engine, or one of its presets, cannot run."""


class UnsupportedShape(UnsupportedScene):
    """A shape of a body or a link that an engine cannot build; `body` is its name in the scene."""

    def __init__(self, body: str, shape: object, valid: str) -> None:
        self.body = body
        super().__init__(f"shape of {body}", type(shape).__name__, valid)


class InvalidSample(InvalidInput):
    """A tracker sample that is not finite or does not fit the avatars of the scene."""


class InvalidFile(InvalidInput):
    """A file that is missing, truncated or of another kind than its name states."""


class InvalidSnapshot(InvalidInput):
    """Bytes that are no snapshot of the scene that the engine has loaded, or no longer are."""


class UnknownName(InvalidInput):
    """A name that is not registered; the message lists those that are."""

    def __init__(self, thing: str, value: str, known: Iterable[str]) -> None:
        super().__init__(thing, value, "one of " + likely(value, known))


def likely(value: str, known: Iterable[str]) -> str:
    """Return the names in order; of very many those most like `value`, and how many there are besides."""
    names = sorted(known)
    if len(names) <= ALL_NAMED:
        return ", ".join(names)
    chosen = get_close_matches(value, names, NEAREST) or names[:NEAREST]
    return f"{', '.join(chosen)} and {len(names) - len(chosen)} others"


class StartOverlaps(AvatarsimError):
    """The first pose overlaps; `pairs` lists (name, name, depth in metres), deepest first, `advice` the remedy."""

    def __init__(self, pairs: list[tuple[str, str, float]], advice: str = "start from a pose that is free") -> None:
        self.pairs = sorted(pairs, key=lambda pair: -pair[2])
        listed = "; ".join(f"{a} in {b} by {1e3 * depth:.3g} mm" for a, b, depth in self.pairs[:8])
        more = f" and {len(self.pairs) - 8} more" if len(self.pairs) > 8 else ""
        super().__init__(f"the first pose overlaps ({listed}{more}); {advice}")


class WorldsFailed(AvatarsimError):
    """Some of the worlds that were advanced together failed; the others are a frame further.

    `errors` has the reasons, by the world's place in the list; `records` has those of the others, None for worlds that failed.
    """

    def __init__(self, errors: Mapping[int, AvatarsimError], records: Sequence[object]) -> None:
        self.errors, self.records = dict(sorted(errors.items())), tuple(records)
        listed = "; ".join(f"world {place}: {error}" for place, error in [*self.errors.items()][:WORLDS_NAMED])
        more = f" and {len(self.errors) - WORLDS_NAMED} more" if len(self.errors) > WORLDS_NAMED else ""
        super().__init__(f"{len(self.errors)} of {len(self.records)} worlds failed ({listed}{more}); the others have advanced")


class MissingPackage(AvatarsimError):
    """An optional package is not installed; names the package, its extra, and the command that brings it here."""

    def __init__(self, package: str, extra: str, needed_for: str) -> None:
        self.package, self.extra = package, extra
        super().__init__(f"{needed_for} needs the package {package}, which is not installed: {bringing(extra, package)}")


class UnsupportedVersion(AvatarsimError, ImportError):
    """An installed package is of a version that cannot be used; the message names one that can. Raised by imports."""


OWN = ("avatarsim", "runfiles", "reference", "scenarios", "benchmarks", "reports", "tests")
"""Top-level packages of the project: a lack of memory is located in the innermost function of these."""


NOT_MAPPED = "failed to map segment"
"""Text of the dynamic linker for a lack of memory for a library."""


def described(error: BaseException) -> str:
    """Return one line on an error: its kind and message; of a lack of memory also the function that needed it, and the limit."""
    said, kind = " ".join(str(error).split()), type(error).__name__.removeprefix("_Array")
    if not (isinstance(error, MemoryError) or getattr(error, "errno", None) == ENOMEM or NOT_MAPPED in said):
        return f"{kind}: {said}"
    frames = [frame for frame, _ in walk_tb(error.__traceback__)]
    own = [frame for frame in frames if str(frame.f_globals.get("__name__")).partition(".")[0] in OWN]
    where = [f" (in {frame.f_globals['__name__']}.{frame.f_code.co_qualname})" for frame in own[-1:]]
    limit = memory_limit() or "the machine has no more memory"
    return f"{kind}: {said or 'too little memory'}{''.join(where)}; {limit}: end other programs, raise the limit, or ask for less"


def memory_limit() -> str:
    """Return the limit on the address space of this process, for a message; empty where none is set."""
    # POSIX alone has limits of processes
    import resource

    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    return "" if limit == resource.RLIM_INFINITY else f"its address space is limited to {1e-9 * limit:.2g} GB (ulimit -v)"


def ended_by(code: int) -> str:
    """Return how a process ended without an answer, by its exit code; with the limit on its memory, which is often the reason."""
    how = f"was killed by signal {-code}" if code < 0 else f"ended with code {code}"
    return "; ".join(filter(None, [how, memory_limit()]))


def bringing(extra: str, package: str, root: Path = ROOT) -> str:
    """Return the command that installs an extra: of the checkout at `root`, if it is one, else of the installed avatarsim.

    An extra of a name that no index has ("avatarsim[assets]") cannot be installed by that name, so for an installed avatarsim the
    packages are those that its own metadata lists under the extra.
    """
    if (root / "pyproject.toml").is_file():
        return f"pip install {shlex.quote(f'{root}[{extra}]')}, or `make setup` in {root} for its .venv"
    try:
        required = metadata.requires("avatarsim") or []
    except metadata.PackageNotFoundError:
        required = []
    listed = [line.partition(";")[0].strip() for line in required if f'extra == "{extra}"' in line]
    return "pip install " + " ".join(shlex.quote(line) for line in listed or [package])
