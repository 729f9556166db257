"""Structured memory in kernels: one record that is handed on as a pointer, and tables of records that share one array.

numba hands every array of a tuple on as seven words or more, so a tuple of fifteen arrays costs more to hand on than many
kernels take. A record it hands on as a pointer, but copies the whole of it into every tuple that holds it; so there is a type
of its own for it here, which differs in nothing else.
"""

from collections.abc import Callable
from typing import Any, TypeVar

import numba
import numpy as np
from llvmlite import ir
from numba.core.datamodel.models import RecordModel
from numba.extending import intrinsic, overload, register_model, typeof_impl
from numpy.typing import NDArray

types: Any = numba.types
Record = TypeVar("Record", bound=np.record)
Table = TypeVar("Table", bound=np.recarray[Any, Any])
Words = NDArray[np.int64]


class Pointer(types.Record):  # type: ignore[misc]  # numba's annotations know nothing of its types
    """numba's type of a record that is known by a pointer."""

    def __init__(self, layout: "np.dtype[Any]") -> None:
        plain: Any = numba.from_dtype(layout)
        super().__init__([(name, field._asdict()) for name, field in plain.fields.items()], plain.size, plain.aligned)
        self.name: str = f"Pointer({self})"


@register_model(Pointer)
class PointerModel(RecordModel):  # type: ignore[misc]
    """In memory, and so in a tuple, what a function is given: the pointer."""

    def get_data_type(self) -> ir.Type:
        return self.get_value_type()

    def as_data(self, builder: ir.IRBuilder, value: ir.Value) -> ir.Value:
        return value

    def from_data(self, builder: ir.IRBuilder, value: ir.Value) -> ir.Value:
        return value

    def load_from_data_pointer(self, builder: ir.IRBuilder, ptr: ir.Value, align: int | None = None) -> ir.Value:
        return builder.load(ptr)


def pointed_at(kind: type[Record], layout: "np.dtype[Any]") -> Callable[[Words], Record]:
    """Have compiled code know records of class ``kind`` and this layout by a pointer.

    Returns the function, for kernels and for Python, that makes such a record of the 64-bit words in which it lies. The words
    must outlive it. Of numba's type of the words it makes that of the record.
    """
    pointer = Pointer(layout)

    @typeof_impl.register(kind)  # type: ignore[untyped-decorator]  # so are all of numba's
    def _(value: object, context: object) -> Pointer:
        return pointer

    @intrinsic  # type: ignore[untyped-decorator]
    def first_word(typing_context: object, words: Any) -> Any:
        def build(context: Any, builder: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
            array = context.make_array(signature.args[0])(context, builder, values[0])
            return builder.bitcast(array.data, context.get_value_type(signature.return_type))

        return pointer(words), build

    def at(words: Words) -> Record:
        found: Record = pointer if isinstance(words, types.Type) else words.view(layout)[0]
        return found

    @overload(at)  # type: ignore[untyped-decorator]
    def compiled(words: Any) -> Any:
        # numba wants the same annotations on both
        def body(words: Any) -> Any:
            return first_word(words)

        return body

    return at


def table_of(kind: type[Table], layout: "np.dtype[Any]") -> Callable[[Words], tuple[Table]]:
    """The function, for kernels and for Python, that makes a table of class ``kind`` of the 64-bit words in which it lies.

    It comes in a tuple of one: without reference counting a compiled function may not return a bare array. A row of the layout
    fills whole words. `table[i]` is a record, which kernels hand on as a pointer; `table.field[i]` works too. Of numba's type
    of the words it makes that of the table.
    """
    row: Any = numba.from_dtype(layout)

    def rows(words: Words) -> tuple[Table]:
        found: Table = words.copy(dtype=row) if isinstance(words, types.Type) else words.view(layout).view(kind)
        return (found,)

    @overload(rows)  # type: ignore[untyped-decorator]
    def compiled(words: Any) -> Any:
        def body(words: Any) -> Any:
            return (words.view(layout),)

        return body

    return rows
