"""What does numba work out anew although the answer is known? Remembered here, in processes that do nothing but compile kernels.

Half of a compile is numba's own Python. It tries all meanings of `+` for every addition, compares dozens of compiler options at
every look into a table, and reports every call of LLVM to nested timers. None of that changes what comes out; `quicken` leaves it
out. It changes numba itself, for the whole process, and therefore only processes of `python -m avatarsim` call it: numba's other
users in the process of an application keep numba as it is.
"""

import dis
import sys
from collections.abc import Iterator
from contextlib import nullcontext
from functools import cache
from types import BuiltinFunctionType, FunctionType, SimpleNamespace
from typing import Any

import llvmlite.binding.ffi
import llvmlite.ir.types
from numba.core import base, bytecode, byteflow, errors, event, interpreter, ir, lowering, ssa, transforms, typeinfer
from numba.core.base import BaseContext
from numba.core.codegen import CPUCodegen
from numba.core.postproc import PostProcessor, VariableLifetime
from numba.core.targetconfig import TargetConfig
from numba.core.types.abstract import Type
from numba.core.types.functions import BaseFunction
from numba.core.typing.context import BaseContext as BaseTypingContext

from avatarsim.lean_code import write_lean
from avatarsim.quick_typing import type_quickly


def quicken() -> None:
    """Remember, from here on, what numba would work out again."""
    event.install_timer = lambda kind, callback: nullcontext()
    lowering.new_error_context = typeinfer.new_error_context = While
    # Warnings are shown as they come; for every instruction numba put Python's own list of filters away and back.
    told: Any = errors
    told.WarningsFixer.catch_warnings = lambda _fixer, filename=None, lineno=None: nullcontext()
    # LLVM is called a million times; nobody else is there to be locked out, and nobody times it.
    llvmlite.binding.ffi.lib = llvmlite.binding.ffi.lib._lib
    # Whether LLVM writes 1.23 as 1.23 in this locale was asked once for every function.
    CPUCodegen._check_llvm_bugs = lambda codegen: None
    TargetConfig.__eq__ = same_options
    TargetConfig.__hash__ = lambda options: len(options.options)
    functions: Any = BaseFunction
    functions.get_call_type = Meanings(functions.get_call_type)
    PostProcessor.run = Tidied(PostProcessor.run)
    ir.Inst._rec_list_vars = lambda instruction, value: variables(value, [])
    # Its function is found in a table; whether that one takes the place in the source was asked for every call.
    base._has_loc = cache(base._has_loc)
    # No class stands in for one of numba's types, which abstract base classes allow for.
    meta: Any = type(Type)
    meta.__instancecheck__, meta.__subclasscheck__ = type.__instancecheck__, type.__subclasscheck__
    kinds: Any = Type
    kinds.__hash__, kinds.__eq__ = remembered_hash({}), same_kind
    for owner in (BaseContext, BaseTypingContext):
        contexts: Any = owner
        contexts.refresh = Known(contexts.refresh)
    # LLVM was asked for the size of a type by way of a module of its own, as text.
    layouts: Any = llvmlite.ir.types.Type
    layouts.get_abi_size, layouts.get_abi_alignment = told_once(layouts.get_abi_size), told_once(layouts.get_abi_alignment)
    # Python 3.11 leaves room for notes of its own between instructions, which is half of a function.
    told = bytecode
    told._unpack_opargs = without_room(told._unpack_opargs)
    # No kernel has a `with` or makes a dictionary, which numba looks for in three walks through each.
    told = interpreter
    told.peep_hole_delete_with_exit = told.peep_hole_fuse_dict_add_updates = lambda function: function
    # Reports that nobody reads, one for every instruction and more.
    ssa._logger = byteflow._logger = SimpleNamespace(debug=lambda *_: None)
    type_quickly()
    write_lean()


def same_options(one: Any, other: Any) -> Any:
    """Whether two sets of compiler options are equal; those that were set alike need no look at the defaults."""
    if not isinstance(other, TargetConfig):
        return NotImplemented
    return one is other or one._values == other._values or one.values() == other.values()


def without_room(unpack: Any) -> Any:
    """numba's way to read instructions, each as where it begins, what it does, with what, and where the next one begins; the room
    that Python keeps after some of them is passed over, as numba itself does for later versions of Python."""
    room = dis.opmap.get("CACHE", 0)

    def unpacked(code: bytes) -> Iterator[tuple[int, int, int | None, int]]:
        last = None
        for offset, what, argument, following in unpack(code):
            if what == room:
                assert last is not None, "a function begins with an instruction"
                last = (*last[:3], following)
                continue
            if last is not None:
                yield last
            last = offset, what, argument, following
        if last is not None:
            yield last

    return unpacked


PLAIN = frozenset((str, int, float, bool, type(None), type, FunctionType, BuiltinFunctionType, ir.Loc, ir.UndefinedType))
"""Kinds of parts of an instruction that are no variables and have none."""


def variables(value: Any, found: list[Any]) -> list[Any]:
    """The variables of an instruction's parts, in numba's order, added to ``found``."""
    kind = type(value)
    if kind is dict:
        for part in value.values():
            if type(part) is ir.Var:
                found.append(part)
            elif type(part) not in PLAIN:
                variables(part, found)
    elif kind is tuple or kind is list:
        for part in value:
            variables(part, found)
    elif kind is ir.Var:
        found.append(value)
    elif kind is ir.Expr:
        variables(value._kws, found)
    elif isinstance(value, ir.Inst):
        found += value.list_vars()
    return found


def same_kind(one: Any, other: Any) -> bool:
    """Whether two of numba's types are equal; mostly they are one and the same."""
    return one is other or (one.__class__ is other.__class__ and one.key == other.key)


def remembered_hash(known: dict[int, tuple[int, Any]]) -> Any:
    """The hash of each of numba's types, which never change; that of a tuple of tuples of arrays is long in the making."""

    def found(kind: Any) -> int:
        entry = known.get(id(kind))
        if entry is None:
            # The type is kept, so that no other gets its id.
            entry = known[id(kind)] = hash(kind.key), kind
        return entry[0]

    return found


def told_once(ask: Any) -> Any:
    """What LLVM says about the layout of a type, for the one machine that is compiled for; types are known by what is written."""
    known: dict[str, Any] = {}

    def told(kind: Any, target_data: Any, context: Any = None) -> Any:
        if context is not None:
            return ask(kind, target_data, context)
        answer = known.get(str(kind))
        if answer is None:
            answer = known[str(kind)] = ask(kind, target_data)
        return answer

    return told


class While:
    """What numba is about to do with an instruction, told by the error if there is one; numba makes a generator for every one."""

    __slots__ = ("what", "args", "kwargs")

    def __init__(self, what: str, /, *args: Any, **kwargs: Any) -> None:
        self.what, self.args, self.kwargs = what, args, kwargs

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
        if isinstance(error, errors.NumbaError):
            error.add_context(self.what.format(*self.args, **self.kwargs))


class Known:
    """numba's look for newly declared functions, before every compile, only after a module was imported: importing declares."""

    def __init__(self, look: Any) -> None:
        self.look = look
        self.modules: dict[Any, int] = {}

    def __get__(self, context: Any, owner: Any = None) -> Any:
        return lambda: self.run(context)

    def run(self, context: Any) -> None:
        """Look if there may be something new."""
        if self.modules.get(context) != len(sys.modules):
            self.look(context)
            self.modules[context] = len(sys.modules)


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
