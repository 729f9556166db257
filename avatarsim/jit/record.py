"""Structured memory in kernels: one record that is passed as a pointer, and tables of records that share one array.

numba passes every array of a tuple as seven words or more, so passing a tuple of fifteen arrays costs more than many kernels
take. A record it passes as a pointer, but copies the whole of it into every tuple that holds it; so there is a type of its own
for it here, which differs in nothing else.
"""

from typing import Any

import numba
import numpy as np
from numba.extending import models, register_model, typeof_impl

types: Any = numba.types
Layout = np.dtype[Any]

RECORDS: dict[type, "Pointer"] = {}
"""Class of a record -> numba's type of it."""

TABLES: dict[type, Layout] = {}
"""Class of a table -> layout of a row."""


class Pointer(types.Record):  # type: ignore[misc]  # numba's annotations know nothing of its types
    """numba's type of a record that is known by a pointer."""

    def __init__(self, layout: Layout) -> None:
        plain: Any = numba.from_dtype(layout)
        super().__init__([(name, field._asdict()) for name, field in plain.fields.items()], plain.size, plain.aligned)
        self.name: str = f"Pointer({self})"
        self.layout = layout


@register_model(Pointer)
class PointerModel(models.RecordModel):  # type: ignore[misc]
    """In memory, and so in a tuple, the form of an argument: the pointer."""

    def get_data_type(self) -> Any:
        return self.get_value_type()

    def as_data(self, builder: Any, value: Any) -> Any:
        return value

    def from_data(self, builder: Any, value: Any) -> Any:
        return value

    def load_from_data_pointer(self, builder: Any, ptr: Any, align: int | None = None) -> Any:
        return builder.load(ptr)


def known_by_pointer(kind: type, layout: Layout) -> None:
    """Have compiled code know records of class ``kind`` and this layout, which fills whole words, by a pointer."""
    pointer = RECORDS[kind] = Pointer(layout)

    @typeof_impl.register(kind)  # type: ignore[untyped-decorator]  # so are all of numba's
    def _(value: object, context: object) -> Pointer:
        return pointer


def known_as_table(kind: type, layout: Layout) -> None:
    """Have arenas hold tables of class ``kind`` whose rows have this layout, which fills whole words.

    `table[i]` is a record, which kernels pass as a pointer; `table.field[i]` works too.
    """
    TABLES[kind] = layout
