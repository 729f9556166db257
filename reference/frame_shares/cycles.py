"""A clock for compiled code, the kernels that carry one, and the twins that call them."""

import platform
from collections.abc import Callable, Mapping
from time import perf_counter, sleep
from types import FunctionType
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

from avatarsim.errors import InvalidInput
from avatarsim.jit.kernel import OPTIONS, config, njit

COUNTERS = ("x86_64", "AMD64")
"""Processors whose cycle counter any program may read, and which ticks at one rate whatever the clock frequency."""
SLOTS = 8
"""Clocks that can run side by side."""

spent = np.zeros(SLOTS, dtype=np.int64)
"""Cycles by slot since they were set to zero. Compiled code knows its address, so it stays where it is."""

ADDRESS = int(spent.ctypes.data)


def require_counter() -> None:
    """InvalidInput where there is no counter that can be read, or no compiled code that could read it."""
    if platform.machine() not in COUNTERS:
        raise InvalidInput("processor on which shares are measured", platform.machine(), f"one of {', '.join(COUNTERS)}")
    if config.DISABLE_JIT:
        raise InvalidInput("NUMBA_DISABLE_JIT", 1, "0: shares of a frame are those of compiled code")


@intrinsic  # type: ignore[untyped-decorator]
def now(context: Any) -> Any:
    """Cycles since some instant."""
    def code(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        counter = builder.module.declare_intrinsic("llvm.readcyclecounter", (), ir.FunctionType(ir.IntType(64), ()))
        return builder.call(counter, ())

    return types.int64(), code


@intrinsic  # type: ignore[untyped-decorator]
def book(context: Any, slot: Any, cycles: Any) -> Any:
    """Add cycles to a slot."""
    def code(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        at = builder.add(ir.Constant(ir.IntType(64), ADDRESS), builder.mul(arguments[0], ir.Constant(ir.IntType(64), 8)))
        place = builder.inttoptr(at, ir.IntType(64).as_pointer())
        builder.store(builder.add(builder.load(place), arguments[1]), place)
        return target.get_dummy_value()

    return types.void(types.int64, types.int64), code


@njit(**OPTIONS)  # type: ignore[untyped-decorator]
def read() -> int:
    """Cycles since some instant, for Python."""
    return now()  # type: ignore[no-any-return]


def per_microsecond(pause: float = 0.05) -> float:
    """Cycles in a microsecond, over a pause [s]."""
    read()
    cycles, begun = read(), perf_counter()
    sleep(pause)
    return float(read() - cycles) / (1e6 * (perf_counter() - begun))


def clocked(kernel: Callable[..., object], slot: int) -> Any:
    """`kernel` that books its cycles to `slot`; not kept on disk, because the address of the slots is in it."""
    where = np.int64(slot)

    def timed(*arguments: Any) -> Any:
        begun = now()
        answer = kernel(*arguments)
        book(where, now() - begun)
        return answer

    return njit(**OPTIONS)(timed)


def twin(kernel: Any, replaced: Mapping[str, object]) -> Any:
    """`kernel` compiled from the same source, in which the names in `replaced` mean something else."""
    source = kernel.py_func
    for name in replaced:
        if name not in source.__code__.co_names:
            raise KeyError(f"{source.__name__} calls nothing named {name}")
    copied = FunctionType(source.__code__, {**source.__globals__, **replaced}, source.__name__, source.__defaults__)
    return njit(**OPTIONS)(copied)
