"""Persistent compilation cache: one checked file per compiled kernel, signature and processor.

It replaces numba's own cache, which unpickles any content of its files, keeps an index that a crash can leave behind wrong, names
files by absolute paths, and reads from no folder that it cannot write to.

Everything that shapes the machine code is in the name of the entry: the digest of sources, versions and settings (which names the
folder), the kernel's name, its bytecode and closure, the types of its arguments, the processor. None of it depends on where the
package or the cache lies, so both may be moved.
"""

import fcntl
import hashlib
import os
import pickle
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

from avatarsim.console import warn_once
from avatarsim.errors import AvatarsimError
from avatarsim.files import Damaged, Distrusted, make_private, read_entry, say_distrust, write_entry
from avatarsim.jit import places
from avatarsim.jit.first_compile import FIRST_COMPILE
from avatarsim.jit.places import SHIPPED, SUFFIX
from avatarsim.jit.processor import Cpu, compiled_for, usable

LATCH = ".compiling"
"""End of the name of a lock file, which is there while a process compiles a kernel."""


class KernelFiles(ABC):
    """The entries of one kernel, as numba's dispatcher uses them. `folder` is that of its source file within a place; `kind`
    distinguishes compilations of it."""

    def __init__(self, function: Callable[..., object], kind: str, folder: Path) -> None:
        self.folder, self.kind, self.module = folder, kind, function.__module__
        self.name = function.__qualname__.replace("<", "").replace(">", "")
        code = function.__code__
        closure = self.pickled(tuple(cell.cell_contents for cell in function.__closure__)) if function.__closure__ else b""
        self._code = code.co_firstlineno, hashlib.sha256(code.co_code).hexdigest(), hashlib.sha256(closure).hexdigest()
        self._held = ExitStack()

    @abstractmethod
    def pickled(self, tree: object) -> bytes:
        """Return bytes of the kept data."""

    @abstractmethod
    def arguments(self, signature: Any) -> tuple[Any, ...]:
        """Return types of the arguments in a signature."""

    @abstractmethod
    def reduce(self, compiled: Any) -> Any:
        """Return the kept data of a compiled kernel."""

    @abstractmethod
    def rebuild(self, target_context: Any, payload: Any) -> Any:
        """Return a compiled kernel from the kept data, or None if it cannot be used."""

    @property
    def cache_path(self) -> str:
        """Return the folder within each place."""
        return str(self.folder)

    def flush(self) -> None:
        """Remove this kernel's entries from the folder in which new ones are kept."""
        base = places.current().write
        if base is not None:
            for path in map(Path, places.entries(base / self.folder)):
                if path.name.startswith(f"{self.name}-") and path.name.endswith(SUFFIX):
                    _remove(path)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the compiled kernel for a signature from disk; None if it has to be compiled, which is announced.

        Before that it waits for any other process that is compiling the same kernel, and looks again.
        """
        target_context.refresh()
        arguments = self.arguments(sig)
        found = self._found(arguments, target_context, places.current().read)
        base = None if found is not None else places.current().write
        if base is not None:
            self._wait(base / self.folder)
            found = self._found(arguments, target_context, (base,))
        if found is None:
            FIRST_COMPILE.begin(self.module)
        return found

    def save_overload(self, sig: Any, compiled: Any) -> None:
        """Keep a compiled kernel, if it can be kept."""
        base = places.current().write
        if base is None or compiled.library.has_dynamic_globals:
            return
        arguments = self.arguments(sig)
        data = self.pickled((arguments, self.reduce(compiled)))
        try:
            make_private(base / self.folder)
            write_entry(base / self.folder / self._file(arguments, compiled_for()), data)
        except OSError as error:
            places.current().keep_no_more(error)

    @contextmanager
    def turn(self) -> Iterator[None]:
        """Let no other process compile this kernel from the moment it is found missing to the end of the block.

        Since no kernel calls itself, not even through others, processes cannot wait for one another in a ring.
        """
        with self._held:
            yield

    def _wait(self, folder: Path) -> None:
        # Without a lock (the folder was pruned, or its disk knows none) the kernel is only compiled more than once.
        with suppress(OSError):
            make_private(folder)
            path = folder / f"{self.name}-{self.kind}{LATCH}"
            latch = self._held.enter_context(open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_CLOEXEC, 0o600), "wb"))
            fcntl.flock(latch, fcntl.LOCK_EX)
            # Processes that wait here hold the same file open; later ones find the entry.
            self._held.callback(_remove, path)

    def _file(self, arguments: tuple[Any, ...], cpu: Cpu) -> str:
        key = repr((self.kind, self._code, arguments, cpu))
        return f"{self.name}-{hashlib.sha256(key.encode()).hexdigest()[:20]}{SUFFIX}"

    def _found(self, arguments: tuple[Any, ...], target_context: Any, bases: tuple[Path, ...]) -> Any:
        files = [self._file(arguments, cpu) for cpu in usable()]
        for base in bases:
            for file in files:
                data = self._read(base, file)
                found = None if data is None else self._loaded(data, arguments, target_context, base / self.folder / file)
                if found is not None:
                    return found
        return None

    def _loaded(self, data: bytes, arguments: tuple[Any, ...], target_context: Any, path: Path) -> Any:
        """Return the compiled kernel of an entry; None if it is for other arguments or cannot be loaded, which is reported."""
        try:
            kept_for, payload = pickle.loads(data)
            return self.rebuild(target_context, payload) if kept_for == arguments else None
        except (AvatarsimError, MemoryError):
            raise
        except Exception as error:  # any error of a pickle of other versions
            _discard(path, f"{path} cannot be loaded ({type(error).__name__}: {error})")
            return None

    def _read(self, base: Path, file: str) -> bytes | None:
        """Return the content of an entry; None if there is none that can be used, and a fault is reported."""
        path = base / self.folder / file
        try:
            data = read_entry(path, must_be_private=base != SHIPPED)
        except FileNotFoundError:
            return None
        except Distrusted as error:
            say_distrust(error)
        except Damaged as error:
            _discard(path, str(error))
        except OSError as error:
            warn_once("unreadable", f"compiled kernels cannot be read: {error}")
        else:
            if base != SHIPPED:
                places.current().use(path.parent)
            return data
        return None


def _discard(path: Path, why: str) -> None:
    """Remove an entry that cannot be used; it is compiled anew."""
    warn_once("damaged", f"{why}: such compiled kernels are removed and compiled anew")
    _remove(path)


def _remove(path: Path) -> None:
    with suppress(OSError):
        path.unlink()
