"""Named tuples of arrays, passed from kernel to kernel by reference.

numba passes a tuple by value: an array is seven to eleven words, a world some hundred arrays, so every call of a kernel that is
not inlined copied kilobytes, and half of the compiler's work was this copying. `refer` puts the tuple into memory once, in the
entry kernel; from there on one word is passed, and ``reference.field`` reads the field it needs. A field that is itself a named
tuple is again a reference.

A reference is valid until the kernel that called `refer` returns, so none may be returned from it or kept.
"""

from typing import Any, TypeVar

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic, models, register_model

from avatarsim.jit.kernel import config
from avatarsim.jit.layout import numba_type

Tree = TypeVar("Tree")


class Reference(types.Type):
    """numba's type of a reference to a named tuple of type ``whole``."""

    def __init__(self, whole: Any) -> None:
        self.whole = whole
        super().__init__(name=f"reference({whole})")


@register_model(Reference)
class ReferenceModel(models.PrimitiveModel):
    """One word: where the tuple lies, laid out as LLVM lays out its value."""

    def __init__(self, manager: Any, of: Reference) -> None:
        super().__init__(manager, of, manager.lookup(of.whole).get_value_type().as_pointer())


@infer_getattr
class ReferenceFields(AttributeTemplate):
    """A field of a reference has the type that it has in the tuple; of a tuple in a tuple there is a reference."""

    key = Reference

    def generic_resolve(self, of: Reference, name: str) -> Any:
        if name not in of.whole.fields:
            return None
        field = of.whole.types[of.whole.fields.index(name)]
        return Reference(field) if isinstance(field, types.BaseNamedTuple) else field


@lower_getattr_generic(Reference)
def read_field(context: Any, builder: Any, of: Reference, value: Any, name: str) -> Any:
    """Return machine code for ``reference.name``."""
    place = of.whole.fields.index(name)
    field = cgutils.gep_inbounds(builder, value, 0, place)
    return field if isinstance(of.whole.types[place], types.BaseNamedTuple) else parts(builder, field)


def parts(builder: Any, pointer: Any) -> Any:
    """Load a value part by part, since LLVM drops unused loads of single parts, but not unused parts of a whole load."""
    kind = pointer.type.pointee
    if not isinstance(kind, ir.Aggregate):
        return builder.load(pointer)
    value = ir.Constant(kind, ir.Undefined)
    for k in range(len(kind)):
        value = builder.insert_value(value, parts(builder, cgutils.gep_inbounds(builder, pointer, 0, k)), k)
    return value


def refer(tree: Tree) -> Tree:
    """Return a reference to the same named tuple; a reference itself stays as it is."""
    return tree


if not config.DISABLE_JIT:

    @intrinsic
    def refer(context: Any, tree: Any) -> Any:
        if isinstance(tree, Reference):
            return tree(tree), lambda _context, _builder, _signature, values: values[0]
        if isinstance(tree, types.BaseNamedTuple):
            return Reference(tree)(tree), lambda _context, builder, _signature, values: place_of(builder, values[0])
        return None


def place_of(builder: Any, value: Any) -> Any:
    """Return the address of a value: where the kernel that returned it left it, if that is not reused, or a new place."""
    if isinstance(value, ir.LoadInstr) and isinstance(value.operands[0], ir.AllocaInstr):
        place = value.operands[0]
        # numba makes one place for the result of each call, and hands it on first of all.
        calls = (one for one in value.parent.instructions if isinstance(one, ir.CallInstr))
        if any(call.args and call.args[0] is place for call in calls):
            return place
    return cgutils.alloca_once_value(builder, value)


def reference_in(_context: Any, words: Any, byte: Any, kind: Any) -> Any:
    """Return the type and code of `referred`."""
    found = Reference(numba_type(kind.instance_class))

    def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        first = context.make_array(signature.args[0])(context, builder, values[0]).data
        start = builder.gep(builder.bitcast(first, ir.IntType(8).as_pointer()), [values[1]])
        return builder.bitcast(start, context.get_value_type(found))

    return found(words, types.int64, kind), build


def words_from(_context: Any, place: Any, count: Any) -> Any:
    """Return the type and code of `lying_at`."""
    kind = types.Array(types.int64, 1, "C")

    def build(context: Any, builder: Any, _signature: Any, values: Any) -> Any:
        array = context.make_array(kind)(context, builder)
        word = context.get_constant(types.intp, 8)
        array.data = builder.inttoptr(values[0], array.data.type)
        array.nitems, array.itemsize = values[1], word
        array.shape, array.strides = cgutils.pack_array(builder, [values[1]]), cgutils.pack_array(builder, [word])
        # memory that is not counted, as of all arrays in an arena
        array.meminfo, array.parent = cgutils.get_null_value(array.meminfo.type), cgutils.get_null_value(array.parent.type)
        return array._getvalue()

    return kind(types.int64, types.int64), build


lying_at: Any = intrinsic(words_from)
"""In a kernel: the words that lie at an address, and so many."""
referred: Any = intrinsic(reference_in)
"""In a kernel: a reference to the named tuple of a class that lies from a byte of an array of words on."""
