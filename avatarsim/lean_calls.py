"""What does a kernel write to call another, or to count? Less than numba does, in processes that do nothing but compile kernels.

For every call numba makes two places in memory, clears them three times, asks six questions about the status that comes back
and is ready to hand an exception on, from within a `try` as well. Hardly a kernel raises anything, none tries, and where a
call is inlined LLVM removes all of it: a third of what it read. For every loop numba divides by the step, which is one.
"""

from typing import Any

from llvmlite import ir
from numba.core import base, cgutils, imputils
from numba.core.imputils import lower_builtin
from numba.core.types.misc import Optional
from numba.cpython import rangeobj

from avatarsim.kernel_library import NEVER_RAISE


def write_lean_calls() -> None:
    """From here on, in this process, numba writes less code for calls and loops."""
    base.user_function = calling(imputils.user_function)
    context: Any = base.BaseContext
    context.get_return_value = unless_alike(context.get_return_value)
    context.get_returned_value = unless_alike(context.get_returned_value)
    context.pair_first = lambda _context, builder, pair, _kind: builder.extract_value(pair, 0)
    context.pair_second = lambda _context, builder, pair, _kind: builder.extract_value(pair, 1)
    for kind, (state, counter) in rangeobj.range_impl_map.items():
        if kind.signed:
            # Declared later than numba's, these take their place.
            lower_builtin(range, kind)(range_from_0)
            lower_builtin(range, kind, kind)(range_from)
            lower_builtin("getiter", state)(counting(state, counter))
            lower_builtin("iternext", counter)(count_on)


def calling(of_others: Any) -> Any:
    """numba's maker of what writes calls of a compiled function."""

    def made(function: Any, libraries: Any = ()) -> Any:
        numbas = of_others(function, libraries)
        if isinstance(function.restype, Optional):
            return numbas

        def write(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
            return call(context, builder, function, arguments)

        write.signature, write.libs = numbas.signature, numbas.libs  # type: ignore[attr-defined]  # numba looks for both there
        return write

    return made


def call(context: Any, builder: Any, function: Any, arguments: Any) -> Any:
    """Call a function and return its value.

    If it may raise, its caller returns with the same status; the exception then lies where the caller's own would.
    """
    convention = context.call_conv
    place = unset(builder, convention.get_return_type(function.restype).pointee)
    raised = convention._get_excinfo_argument(builder.function)
    flat = convention._get_arg_packer(function.argtypes).as_arguments(builder, arguments)
    status = builder.call(context.declare_function(builder.module, function), [place, raised, *flat])
    if function.llvm_func_name not in NEVER_RAISE:
        with cgutils.if_unlikely(builder, builder.icmp_unsigned("!=", status, status.type(0))):
            builder.ret(status)
    return context.get_returned_value(builder, function.restype, builder.load(place))


def unless_alike(convert: Any) -> Any:
    """numba's way to make of a value what a function returns, or back: it takes structures apart field by field and puts them
    together again, although only truth values are returned as something else."""
    known: dict[Any, bool] = {}

    def converted(context: Any, builder: Any, kind: Any, value: Any) -> Any:
        if kind not in known:
            model = context.data_model_manager[kind]
            known[kind] = model.get_return_type() == model.get_value_type()
        return value if known[kind] else convert(context, builder, kind, value)

    return converted


def unset(builder: Any, kind: Any) -> Any:
    """A place in memory that is written to before anybody reads it."""
    with builder.goto_entry_block():
        return builder.alloca(kind)


def packed(builder: Any, kind: Any, values: Any) -> Any:
    """A structure of these values."""
    whole = ir.Constant(kind, ir.Undefined)
    for k, value in enumerate(values):
        whole = builder.insert_value(whole, value, k)
    return whole


def range_from_0(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    """`range(end)`."""
    return range_from(context, builder, signature, [values[0].type(0), *values])


def range_from(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    """`range(start, end)`."""
    return packed(builder, context.get_value_type(signature.return_type), [*values, values[0].type(1)])


def counting(state: Any, counter: Any) -> Any:
    """What begins to count through a range: where the number and how many are left will lie."""
    numbas = numbas_getiter(state)

    def begin(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        start, end, step = (builder.extract_value(values[0], k) for k in range(3))
        if not (isinstance(step, ir.Constant) and step.constant == 1):
            return numbas(context, builder, signature, values)
        number, left = unset(builder, start.type), unset(builder, start.type)
        many = builder.sub(end, start)
        builder.store(start, number)
        builder.store(builder.select(builder.icmp_signed(">", many, many.type(0)), many, many.type(0)), left)
        return packed(builder, context.get_value_type(counter), [number, end, step, left])

    return begin


def numbas_getiter(state: Any) -> Any:
    """What numba writes to begin counting through a range of any step."""
    return next(make for make, key, kinds in imputils.builtin_registry.functions if key == "getiter" and kinds == (state,))


def count_on(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    """The next number of a range, and whether there is one; once there is none, nobody asks again."""
    number, _, step, left = (builder.extract_value(values[0], k) for k in range(4))
    found, many = builder.load(number), builder.load(left)
    builder.store(builder.add(found, step), number)
    builder.store(builder.sub(many, many.type(1), flags=["nsw"]), left)
    there = builder.icmp_signed(">", many, many.type(0))
    return packed(builder, context.get_value_type(signature.return_type), [found, there])
