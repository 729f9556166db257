"""A branch that is to stay one.

What two paths differ in, if it is little, LLVM computes always and then chooses: a square root and a division too, for which a
pass of the contact solver would wait at every contact, though most do not slip.
"""

from typing import Any

import numba
from llvmlite import ir
from numba.extending import intrinsic, overload

types: Any = numba.types


def seldom(condition: bool) -> bool:
    """The condition; compiled code takes it for one that seldom holds."""
    return condition


@intrinsic  # type: ignore[untyped-decorator]  # so are all of numba's
def _seldom(typing_context: object, condition: Any) -> Any:
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        flag = ir.IntType(1)
        expect = b.module.declare_intrinsic("llvm.expect.i1", fnty=ir.FunctionType(flag, [flag, flag]))
        return b.call(expect, [values[0], flag(0)])

    return types.boolean(types.boolean), build


@overload(seldom)  # type: ignore[untyped-decorator]
def _compiled(condition: Any) -> Any:
    # numba wants the same annotations on both
    def body(condition: Any) -> Any:
        return _seldom(condition)

    return body
