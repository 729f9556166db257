"""How much code does LLVM get to read? Less than numba writes, in processes that do nothing but compile kernels.

numba puts every array into memory before it looks at one of its fields, and every variable that outlives a block; it takes all
eleven words of an array out of a tuple for the sake of one number. LLVM undoes all of it, after the code was written out as
text, parsed and tidied, which was half of a compile. Here values stay values, a part that was just put in is not taken out
again, and what nobody uses is not written. Every operation on numbers stays as it was.
"""

from collections import Counter
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.analysis import compute_cfg_from_blocks, compute_use_defs
from numba.core.codegen import CPUCodeLibrary
from numba.core.ir import Assign
from numba.core.lowering import Lower
from numba.core.postproc import PostProcessor
from numba.cpython import slicing
from numba.np import arrayobj

from avatarsim.lean_calls import write_lean_calls

PURE = frozenset(
    "load getelementptr extractvalue insertvalue alloca bitcast inttoptr ptrtoint trunc zext sext sitofp fptosi uitofp "
    "add sub mul sdiv srem and or xor shl ashr lshr icmp fcmp select fadd fsub fmul fdiv fneg".split()
)
"""Instructions that do nothing but make their value."""


def write_lean() -> None:
    """From here on, in this process, numba writes less code."""
    builder: Any = ir.IRBuilder
    builder.extract_value = extract_value
    builder.add, builder.mul = unless_neutral(builder.add, 0), unless_neutral(builder.mul, 1)
    slicing.fix_index = unless_constant(slicing.fix_index)
    # Kinds of structures that are known already stay as they are.
    cgutils.ValueStructProxy = KeptStruct
    cgutils._struct_proxy_cache.clear()
    arrayobj.make_array = plain_arrays(arrayobj.make_array)
    lower: Any = Lower
    lower._find_singly_assigned_variable = kept_variables(lower._find_singly_assigned_variable)
    # Nobody counts references: where a variable is used last is of no interest.
    processor: Any = PostProcessor
    processor._insert_var_dels = lambda _processor, extend_lifetimes=False: None
    lower.storevar = storevar
    # numba spells out every instruction that it lowers, for a report that nobody wants.
    Assign.__str__ = lambda assign: f"{assign.target.name} = ..."
    library: Any = CPUCodeLibrary
    library.add_ir_module = pruned(library.add_ir_module)
    write_lean_calls()


def extract_value(builder: Any, whole: Any, place: Any, name: str = "") -> Any:
    """As llvmlite does, but what was put in just before is taken from where it came."""
    path = tuple(place) if isinstance(place, tuple | list) else (place,)
    while isinstance(whole, ir.instructions.InsertValue):
        put = tuple(whole.indices)
        if put == path[: len(put)]:
            whole, path = whole.value, path[len(put) :]
            if not path:
                return whole
        elif path == put[: len(path)]:
            break
        else:
            whole = whole.aggregate
    found = ir.instructions.ExtractValue(builder.block, whole, path, name=name)
    builder._insert(found)
    return found


def unless_neutral(combine: Any, neutral: int) -> Any:
    """Whole numbers are added and multiplied as llvmlite does, unless that changes nothing: x + 0, 1 x."""

    def combined(builder: Any, one: Any, other: Any, name: str = "", flags: Any = ()) -> Any:
        if isinstance(one, ir.Constant) and one.constant == neutral:
            return other
        if isinstance(other, ir.Constant) and other.constant == neutral:
            return one
        return combine(builder, one, other, name=name, flags=flags)

    return combined


def unless_constant(fix_index: Any) -> Any:
    """numba's care for an index that may count from the end, unless it is seen to count from the beginning."""

    def fixed(builder: Any, index: Any, size: Any) -> Any:
        known = isinstance(index, ir.Constant) and isinstance(index.constant, int) and index.constant >= 0
        return index if known else fix_index(builder, index, size)

    return fixed


class KeptStruct(cgutils.ValueStructProxy):  # type: ignore[misc]  # numba has no annotations here
    """numba's view of a structure; that of an array stays a value until somebody asks where it lies, or writes to it from
    another block than the one that made it."""

    def __init__(self, context: Any, builder: Any, value: Any = None, ref: Any = None) -> None:
        self._kept = False
        if ref is not None or type(self._fe_type) is not types.Array:
            super().__init__(context, builder, value, ref)
            return
        self._context, self._builder = context, builder
        self._datamodel = context.data_model_manager[self._fe_type]
        self._be_type = self._get_be_type(self._datamodel)
        if value is not None and value.type != self._be_type:
            raise AssertionError(f"bad value type: expected {self._be_type}, got {value.type}")
        self._whole, self._home = value, builder.block
        self._put: dict[int, Any] = {}
        self._kept, self._read_elsewhere = True, False

    def __getattr__(self, field: str) -> Any:
        if field in ("_value", "_outer_ref"):
            self._to_memory()
            return self.__dict__[field]
        return super().__getattr__(field)

    def __getitem__(self, index: int) -> Any:
        if not self._kept:
            return super().__getitem__(index)
        self._read_elsewhere |= self._builder.block is not self._home
        if index in self._put:
            return self._put[index]
        if self._whole is None:
            return self._be_type.elements[index](None)
        return self._builder.extract_value(self._whole, index)

    def __setitem__(self, index: int, value: Any) -> None:
        fits = self._kept and value.type == self._be_type.elements[index]
        if fits and self._builder.block is self._home and not self._read_elsewhere:
            self._put[index] = value
        else:
            super().__setitem__(index, value)

    def _getpointer(self) -> Any:
        return self._outer_ref

    def _getvalue(self) -> Any:
        if not self._kept:
            return super()._getvalue()
        self._read_elsewhere |= self._builder.block is not self._home
        return self._made()

    def _setvalue(self, value: Any) -> None:
        if self._kept and self._builder.block is self._home and not self._read_elsewhere:
            self._whole, self._put = value, {}
        else:
            super()._setvalue(value)

    def _made(self) -> Any:
        """The whole value, of the fields that were put in and of what it was before."""
        whole = self._whole
        if whole is None:
            whole = self._be_type(ir.Undefined if len(self._put) == len(self._be_type.elements) else None)
        for index, value in self._put.items():
            whole = self._builder.insert_value(whole, value, index)
        return whole

    def _to_memory(self) -> None:
        """Let it lie in memory from here on, as it was at the end of the block that made it."""
        assert self._kept and not self._read_elsewhere, "a structure was read as a value before it was written to in memory"
        self._kept = False
        self._value = self._outer_ref = cgutils.alloca_once(self._builder, self._be_type)
        if self._builder.block is self._home:
            self._builder.store(self._made(), self._value)
        else:
            with self._builder.goto_block(self._home):
                self._builder.store(self._made(), self._value)


def plain_arrays(of_others: Any) -> Any:
    """numba's maker of views of an array, which makes a class of its own for every access, and of plain arrays need not."""
    return lambda array: cgutils.create_struct_proxy(array) if type(array) is types.Array else of_others(array)


def kept_variables(within_blocks: Any) -> Any:
    """Which variables need no place in memory: those of one block, as numba finds, and those that one assignment defines
    before all uses."""

    def find(lower: Any) -> None:
        within_blocks(lower)
        blocks = lower.func_ir.blocks
        if lower.func_ir.func_id.is_generator or lower.context.enable_nrt:
            return
        uses = compute_use_defs(blocks).usemap
        above = compute_cfg_from_blocks(blocks).dominators()
        assigned = [(one.target.name, label) for label, block in blocks.items() for one in block.find_insts(Assign)]
        times, homes = Counter(name for name, _ in assigned), dict(assigned)
        # Blocks are lowered in the order of their labels.
        late = {
            name
            for label, names in uses.items()
            for name in names
            if name in homes and not (homes[name] in above[label] and homes[name] < label)
        }
        lower._singly_assigned_vars |= {name for name in homes if times[name] == 1} - late

    return find


def storevar(lower: Any, value: Any, name: str, argidx: Any = None) -> None:
    """As numba does, without a look at the old value, which only reference counting needs."""
    lower._alloca_var(name, lower.typeof(name))
    if name in lower._singly_assigned_vars:
        lower._blk_local_varmap[name] = value
    else:
        lower.builder.store(value, lower.getvar(name))


def pruned(add: Any) -> Any:
    """numba's way to hand code to LLVM, without what nobody uses."""

    def run(library: Any, module: Any) -> None:
        for function in module.functions:
            prune(function)
        add(library, module)

    return run


def prune(function: Any) -> None:
    """Take out instructions whose value nobody uses, and writing to memory that nobody reads."""
    uses: Counter[int] = Counter()
    stores: Counter[int] = Counter()
    for block in function.blocks:
        for instruction in block.instructions:
            for used in operands(instruction):
                uses[id(used)] += 1
            if instruction.opname == "store":
                stores[id(instruction.operands[1])] += 1
    dead: set[int] = set()
    again = True
    while again:
        again = False
        for block in reversed(function.blocks):
            for instruction in reversed(block.instructions):
                if id(instruction) not in dead and idle(instruction, uses, stores):
                    dead.add(id(instruction))
                    again = again or instruction.opname == "store"
                    for used in operands(instruction):
                        uses[id(used)] -= 1
                    if instruction.opname == "store":
                        stores[id(instruction.operands[1])] -= 1
    for block in function.blocks:
        block.instructions = [one for one in block.instructions if id(one) not in dead]


def operands(instruction: Any) -> Any:
    """What an instruction uses."""
    return [value for value, _ in instruction.incomings] if instruction.opname == "phi" else instruction.operands


def idle(instruction: Any, uses: Counter[int], stores: Counter[int]) -> bool:
    """Whether a function does the same without this instruction."""
    if instruction.opname == "store":
        place = instruction.operands[1]
        return isinstance(place, ir.AllocaInstr) and uses[id(place)] == stores[id(place)]
    return instruction.opname in PURE and not uses[id(instruction)]
