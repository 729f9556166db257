"""Calls of compiled kernels by others: small ones are inlined, large ones are compiled once and called by name.

numba links the code of everything a function calls, directly or not, into that function's own module and optimises all of it
again. A frame of this engine is a tree of some two hundred kernels, so the narrow phase was compiled again in each of its dozens
of callers: two thirds of the compile time, and of the data that a start reads from disk. Here a kernel that is too large to be
worth inlining is **sealed**: its callers know it by a name alone, which the JIT linker resolves to the one compiled copy.

Conditions, and how they are met:

- a name must not change between processes, or a caller kept on disk would look for a callee that is not there. numba's own
  symbol names count up per process, so a sealed kernel is registered under one made of its source digest and signature;
- a callee must be in memory before its caller is loaded (an unresolved name ends the process), so a caller is kept on disk
  together with the list of those it calls, and these are loaded, or compiled, first.
"""

import copy
import functools
import hashlib
import importlib
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, cast

import llvmlite.binding as llvm
from numba import types
from numba.core import sigutils
from numba.core.compiler import CompileResult, compile_result
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher
from numba.core.serialize import dumps

from avatarsim.jit.cache import KernelFiles
from avatarsim.jit.compiler_passes import KernelCompiler, KernelLibrary, is_large
from avatarsim.jit.first_compile import FIRST_COMPILE
from avatarsim.jit.source_hash import source_hash

PREFIX = "avatarsim-sealed:"
"""Start of the name of every sealed kernel: by it the calls are found in a compiled module."""


class Callee(NamedTuple):
    """A sealed kernel as its callers' files on disk name it."""

    module: str
    qualname: str
    arguments: tuple[types.Type, ...]


_CALLEES: dict[str, Callee] = {}
"""Sealed kernels of this process by the name that the linker knows."""


class CalledKernel(CPUDispatcher):
    """A kernel as other kernels call it: numba's dispatcher, but sealed where the compiled code is large."""

    made: ClassVar[int] = 0
    """Kernels that this process has compiled or read from disk, each once per signature."""

    def keep_in_cache(self, folder: Path) -> None:
        """Keep the compiled code on disk, in a folder within the places that are read and written."""
        self._cache = KernelCache(self.py_func, type(self).__name__, folder)

    def compile(self, sig: Any) -> Any:
        """Compile for a signature, or load it, and let other kernels know how to call it."""
        arguments = tuple(sigutils.normalize_signature(sig)[0])
        if arguments in self.overloads:
            return super().compile(sig)
        with global_compiler_lock, self._turn(), FIRST_COMPILE.nested():
            entry = super().compile(sig)
        CalledKernel.made += 1
        self._seal(self.overloads[arguments], Callee(self.py_func.__module__, self.py_func.__qualname__, arguments))
        return entry

    def _turn(self) -> AbstractContextManager[None]:
        # a kernel that is kept nowhere is compiled by every process for itself
        return self._cache.turn() if isinstance(self._cache, KernelFiles) else nullcontext()

    def _seal(self, compiled: Any, callee: Callee) -> None:
        name = sealed_name(compiled)
        if name is None:
            return
        if name not in _CALLEES:
            llvm.add_symbol(name, compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name))
            _CALLEES[name] = callee
        by_name = copy.copy(compiled.fndesc)
        by_name.mangled_name = name
        self.targetctx.remove_user_function(compiled.entry_point)
        self.targetctx.insert_user_function(compiled.entry_point, by_name, [])


class KernelDispatcher(CalledKernel):
    """A kernel as Python sees it.

    The way in from Python, which takes named tuples of arrays to pieces, is more code than most kernels have, and few are called
    from Python. So a call by another kernel compiles ``called``, which has no such way in.
    """

    def __init__(self, function: Callable[..., object], options: dict[str, object], folder: Path) -> None:
        super().__init__(function, targetoptions=options, pipeline_class=KernelCompiler)
        self.folder = folder
        self.keep_in_cache(folder)
        FIRST_COMPILE.declared.add((folder, self._cache.name))

    def __reduce__(self) -> tuple[Callable[..., object], tuple[str, str]]:
        """Pickle by name, as a function is pickled."""
        return found, (self.py_func.__module__, self.py_func.__qualname__)

    @functools.cached_property
    def called(self) -> CalledKernel:
        """Return the kernel as other kernels call it; most are never called from Python, and some by Python alone."""
        options = {**self.targetoptions, "no_cpython_wrapper": True}
        inner = CalledKernel(self.py_func, targetoptions=options, pipeline_class=KernelCompiler)
        inner.keep_in_cache(self.folder)
        return inner

    def get_call_template(self, args: tuple[types.Type, ...], kws: dict[str, types.Type]) -> Any:
        """Take a literal as any number of its type: without this, numba compiles a kernel anew for every constant argument."""
        plain = tuple(types.unliteral(value) for value in args)
        named = {name: types.unliteral(value) for name, value in kws.items()}
        if plain in self.overloads:
            return super().get_call_template(plain, named)
        return self.called.get_call_template(plain, named)

    def get_overload(self, sig: Any) -> Any:
        """Return the compiled function for a signature that ``get_call_template`` found."""
        arguments = tuple(sigutils.normalize_signature(sig)[0])
        return (self if arguments in self.overloads else self.called).overloads[arguments].entry_point


class WithoutCode:
    """A sealed kernel's library as it is kept on disk: its machine code and names, not its LLVM code."""

    def __init__(self, compiled: Any) -> None:
        self._final_module = compiled.library._final_module  # numba looks there for the environments that are used
        self.compiled = compiled

    def serialize_using_object_code(self) -> tuple[str, str, tuple[bytes, bytes]]:
        """Serialize in numba's form, which includes the LLVM code with the machine code."""
        library = self.compiled.library
        return library.name, "object", (library._get_compiled_object(), names_alone(self.compiled))


class CodeAlone:
    """The library of a kernel that is only inlined, as it is kept on disk: its LLVM code."""

    def __init__(self, library: KernelLibrary) -> None:
        self._final_module = library._final_module  # numba looks there for the environments that are used
        self.library = library

    def serialize_using_object_code(self) -> tuple[str, bytes]:
        """Serialize the LLVM code, which `KernelLibrary.inlined` reads back."""
        return self.library.name, self.library._get_module_for_linking().as_bitcode()


class KernelCache(KernelFiles):
    """Data of a compiled kernel on disk: numba's data, whether it is sealed, the sealed kernels it calls."""

    def pickled(self, tree: object) -> bytes:
        return cast(bytes, dumps(tree))

    def arguments(self, signature: Any) -> tuple[types.Type, ...]:
        return tuple(sigutils.normalize_signature(signature)[0])

    def reduce(self, compiled: Any) -> Any:
        name, library = sealed_name(compiled), compiled.library
        said = name, library.only_inlined, called(library)
        if library.only_inlined:
            compiled = compiled._replace(library=CodeAlone(library))
        elif name is not None:
            # It is called and never inlined, so its LLVM code, which takes longer to read than the machine code, is not needed.
            compiled = compiled._replace(library=WithoutCode(compiled))
        return *said, compiled._reduce()

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        name, only_inlined, callees, rest = payload
        if not all(load(callee, known_as) for known_as, callee in callees.items()):
            return None  # as if nothing were on disk
        compiled = (small_again if only_inlined else CompileResult._rebuild)(target_context, *rest)
        compiled.library.sealed_name = name
        return compiled


def small_again(
    context: Any, code: Any, descriptor: Any, environment: Any, signature: Any, objectmode: Any, lifted: Any, annotation: Any,
    reload: Any, environments: Any,
) -> Any:
    """Return a kernel that is only inlined, from its kept data, as numba has one with machine code."""
    library = KernelLibrary.inlined(context.codegen(), *code)
    return compile_result(
        typing_context=context.typing_context, target_context=context, library=library, fndesc=descriptor,
        entry_point=context.get_executable(library, descriptor, environment), environment=environment, signature=signature,
        objectmode=objectmode, lifted=lifted, type_annotation=annotation, reload_init=reload, referenced_envs=environments,
    )


def sealed_name(compiled: Any) -> str | None:
    """Return the name under which callers find a compiled kernel; None if it is small enough to be inlined."""
    library = compiled.library
    if not hasattr(library, "sealed_name"):
        large = not library.only_inlined and is_large(library._final_module.get_function(compiled.fndesc.llvm_func_name))
        library.sealed_name = _name(compiled) if large and "<locals>" not in compiled.fndesc.qualname else None
    return cast("str | None", library.sealed_name)


def _name(compiled: Any) -> str:
    descriptor = compiled.fndesc
    digest = hashlib.sha256(repr((descriptor.argtypes, descriptor.restype)).encode()).hexdigest()[:16]
    return f"{PREFIX}{descriptor.modname}.{descriptor.qualname}:{source_hash(descriptor.lookup_module().__file__)}:{digest}"


def called(library: Any) -> dict[str, Callee]:
    """Return sealed kernels that the code of a library calls, by the name that it knows them by."""
    names = [function.name for function in library._final_module.functions if function.is_declaration]
    return {name: _CALLEES[name] for name in names if name.startswith(PREFIX)}


def found(module: str, qualname: str) -> KernelDispatcher:
    """Return the kernel of that name in a module."""
    return cast(KernelDispatcher, functools.reduce(getattr, qualname.split("."), importlib.import_module(module)))


def load(callee: Callee, name: str) -> bool:
    """Bring a sealed kernel into memory, from disk or by compiling it; return False if it is not known by that name then."""
    if name not in _CALLEES:
        found(callee.module, callee.qualname).called.compile(callee.arguments)
    return name in _CALLEES


def names_alone(compiled: Any) -> bytes:
    """Return LLVM code that only defines a compiled kernel's names: from it numba learns those that the machine code defines."""
    names = (compiled.fndesc.llvm_func_name, compiled.fndesc.llvm_cpython_wrapper_name)
    defined = [name for name in names if compiled.library._codegen._engine.is_symbol_defined(name)]
    lines = [f'define void @"{name}"() {{ unreachable }}' for name in defined]
    return cast(bytes, llvm.parse_assembly("\n".join(lines)).as_bitcode())
