"""The one JIT decorator of the engine. Where its compiled code is kept: `source_hash`.

Why these options:

- ``cache=True``: compiling the whole frame takes tens of seconds, loading it a few tens of milliseconds.
- ``error_model="numpy"``: a division by zero gives inf or nan, which the kernels test for; Python's model
  adds a branch and an exception path to every division.
- ``fastmath=False``: fast maths may assume that nan does not exist, and then no test for nan holds.
- ``_nrt=False``: with reference counting on, numba counts every array of every tuple handed from kernel to
  kernel, which doubles the time of the narrow phase. The price: **a kernel allocates nothing**; scratch
  memory is made once, outside.
"""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

from avatarsim.jit.tested_versions import guarded

# Every import of a kernel runs this first.
with guarded():
    from avatarsim.jit.linking import KernelDispatcher
    from avatarsim.jit.source_hash import kernel_folder

# numba makes its settings at run time; its annotations know neither them nor the option `_nrt`.
config: Any = numba.config
njit: Any = numba.njit

Function = TypeVar("Function", bound=Callable[..., object])

OPTIONS = {"error_model": "numpy", "fastmath": False, "_nrt": False, "boundscheck": None, "no_cfunc_wrapper": True}
"""numba's options, as explained above; the unused wrapper for calls from C is left out."""

WITHOUT_LOCK = {"nogil": True}
"""numba's option to let go of Python's global lock while a kernel runs that Python called."""

STOCK = "AVATARSIM_STOCK_NUMBA"
"""Environment variable: 1 compiles with numba alone, as `numba.njit(cache=True)` does, to separate faults of this package's
compiler from others. Compiling takes several times as long, and numba's cache does not notice an edit of a kernel's callees."""


def is_stock() -> bool:
    """Return True if kernels are compiled with numba alone."""
    return os.environ.get(STOCK) == "1" and not config.DISABLE_JIT


def kernel(function: Function) -> Function:
    """Compile ``function`` at its first call, or load it from the cache; no effect under NUMBA_DISABLE_JIT=1.

    The result is typed as the function itself, so kernels are checked like any Python function.
    """
    return _compiled(function, {})


def entry_kernel(function: Function) -> Function:
    """Compile a kernel as `kernel` does, for one that runs a whole stage of a frame: other Python threads run meanwhile.

    To let go of the lock and take it again costs a call some 0.05 us, which is too much for kernels that take little longer.
    """
    return _compiled(function, WITHOUT_LOCK)


def _compiled(function: Function, more: dict[str, bool]) -> Function:
    source = function.__code__.co_filename
    if is_stock():
        return cast(Function, njit(cache=True, error_model="numpy", _nrt=False, **more)(function))
    if config.DISABLE_JIT or not Path(source).is_file():  # typed at a prompt
        return cast(Function, njit(**OPTIONS, **more)(function))
    return cast(Function, KernelDispatcher(function, {"nopython": True, **OPTIONS, **more}, kernel_folder(source)))
