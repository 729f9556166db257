"""Which types do the variables of a kernel have? Asked again only where the answer may be another, in processes that compile.

numba infers types in rounds: all instructions, again and again, until nothing new is found, so the last round finds nothing.
And for every name of a kernel or a function it asks anew of what type that is.
"""

from collections.abc import Callable
from types import BuiltinFunctionType, FunctionType
from typing import Any

from numba.core import errors, itanium_mangler, typeinfer, utils
from numba.core.dispatcher import Dispatcher
from numba.core.extending import _Intrinsic
from numba.core.types.abstract import Type
from numba.core.typing.context import BaseContext

ASKS: dict[type, Callable[[Any], list[Any]]] = {
    typeinfer.Propagate: lambda one: [one.src],
    typeinfer.CallConstraint: lambda one: [one.func, *call_arguments(one)],
    typeinfer.IntrinsicCallConstraint: lambda one: call_arguments(one),
    typeinfer.GetAttrConstraint: lambda one: [one.value],
    typeinfer.BuildTupleConstraint: lambda one: list(one.items),
    typeinfer.ExhaustIterConstraint: lambda one: [one.iterator],
    typeinfer.PairFirstConstraint: lambda one: [one.pair],
    typeinfer.PairSecondConstraint: lambda one: [one.pair],
    typeinfer.StaticGetItemConstraint: lambda one: [one.value, *(call_arguments(one.fallback) if one.fallback else ())],
    typeinfer.SetItemConstraint: lambda one: [one.target, one.index, one.value],
    typeinfer.StaticSetItemConstraint: lambda one: [one.target, one.index_var, one.value],
}
"""Of which variables an instruction asks for the types, by what numba makes of it; of a kind that is not here: of any."""

LASTING = (FunctionType, BuiltinFunctionType, type, Dispatcher, _Intrinsic)
"""Kinds of values of a name that are one and the same for as long as the process lives."""


def type_quickly() -> None:
    """From here on, in this process, numba asks for types only where that may tell something new."""
    network: Any = typeinfer.ConstraintNetwork
    network.propagate = propagate
    context: Any = BaseContext
    context.resolve_value_type = asked_once(context.resolve_value_type)
    # The name of a kernel spells out the types of its arguments, with all fields of each record.
    names: Any = itanium_mangler
    names.mangle_type_or_value = names.mangle_type = names.mangle_value = spelled_once(names.mangle_type_or_value)


def call_arguments(call: Any) -> list[Any]:
    """The variables that a call is given."""
    arguments = [*call.args, *(variable for _, variable in call.kws)]
    return arguments if call.vararg is None else [*arguments, call.vararg]


def propagate(network: Any, inferer: Any) -> list[Exception]:
    """One round of numba's, without those who would be told what they were told the last time; returns the errors."""
    found: list[Exception] = []
    known = inferer.typevars
    for one in network.constraints:
        asks = one.__dict__.get("asks")
        if asks is None and type(one) in ASKS:
            asks = one.asks = [getattr(variable, "name", variable) for variable in ASKS[type(one)](one)]
        before = None if asks is None else [known[name].type for name in asks]
        if before is not None and before == one.__dict__.get("settled_by"):
            continue
        try:
            one(inferer)
        except errors.ForceLiteralArg as error:
            found.append(error)
        except errors.TypingError as error:
            found.append(utils.chain_exception(errors.TypingError(str(error), loc=one.loc, highlighting=False), error))
        else:
            one.settled_by = before
    return found


def asked_once(ask: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    """The type of a name's value; that of a function or a kernel is asked for once, and an error is not kept."""
    known: dict[tuple[Any, Any], Any] = {}

    def asked(context: Any, value: Any) -> Any:
        if not isinstance(value, LASTING):
            return ask(context, value)
        key = context, value
        if key not in known:
            known[key] = ask(context, value)
        return known[key]

    return asked


def spelled_once(spell: Callable[[Any], str]) -> Callable[[Any], str]:
    """How a type is spelled in a name."""
    known: dict[Any, str] = {}

    def spelled(kind: Any) -> str:
        if not isinstance(kind, Type):
            return spell(kind)
        name = known.get(kind)
        if name is None:
            name = known[kind] = spell(kind)
        return name

    return spelled
