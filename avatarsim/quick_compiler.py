"""What does numba work out anew although the answer is known? Remembered here, in processes that do nothing but compile kernels.

Half of a compile is numba's own Python. It tries all meanings of `+` for every addition, compares dozens of compiler options at
every look into a table, reports every call of LLVM to nested timers, and tunes a list of passes for functions that are only
declared. None of that changes what comes out; `quicken` leaves it out. It changes numba itself, for the whole process, and
therefore only `python -m avatarsim --part` calls it: numba's other users in the process of an application keep numba as it is.
"""

from contextlib import nullcontext
from typing import Any

import llvmlite.binding.ffi
from numba.core import event, ir, transforms
from numba.core.codegen import CPUCodegen, CPUCodeLibrary
from numba.core.postproc import PostProcessor, VariableLifetime
from numba.core.targetconfig import TargetConfig
from numba.core.types.functions import BaseFunction

from avatarsim.lean_code import write_lean


def quicken() -> None:
    """Remember, from here on, what numba would work out again."""
    event.install_timer = lambda kind, callback: nullcontext()
    # LLVM is called a million times; nobody else is there to be locked out, and nobody times it.
    llvmlite.binding.ffi.lib = llvmlite.binding.ffi.lib._lib
    # Whether LLVM writes 1.23 as 1.23 in this locale was asked once for every function.
    CPUCodegen._check_llvm_bugs = lambda codegen: None
    CPUCodeLibrary._optimize_functions = optimize_defined
    TargetConfig.__eq__ = same_options
    TargetConfig.__hash__ = lambda options: len(options.options)
    functions: Any = BaseFunction
    functions.get_call_type = Meanings(functions.get_call_type)
    PostProcessor.run = Tidied(PostProcessor.run)
    ir.Inst._rec_list_vars = lambda instruction, value: variables(value, [])
    write_lean()


def same_options(one: Any, other: Any) -> Any:
    """Whether two sets of compiler options are equal; those that were set alike need no look at the defaults."""
    if not isinstance(other, TargetConfig):
        return NotImplemented
    return one is other or one._values == other._values or one.values() == other.values()


def optimize_defined(library: Any, module: Any) -> None:
    """numba's first tidying of a module's functions, without those that are only declared there."""
    module.data_layout = library._codegen._data_layout
    for function in module.functions:
        if not function.is_declaration:
            manager, builder = library._codegen._function_pass_manager()
            manager.run(function, builder)


def variables(value: Any, found: list[Any]) -> list[Any]:
    """The variables of an instruction's parts, in numba's order, added to ``found``."""
    if isinstance(value, ir.Var):
        found.append(value)
    elif isinstance(value, ir.Inst):
        found += value.list_vars()
    elif isinstance(value, list | tuple):
        for part in value:
            variables(part, found)
    elif isinstance(value, dict):
        for part in value.values():
            variables(part, found)
    return found


class Tidied:
    """What numba notes about a function after every pass that changed it; which variables live where only once that is asked."""

    def __init__(self, of_generators: Any) -> None:
        self.of_generators = of_generators

    def __get__(self, processor: Any, owner: Any = None) -> Any:
        return lambda emit_dels=False, extend_lifetimes=False: self.run(processor, emit_dels, extend_lifetimes)

    def run(self, processor: Any, emit_dels: bool, extend_lifetimes: bool) -> None:
        """As numba does, but without a list of what lives where a block begins, which only generators and Python objects need."""
        function = processor.func_ir
        if function.is_generator:
            self.of_generators(processor, emit_dels, extend_lifetimes)
            return
        function.blocks = transforms.canonicalize_cfg(function.blocks)
        function.variable_lifetime = VariableLifetime(function.blocks)
        function.generator_info = None
        if emit_dels:
            processor._insert_var_dels(extend_lifetimes=extend_lifetimes)


class Meanings:
    """What a function of numba's means for arguments of certain types: found once.

    It may depend on the options of the compiler, too, but all kernels are compiled with the same ones.
    """

    def __init__(self, find: Any) -> None:
        self.find = find
        self.known: dict[Any, Any] = {}

    def __get__(self, function: Any, owner: Any = None) -> Any:
        return lambda context, args, kws: self.of(function, context, args, kws)

    def of(self, function: Any, context: Any, args: Any, kws: Any) -> Any:
        """The signature; an error is not kept."""
        key = (function, tuple(args), tuple(dict(kws).items()))
        known = self.known.get(key)
        if known is None:
            known = self.known[key] = self.find(function, context, args, kws)
        return known
