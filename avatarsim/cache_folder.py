"""Per-user cache folders in the order of the XDG Base Directory Specification, trusted as OpenSSH trusts its files (StrictModes).

Compiled code that is read from a cache runs. So a folder or a file counts only if its owner is this user or the administrator and
no other user may write to it. New folders get the mode 0700, which the specification asks for.
"""

import errno
import os
import stat
import tempfile
from contextlib import suppress
from pathlib import Path

from avatarsim.say_once import say_once

VARIABLE = "AVATARSIM_CACHE_DIR"
"""Environment variable that names the first folder to look in, for all caches of this package."""

ADMINISTRATOR = 0
"""User number whose files are trusted beside one's own: it may change any file anyway, and container images belong to it."""

OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
"""Mode bits by which another user can replace what is run."""


class Distrusted(PermissionError):
    """A file or folder that another user owns or may write to."""


def bases(name: str, *variables: str) -> list[Path]:
    """Folders called `name` for a cache to lie in, best first: below AVATARSIM_CACHE_DIR, below each of the further environment
    `variables`, XDG_CACHE_HOME, ~/.cache, and in the temporary folder one per user. None of them needs to exist."""
    named = [os.environ.get(variable, "") for variable in (VARIABLE, *variables, "XDG_CACHE_HOME")]
    found: list[Path] = []
    for value in filter(None, named):
        # A relative name means nothing once the current folder is gone.
        with suppress(OSError):
            found.append(Path(value).absolute() / name)
    home = Path(os.path.expanduser("~"))
    if home.is_absolute():
        found.append(home / ".cache" / name)
    # There may be no temporary folder that can be written to.
    with suppress(OSError):
        found.append(Path(tempfile.gettempdir()) / f"{name}-{os.geteuid()}")
    return found


def require_trusted(status: os.stat_result, path: Path) -> None:
    """Raise Distrusted if another user owns what `status` describes, or may write to it."""
    require_owner(status, path)
    if status.st_mode & OTHERS_WRITE:
        mode = stat.S_IMODE(status.st_mode)
        raise Distrusted(errno.EPERM, f"other users may write to it (mode {mode:04o}; chmod go-w makes it private)", str(path))


def require_owner(status: os.stat_result, path: Path) -> None:
    """Raise Distrusted if neither this user nor the administrator owns what `status` describes."""
    if status.st_uid not in (ADMINISTRATOR, os.geteuid()):
        raise Distrusted(errno.EPERM, f"it belongs to user {status.st_uid}", str(path))


def require_trusted_folder(folder: Path) -> None:
    """Raise Distrusted if a folder, or the link that leads to it, is in another user's hands; OSError if there is none."""
    # The mode of a symbolic link says nothing.
    require_owner(folder.lstat(), folder)
    status = folder.stat()
    if not stat.S_ISDIR(status.st_mode):
        raise NotADirectoryError(errno.ENOTDIR, "it is not a folder", str(folder))
    require_trusted(status, folder)


def make_private(folder: Path) -> None:
    """Make a folder and what is missing above it, with the mode 0700; OSError if that is impossible."""
    try:
        os.mkdir(folder, 0o700)
    except FileExistsError:
        pass
    except FileNotFoundError:
        if folder.parent == folder:
            raise
        make_private(folder.parent)
        with suppress(FileExistsError):
            os.mkdir(folder, 0o700)


def is_readable(folder: Path) -> bool:
    """Whether a folder exists and is trusted; distrust is said once per folder."""
    try:
        require_trusted_folder(folder)
    except Distrusted as error:
        say_distrust(error)
        return False
    except OSError:
        return False
    return True


def is_writable(folder: Path) -> bool:
    """Whether a folder, made if need be, is trusted and takes a file; distrust is said once per folder."""
    with suppress(OSError):
        make_private(folder)
    if not is_readable(folder):
        return False
    try:
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


def say_distrust(error: Distrusted) -> None:
    """Say on standard error why a file or folder is left alone."""
    say_once(f"distrust {error.filename}", f"{error.filename} is not used as a cache: {error.strerror}")
