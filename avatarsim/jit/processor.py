"""Processor part of the cache key: the processor that machine code is compiled for, and the code that may be loaded here."""

import functools
from typing import NamedTuple

import llvmlite.binding as llvm
import numba
from numba.core.codegen import get_host_cpu_features

from avatarsim.jit import baseline


class Cpu(NamedTuple):
    """A processor to compile for, in LLVM's words: target triple, name, features."""

    triple: str
    name: str
    features: str


@functools.cache
def compiled_for() -> Cpu:
    """Return the processor for which numba compiles in this process."""
    name, features = numba.config.CPU_NAME, numba.config.CPU_FEATURES
    return Cpu(
        llvm.get_process_triple(),
        llvm.get_host_cpu_name() if name is None else name,
        get_host_cpu_features() if features is None else features,
    )


@functools.cache
def usable() -> tuple[Cpu, ...]:
    """Return processors whose code may be loaded here, best first: the one compiled for, and the baseline of `jit/baseline.py`.

    The latter is left out if numba's settings name a processor or disable vector code.
    """
    own, config = compiled_for(), numba.config
    asked = config.CPU_NAME is not None or config.CPU_FEATURES is not None or not config.ENABLE_AVX
    if asked or not baseline.runs_baseline():
        return (own,)
    return own, Cpu(own.triple, baseline.NAME, baseline.LISTED)
