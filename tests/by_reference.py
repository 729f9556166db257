"""Tests pass named tuples to the engine's kernels by reference, as the engine does.

By value, a kernel that Python calls is compiled once more, with all that it calls: for another kind of arguments, and with code
that takes hundreds of arrays out of tuples one by one. A third of the tests' time went there. Here the tuple is laid out in
memory as compiled code keeps it, and the kernel compiled before gets its address.
"""

import sys
from typing import Any

import numba
import numpy as np
from numba.core import types
from numba.core.errors import NumbaError
from numba.core.extending import intrinsic

from avatarsim.jit.arena import Image
from avatarsim.jit.by_reference import Reference
from avatarsim.jit.compiler_passes import KernelCompiler
from avatarsim.jit.kernel import OPTIONS
from avatarsim.jit.linking import CalledKernel, KernelDispatcher

PLAIN = (bool, np.bool_, float, int, np.int64)
"""Kinds of numbers that an image lays down as compiled code keeps them."""

KEPT = 16
"""Tuples whose images are kept, since the next call often has the same ones; more: the memory of worlds of earlier tests."""

TESTS = __name__.split(".")[0] + "."
"""Beginning of the names of modules of tests."""


class Lying:
    """A named tuple, laid out in memory, as a kernel gets it."""

    def __init__(self, tree: Any) -> None:
        self.tree, starts, image = tree, dict[int, int](), Image()
        collect(tree, starts)
        image.lay(tree, starts)
        self.memory = np.frombuffer(bytes(image.data) or bytes(8), dtype=np.uint8)
        self.address = self.memory.ctypes.data
        self.kind = Reference(numba.typeof(tree))
        self.number = self.kind._code


def collect(tree: Any, starts: dict[int, int]) -> None:
    """Note where arrays and records lie; TypeError if an image could not hold some part."""
    if isinstance(tree, tuple):
        for branch in tree:
            collect(branch, starts)
    elif isinstance(tree, np.void) or (isinstance(tree, np.ndarray) and tree.flags.c_contiguous and tree.ndim):
        starts[id(tree)] = tree.__array_interface__["data"][0]
    elif type(tree) not in PLAIN and not isinstance(tree, float):
        raise TypeError(f"no image of {type(tree)}")


def view_arena(kinds: tuple[Reference | None, ...]) -> Any:
    """Return the function, for kernels, that takes arguments of which some are addresses, and returns them with references in
    their place, each of the type in `kinds`."""

    @intrinsic
    def put(_context: Any, args: Any) -> Any:
        known = types.Tuple([kind or found for kind, found in zip(kinds, args.types, strict=True)])  # type: ignore[attr-defined]

        def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            whole = [builder.extract_value(values[0], k) for k in range(len(kinds))]
            laid = [
                one if kind is None else builder.inttoptr(one, context.get_value_type(kind))
                for kind, one in zip(kinds, whole, strict=True)
            ]
            return context.make_tuple(builder, known, laid)

        return known(args), build

    return put


class Referring:
    """The way in which tests call kernels: `call` passes by reference the tuples that `by_value` would take apart."""

    def __init__(self, by_value: Any) -> None:
        self.by_value = by_value
        self.images: dict[int, Lying] = {}
        self.entries: dict[Any, CalledKernel | None] = {}

    def call(self, kernel: KernelDispatcher, args: tuple[Any, ...]) -> Any:
        """Call a kernel of the engine for a test; make any other call, and one that takes tuples apart itself, by value."""
        named = [self.lying(one) if isinstance(one, tuple) and hasattr(one, "_fields") else None for one in args]
        key = (kernel, *(lying and lying.number for lying in named))
        if key not in self.entries and any(named):
            self.entries[key] = entry_of(kernel, tuple(None if lying is None else lying.kind for lying in named))
        entry = self.entries.get(key)
        if entry is None:
            return self.by_value(kernel, *args)
        try:
            return entry(*(one if lying is None else lying.address for one, lying in zip(args, named, strict=True)))
        except NumbaError:
            self.entries[key] = None
            return self.by_value(kernel, *args)

    def lying(self, tree: Any) -> Lying | None:
        """Return a tuple in memory, as it was laid out for the last calls if it was; None if it cannot be laid out."""
        found = self.images.pop(id(tree), None)
        if found is None:
            try:
                found = Lying(tree)
            except TypeError:
                return None
        self.images[id(tree)] = found
        if len(self.images) > KEPT:
            del self.images[next(iter(self.images))]
        return found


def entry_of(kernel: KernelDispatcher, kinds: tuple[Reference | None, ...]) -> CalledKernel:
    """A kernel that Python calls with addresses and that calls this one with references, as other kernels of the engine do."""
    put = view_arena(kinds)

    def entry(*args: Any) -> Any:
        return kernel(*put(args))

    return CalledKernel(entry, targetoptions={"nopython": True, **OPTIONS}, pipeline_class=KernelCompiler)


def refer_in_tests() -> None:
    """From here on, in this process, tests call kernels of the engine by reference."""
    dispatcher: Any = KernelDispatcher
    referring = Referring(dispatcher.__call__)

    def call(kernel: KernelDispatcher, *args: Any, **kwargs: Any) -> Any:
        ours = kernel.__module__.startswith("avatarsim.") and sys._getframe(1).f_globals["__name__"].startswith(TESTS)
        return referring.call(kernel, args) if ours and not kwargs else referring.by_value(kernel, *args, **kwargs)

    dispatcher.__call__ = call
