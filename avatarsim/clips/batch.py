"""Batch of all clips of a command: one task per clip, in parallel (Pebble, Dask) or in this process, and the folder's summary.

A batch can be killed at any time and continued by the same command: finished clips are recognised by their certificates, and the
folder holds the same bytes in the end. All clips of a command are entered in the folder's certificate as not done before any is
started, so that none is forgotten however the command ends (write-ahead logging; Gray and Reuter 1993).
"""

from collections.abc import Callable, Container, Generator, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from avatarsim.clips import certificate
from avatarsim.clips.atomic_files import require_replaceable, write_atomically
from avatarsim.clips.certificate import Trouble
from avatarsim.clips.clip_files import Clip
from avatarsim.clips.options import ClipOptions
from avatarsim.clips.page.index_page import index_page
from avatarsim.clips.page.layout import GENERATOR
from avatarsim.clips.task import CERTIFICATES, PAGES, REFUSED, Outcome, Task, outcome
from avatarsim.errors import AvatarsimError, MissingPackage, described
from avatarsim.player import three_js
from avatarsim.running.sources import about, code_hash

if TYPE_CHECKING:
    from avatarsim.running.processes import Workers

INDEX, FOLDER_CERTIFICATE = "index.html", "certificate.json"
"""Page and certificate of the whole folder."""

UNFINISHED = "not finished"
"""Kind of trouble of a clip that has neither a result nor a reason."""
GOES_ON = "the command that asked for it did not come to its end; the same command goes on from there"

PATIENCE = 6 * 3600.0
"""Longest time per clip [s]. A million frames take about two hours; an endless loop must end somewhere."""

PRELOADED = ("numpy", "numba", "scipy.spatial", "avatarsim.clips.task")
"""Modules that processes of clips have loaded. No engine is created in them."""


@dataclass
class Batch:
    """Results of the clips so far."""

    outcomes: list[Outcome] = field(default_factory=list)
    """One per clip, in the order in which they ended."""
    troubles: list[Trouble] = field(default_factory=list)
    """Clips and files that failed."""
    clips: frozenset[str] = frozenset()
    """Places of the requested clips."""
    earlier: tuple[Trouble, ...] = ()
    """Clips that earlier commands into the same folder left undone and that this command does not include."""

    @property
    def entries(self) -> list[Mapping[str, object]]:
        """Return the entries of the certificate."""
        return [one.entry for one in self.outcomes if one.entry is not None]

    def not_done(self, done: Container[str]) -> list[Trouble]:
        """Return all requested work of a folder that is not done; `done` are the places of clips with a result there.

        A clip that has an earlier result no longer counts as unfinished: its entry states the inputs of that result."""
        ended = {one.place for one in self.outcomes}
        return [
            *self.troubles, *((place, UNFINISHED, GOES_ON) for place in self.clips - ended if place not in done),
            *(one for one in self.earlier if one[1] != UNFINISHED or one[0] not in done),
        ]


def run(
    tasks: Sequence[Task], workers: "Workers", batch: Batch, on_outcome: Callable[[Outcome], None],
    progress: Callable[[float], None] | None = None,
) -> None:
    """Run the tasks and collect their results in `batch`, one by one; call `on_outcome` with each result.

    `progress` is called with the finished share of a clip, where clips run in this process. Raises MissingPackage without pebble
    for more workers than 0, InvalidInput for a cluster that does not fit."""
    with closing(_answers(tasks, workers, progress)) as answers:
        for task, found in answers:
            if not isinstance(found, Outcome):
                found = Outcome(task.clip.place, trouble=(REFUSED, str(found)))
            batch.outcomes.append(found)
            if found.trouble is not None:
                batch.troubles.append((found.place, *found.trouble))
            on_outcome(found)


def _answers(
    tasks: Sequence[Task], workers: "Workers", progress: Callable[[float], None] | None
) -> Generator[tuple[Task, object], None, None]:
    if workers == 0:
        # in this process, without the packages that run tasks in parallel
        yield from ((task, _here(task, progress)) for task in tasks)
        return
    try:
        from avatarsim.running.processes import side_by_side
    except ImportError as error:
        raise MissingPackage("pebble", "parallel", "more than one clip at a time") from error
    yield from side_by_side(answer, tasks, workers, shares_its_process, PATIENCE, PRELOADED)


def _here(task: Task, progress: Callable[[float], None] | None) -> object:
    try:
        return outcome(task, progress)
    except OSError as error:
        return _refused(error)
    except AvatarsimError:
        # not of a single clip: a missing package
        raise
    except Exception as error:
        # as in a worker process, whose end costs only its own clip
        return described(error)


def answer(task: Task) -> Outcome:
    """Run the task of one clip in its own process or on another machine."""
    try:
        return outcome(task)
    except OSError as error:
        return Outcome(task.clip.place, trouble=(REFUSED, _refused(error)))


def _refused(error: OSError) -> str:
    # without its folder: a file is written in a folder of random name, and certificates contain no path
    name = Path(error.filename).name if isinstance(error.filename, str) else "a file"
    return f"the system refused {name}: {error.strerror or error}"


def shares_its_process(task: Task) -> bool:
    """Return True: clips leave no state behind, so that the next one reuses a process with loaded kernels and model."""
    return True


def workers_of(count: int, scheduler: str | None, folder: Path) -> "Workers":
    """Return the workers: `count` processes here, or the cluster of a scheduler whose workers see `folder`."""
    if scheduler is None:
        return count
    try:
        from avatarsim.running.cluster import Cluster
    except ImportError as error:
        raise MissingPackage("pebble", "parallel", "--scheduler") from error
    from avatarsim.running.sources import SAME

    return Cluster(scheduler, code_hash, partial(about, folder.resolve()), SAME, PRELOADED)


def tasks_of(clips: Sequence[Clip], options: ClipOptions, out: Path | None, force: bool) -> list[Task]:
    """Return one task per clip, with absolute paths, since a worker may have another working directory."""
    whole = None if out is None else out.absolute()
    return [Task(Clip(clip.place, clip.path.absolute()), options, whole, force) for clip in clips]


def require_place(out: Path, force: bool) -> None:
    """Raise InvalidInput where the path of the folder's page or certificate has a file of another program."""
    require_replaceable(out / INDEX, GENERATOR, force)
    require_replaceable(out / FOLDER_CERTIFICATE, certificate.MARK, force)


def left_undone(out: Path, places: frozenset[str]) -> tuple[Trouble, ...]:
    """Return the undone clips of earlier commands into a folder, but for `places`, which are requested now.
    Raises InvalidFile where the folder's certificate cannot be read."""
    if not (out / FOLDER_CERTIFICATE).exists():
        return ()
    return tuple(one for one in certificate.not_done(out / FOLDER_CERTIFICATE) if one[0] not in places)


def leave(out: Path, batch: Batch) -> dict[str, object]:
    """Write `certificate.json` and `index.html` of all clips in the folder, also of earlier commands; return the certificate."""
    entries = {str(one["motion"]): one for one in earlier(out)}
    entries.update({str(one["motion"]): one for one in batch.entries})
    whole = certificate.summary("clean", list(entries.values()), batch.not_done(entries))
    library = out / PAGES / three_js.FILE
    if library.parent.is_dir() and not library.exists() and (source := three_js.library()):
        write_atomically(library, source.encode())
    write_atomically(out / INDEX, index_page(whole))
    write_atomically(out / FOLDER_CERTIFICATE, certificate.text(whole))
    return whole


def earlier(out: Path) -> Iterator[Mapping[str, object]]:
    """Yield the entries of the certificates in a folder."""
    base = out / CERTIFICATES
    for path in sorted(base.rglob("*.json")):
        found = certificate.read(path)
        if found is not None and f"{found['motion']}.json" == path.relative_to(base).as_posix():
            yield found
