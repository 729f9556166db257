"""What is left out of the code that LLVM reads is only what nobody uses."""

import pytest
from llvmlite import ir

from avatarsim.lean_code import extract_value, prune, unless_constant, unless_neutral

WORD = ir.IntType(64)
PAIR = ir.LiteralStructType([WORD, ir.ArrayType(WORD, 2)])


@pytest.fixture
def builder():
    function = ir.Function(ir.Module(), ir.FunctionType(WORD, [WORD, PAIR, WORD.as_pointer()]), "f")
    return ir.IRBuilder(function.append_basic_block())


def written(builder):
    """The instructions of the block, by name."""
    return [one.opname for one in builder.block.instructions]


def test_what_was_put_in_is_taken_from_where_it_came(builder):
    number, pair, _ = builder.function.args
    with_number = builder.insert_value(pair, number, 0)
    inner = builder.insert_value(with_number, number, (1, 0))
    assert extract_value(builder, inner, 0) is number
    assert extract_value(builder, inner, (1, 0)) is number
    assert extract_value(builder, inner, [1, 1]).operands == [pair]
    assert extract_value(builder, inner, 1).operands == [inner]
    assert written(builder) == ["insertvalue", "insertvalue", "extractvalue", "extractvalue"]


def test_only_what_is_used_is_written(builder):
    number, pair, memory = builder.function.args
    builder.add(builder.extract_value(pair, 0), number)
    unread, read = builder.alloca(WORD), builder.alloca(WORD)
    builder.store(builder.load(memory), unread)
    builder.store(number, read)
    builder.store(number, memory)
    builder.ret(builder.mul(builder.load(read), number))
    prune(builder.function)
    assert written(builder) == ["alloca", "store", "store", "load", "mul", "ret"]


def test_a_value_that_only_a_phi_uses_is_written(builder):
    number = builder.function.args[0]
    after = builder.append_basic_block()
    doubled, home = builder.add(number, number), builder.block
    builder.branch(after)
    builder.position_at_end(after)
    joined = builder.phi(WORD)
    joined.add_incoming(doubled, home)
    builder.ret(joined)
    prune(builder.function)
    assert [one.opname for one in home.instructions] == ["add", "br"] and written(builder) == ["phi", "ret"]


@pytest.mark.parametrize(("constant", "neutral", "kept"), [(0, 0, False), (1, 1, False), (1, 0, True), (0, 1, True)])
def test_only_adding_nothing_and_taking_once_is_left_out(builder, constant, neutral, kept):
    number, other = builder.function.args[0], ir.Constant(WORD, constant)
    add = unless_neutral(ir.IRBuilder.add, neutral)
    assert [add(builder, *both) is number for both in ((number, other), (other, number))] == [not kept] * 2


@pytest.mark.parametrize(("constant", "kept"), [(0, False), (2, False), (-1, True)])
def test_an_index_that_counts_from_the_end_is_cared_for(constant, kept):
    fixed = unless_constant(lambda builder, index, size: size)
    index = ir.Constant(WORD, constant)
    assert (fixed(None, index, ir.Constant(WORD, 9)) is index) is not kept
