"""What is left out of a compile changes no instruction of what comes out."""

import dis
import json
import operator
import os
import subprocess
import sys
from collections import Counter
from itertools import product

import pytest
from llvmlite.ir import types as llvm_types
from numba.core import bytecode, ir, types
from numba.core.compiler import Flags
from numba.core.errors import NumbaTypeError
from numba.core.targetconfig import TargetConfig

from avatarsim.quick_compiler import Known, While, remembered_hash, same_kind, same_options, told_once, variables, without_room

COMPILE = """
import gc
import json
import re
from itertools import combinations
from numba.core import compiler
from avatarsim import linking
{before}
from avatarsim.compile_ahead import part_scene
from avatarsim.start_check import require_free
from avatarsim.world.world import build

gc.disable()
codes, written = {{}}, {{}}
optimize = linking.KernelLibrary._optimize_functions
reduce = linking.KernelCache.reduce

def without_numbers(code):
    # Numbers of specialisations and of types count up in the order of compiling, which is another.
    return re.sub("(Record|Pointer)ILi[0-9]+E", "", re.sub("[0-9]*v[0-9]+", "v", code))

def told(name):
    # What is just large enough to be called by name in lean code may not be so in numba's, and the other way round.
    if name.startswith('"avatarsim-sealed:'):
        return name.split(":")[1]
    parts, rest = [], name.removeprefix("_ZN")
    while found := re.match("[0-9]+", rest):
        first, end = found.end(), found.end() + int(found[0])
        parts, rest = [*parts, rest[first:end]], rest[end:]
    return ".".join(parts) or name

def keep(self, compiled):
    codes[compiled.fndesc.qualname + str(compiled.fndesc.argtypes)] = without_numbers(str(compiled.library._final_module))
    return reduce(self, compiled)

def note(library, module):
    # Before LLVM touches it.
    done = re.findall("= (f(?:add|sub|mul|div|rem|neg) |fcmp [a-z]+ |(?:tail )?call .*?@[^(]*)", str(module))
    done = [re.sub("@(.*)", lambda found: "@" + told(found[1]), one) for one in done]
    written.setdefault(library.name, []).extend(map(without_numbers, done))
    return optimize(library, module)

linking.KernelLibrary._optimize_functions = note
linking.KernelCache.reduce = keep
world = build(part_scene("motion")[0])
require_free(world)
from avatarsim.collide.gjk import gjk
from avatarsim.collide.scratch import make_scratch
from avatarsim.collide.signed_distance import signed_distance
shapes, vertices, scratch = world.geometry.shapes, world.poses.vertices, make_scratch()
pairs = list(combinations(range(len(shapes)), 2))
answers = [str(gjk(vertices, shapes, s, t, (0.0, 0.0, 0.0), float("inf"), scratch)) for s, t in pairs]
codes_so_far, nearest = dict(codes), {asked} and [
    str(signed_distance(vertices, shapes, s, t, (0.0, 0.0, 0.0), scratch)) for s, t in pairs
]
print(json.dumps([codes_so_far, [[array.tobytes().hex() for array in world.poses], answers], written, nearest]))
"""
NUMBAS_PASSES = "linking.KernelCompiler.define_pipelines = compiler.Compiler.define_pipelines"
REMEMBERED = "from avatarsim import quick_compiler; quick_compiler.write_lean = lambda: None; quick_compiler.quicken()"
QUICK = "from avatarsim.quick_compiler import quicken; quicken()"


def compiled(before, cache, asked=False):
    """LLVM's code of kernels that place shapes and look for the distance of their cores, what these answer, what is written of
    operations on numbers, and, if `asked`, how far shapes are apart, which takes twice as many; from a process of its own."""
    # kernels are looked for in every place: none of the user's own may answer
    environment = os.environ | {"NUMBA_CACHE_DIR": str(cache), "XDG_CACHE_HOME": str(cache), "HOME": str(cache)}
    command = [sys.executable, "-c", COMPILE.format(before=before, asked=asked)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    codes, answers, written, nearest = json.loads(done.stdout)
    assert len(codes) > 20 and all(answers) and bool(nearest) == asked
    return codes, answers, {name: Counter(operations) for name, operations in written.items()}, nearest


def test_fewer_passes_and_remembered_answers_give_the_same_code(tmp_path):
    numbas, remembered = (compiled(before, tmp_path / str(k)) for k, before in enumerate((NUMBAS_PASSES, REMEMBERED)))
    ours, quick = (compiled(before, tmp_path / f"asked {k}", asked=True) for k, before in enumerate(("", QUICK)))
    assert numbas[:2] == ours[:2] == remembered[:2]
    # What is written leanly may be inlined elsewhere, but gives the same answers by the same operations on numbers.
    assert quick[1:] == ours[1:]
    assert sum(operations.total() for operations in ours[2].values()) > 300


def test_options_are_equal_as_numba_says():
    def flags(**chosen):
        made = Flags()
        for name, value in chosen.items():
            setattr(made, name, value)
        return made

    made = [flags(), flags(nrt=False), flags(nrt=True), flags(error_model="numpy"), flags(nrt=False, error_model="numpy")]
    for one, other in product(made, made):
        assert same_options(one, other) == TargetConfig.__eq__(one, other)
    assert same_options(flags(), 1) is NotImplemented


@pytest.mark.parametrize("kind", ["call", "binop", "tuple"])
def test_variables_are_found_as_numba_finds_them(kind):
    here = ir.Loc("nowhere", 1)
    a, b, c = (ir.Var(None, name, here) for name in "abc")
    made = {
        "call": ir.Expr.call(a, (b, c, b), (("k", a),), here),
        "binop": ir.Assign(ir.Expr.binop(operator.add, a, b, here), c, here),
        "tuple": ir.Expr.build_tuple([c, a, b], here),
    }[kind]
    parts = vars(made)
    assert variables(parts, []) == made._rec_list_vars(parts) and len(variables(parts, [])) >= 3


def test_instructions_are_those_that_python_lists_and_follow_one_another():
    code = variables.__code__
    found = list(without_room(bytecode._unpack_opargs)(code.co_code))
    listed = [(one.offset, one.opcode) for one in dis.get_instructions(code) if one.opname != "EXTENDED_ARG"]
    assert [what for _, what, _, _ in found] == [what for _, what in listed]
    # Where an argument needs more than a byte, numba says that its instruction begins with the word that says so.
    assert all(0 <= listed[k][0] - first[0] <= 4 for k, first in enumerate(found))
    assert [one[3] for one in found[:-1]] == [one[0] for one in found[1:]] and found[-1][3] == len(code.co_code)


def test_hashes_and_equality_of_types_are_numbas():
    pair = types.Tuple((types.float64, types.Array(types.int64, 2, "C")))
    kinds = [types.int64, types.float64, types.Array(types.int64, 2, "C"), types.Array(types.int64, 1, "C"), pair]
    found = remembered_hash({})
    assert [found(kind) for kind in kinds] == [found(kind) for kind in kinds] == [hash(kind) for kind in kinds]
    for one, other in product(kinds, kinds):
        assert same_kind(one, other) == (one == other)
    assert not same_kind(types.int64, "int64")


def test_sizes_of_types_are_asked_once_each():
    asked = []

    def size(kind, target_data, context=None):
        asked.append(str(kind))
        return len(asked)

    told = told_once(size)
    word, pair = llvm_types.IntType(64), llvm_types.LiteralStructType([llvm_types.IntType(64)] * 2)
    assert [told(kind, None) for kind in (word, pair, llvm_types.IntType(64), pair)] == [1, 2, 1, 2]
    # A type that has a name may mean something else in another context.
    assert told(word, None, "context") == 3 and asked == ["i64", "{i64, i64}", "i64"]


def test_new_declarations_are_looked_for_once_a_module_was_imported(monkeypatch):
    looks = []

    class Context:
        refresh = Known(looks.append)

    one, other = Context(), Context()
    for context in (one, one, other, one):
        context.refresh()
    assert looks == [one, other]
    monkeypatch.setitem(sys.modules, "just_imported", sys)
    one.refresh()
    one.refresh()
    assert looks == [one, other, one]


def test_an_error_says_what_it_happened_in():
    error = NumbaTypeError("no such thing")
    with pytest.raises(NumbaTypeError) as raised, While("typing of {what}", what="a call"):
        raise error
    assert raised.value is error and error.contexts == ["typing of a call"]
