"""The public names of avatarsim for the API reference: which they are, where they are defined, and their signatures."""

import ast
import inspect
import pkgutil
import sys
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import is_dataclass
from enum import Enum
from functools import cache
from types import ModuleType
from typing import NamedTuple

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util.nodes import make_refnode

import avatarsim
from docs.extensions.docstrings import restructured

RARER = (
    "avatarsim.engine.Engine",
    "avatarsim.scene.scene.EARTH",
    "avatarsim.scene.body.Body",
    "avatarsim.scene.body.Role",
    "avatarsim.scene.joint.ReachCone",
    "avatarsim.scene.body.TABLE_1",
    "avatarsim.scene.effects.Effects",
    "avatarsim.scene.tracker.link_poses",
    "avatarsim.settings.PostureSettings",
    "avatarsim.settings.CouplingSettings",
    "avatarsim.settings.PaperSettings",
    "avatarsim.settings.AttractionSettings",
    "avatarsim.errors.InvalidScene",
    "avatarsim.errors.InvalidShape",
    "avatarsim.errors.InvalidSample",
    "avatarsim.errors.InvalidFile",
    "avatarsim.errors.InvalidSnapshot",
    "avatarsim.errors.UnknownName",
    "avatarsim.errors.EngineInUse",
    "avatarsim.errors.NotCopied",
    "avatarsim.errors.MissingPackage",
    "avatarsim.errors.UnsupportedVersion",
)
"""Names that the public ones return, raise or take, and that are defined in their modules."""

PLACES = {"avatarsim.simulator": 0, "avatarsim.engine": 1, "avatarsim.settings": 3, "avatarsim.errors": 4}
"""Where modules are on the page; all others between, by name."""


class Public(NamedTuple):
    """A public name: `dotted`, as users write it; `found`, its object; `home`, the module that defines it."""

    dotted: str
    obj: object
    home: ModuleType

    @property
    def short(self) -> str:
        """The name alone."""
        return self.dotted.rpartition(".")[2]


def home_of(dotted: str, obj: object) -> ModuleType:
    """Return the module that defines an object: the one that it names itself, else the one of avatarsim that assigns it."""
    module_name = getattr(obj, "__module__", None)
    if isinstance(module_name, str) and module_name.startswith("avatarsim") and module_name in sys.modules:
        return sys.modules[module_name]
    place, _, short = dotted.rpartition(".")
    for name, module in sorted(sys.modules.items()):
        if name.startswith("avatarsim") and vars(module).get(short) is obj and short in assigned(module):
            return module
    return sys.modules[place]


@cache
def assigned(module: ModuleType) -> Mapping[str, str]:
    """Return names that a module assigns at its top level, each with the docstring below it."""
    if not getattr(module, "__file__", None):
        return {}
    body, docs = ast.parse(inspect.getsource(module)).body, dict[str, str]()
    for node, after in zip(body, [*body[1:], None], strict=True):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        value = after.value if isinstance(after, ast.Expr) else None
        text = value.value if isinstance(value, ast.Constant) and isinstance(value.value, str) else ""
        docs |= {target.id: inspect.cleandoc(text) for target in targets if isinstance(target, ast.Name)}
    return docs


@cache
def public_names() -> tuple[Public, ...]:
    """Return names of `avatarsim.__all__`, then the rarer ones; an object of two names has its first."""
    dotted = [f"avatarsim.{name}" for name in avatarsim.__all__ if not name.startswith("__")]
    things: dict[int, tuple[str, object]] = {}
    for name in (*dotted, *RARER):
        thing = pkgutil.resolve_name(name)
        things.setdefault(id(thing), (name, thing))
    # the modules that define them are looked up when all of them are imported
    return tuple(Public(name, thing, home_of(name, thing)) for name, thing in things.values())


def directive(public: Public) -> list[str]:
    """Return the directive that documents a name, in reStructuredText."""
    obj = public.obj
    if isinstance(obj, ModuleType):
        return [f".. automodule:: {public.dotted}", "   :members:"]
    if isinstance(obj, type):
        if issubclass(obj, BaseException):
            return [f".. autoexception:: {public.dotted}", "   :show-inheritance:"]
        return [f".. autoclass:: {public.dotted}", "   :members:", "   :member-order: bysource"]
    if inspect.isroutine(obj):
        return [f".. autofunction:: {public.dotted}"]
    text = assigned(public.home).get(public.short, "")
    return [f".. py:data:: {public.dotted}", "", *(f"   {line}" for line in restructured(text.splitlines()))]


def page() -> Iterator[str]:
    """Yield lines of Markdown: a heading for each module that defines public names, its first sentence, and its names."""
    modules: dict[str, list[Public]] = {}
    for public in public_names():
        modules.setdefault(public.home.__name__, []).append(public)
    for name, those in sorted(modules.items(), key=lambda item: (PLACES.get(item[0], 2), item[0])):
        summary = inspect.cleandoc(those[0].home.__doc__ or "").partition("\n\n")[0]
        yield from (f"## {name}", "", " ".join(summary.split()), "", "```{eval-rst}")
        for public in those:
            yield from (*directive(public), "")
        yield from ("```", "")


def signature_of(obj: object, is_method: bool) -> tuple[str, str | None]:
    """Return arguments in parentheses, as in the source, and the returned type; both empty where there is nothing to write.

    Python's own words for a default may be a page long: that of a scene's materials is all of Table 1."""
    try:
        node = ast.parse(textwrap.dedent(inspect.getsource(obj))).body[0]  # type: ignore[arg-type]
    except (OSError, TypeError, IndexError):
        return "", None
    if isinstance(node, ast.FunctionDef):
        return of_function(node, is_method)
    if isinstance(node, ast.ClassDef) and isinstance(obj, type):
        return of_class(node, obj), None
    return "", None


def of_function(node: ast.FunctionDef, is_method: bool) -> tuple[str, str | None]:
    """Return the signature of a function or a method."""
    is_bound = is_method and not any(ast.unparse(one) == "staticmethod" for one in node.decorator_list)
    if is_bound and node.args.args:
        del node.args.args[0]
    given = node.args
    for arg in (*given.posonlyargs, *given.args, *given.kwonlyargs, *filter(None, (given.vararg, given.kwarg))):
        if arg.annotation is not None:
            arg.annotation = ast.parse(unquoted(arg.annotation), mode="eval").body
    return f"({ast.unparse(node.args)})", unquoted(node.returns) if node.returns else None


def of_class(node: ast.ClassDef, kind: type) -> str:
    """Return the signature that makes an object of a class."""
    for part in node.body:
        if isinstance(part, ast.FunctionDef) and part.name == "__init__":
            return of_function(part, True)[0]
    is_tuple = issubclass(kind, tuple) and hasattr(kind, "_fields")
    if issubclass(kind, Enum) or not (is_tuple or is_dataclass(kind)):
        return ""
    fields = [part for part in node.body if isinstance(part, ast.AnnAssign) and isinstance(part.target, ast.Name)]
    return f"({', '.join(field_of(field) for field in fields)})"


def field_of(field: ast.AnnAssign) -> str:
    """Return a field as an argument; the value of a factory is written `...`."""
    text = f"{ast.unparse(field.target)}: {unquoted(field.annotation)}"
    if field.value is None:
        return text
    if isinstance(field.value, ast.Call) and ast.unparse(field.value.func) == "field":
        given = {word.arg: ast.unparse(word.value) for word in field.value.keywords}
        if not {"default", "default_factory"} & set(given):
            return text
        return f"{text} = {given.get('default', '...')}"
    return f"{text} = {ast.unparse(field.value)}"


def unquoted(annotation: ast.expr) -> str:
    """Return an annotation without the quotes around names defined later."""
    if isinstance(annotation, ast.Constant) and isinstance(annotation.value, str):
        return annotation.value
    return ast.unparse(annotation)


def process_signature(
    app: Sphinx, what: str, name: str, obj: object, options: object, signature: str | None, returns: str | None
) -> tuple[str, str | None] | None:
    """Called by autodoc for each signature; None leaves it as it is."""
    if signature is None or what not in ("class", "exception", "function", "method"):
        return None
    return signature_of(obj, what == "method")


def skip_member(app: Sphinx, what: str, name: str, obj: object, skip: bool, options: object) -> bool | None:
    """Skip fields of named tuples when autodoc calls this for each member: Python's own docstrings for them are empty."""
    return True if type(obj).__name__ == "_tuplegetter" else None


def resolve(app: Sphinx, env: BuildEnvironment, node: pending_xref, content: nodes.TextElement) -> nodes.reference | None:
    """Called by Sphinx for a name that it does not find: under its short name, or that of its module, it may be public."""
    if node.get("refdomain") != "py":
        return None
    wanted, known = node["reftarget"], env.domains.python_domain.objects
    for public in public_names():
        if wanted in (public.short, f"{public.home.__name__}.{public.short}") and public.dotted in known:
            place = known[public.dotted]
            return make_refnode(app.builder, node["refdoc"], place.docname, place.node_id, content, public.dotted)
    return None


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("autodoc-process-signature", process_signature)
    app.connect("autodoc-skip-member", skip_member)
    app.connect("missing-reference", resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
