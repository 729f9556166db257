"""Formulas as MathML, made while the site is built: a browser shows them without a script and without a request.

LaTeX is translated by docutils, with which Sphinx comes.
"""

from html import escape

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

LOG = logging.getLogger(__name__)


def mathml(latex: str, *, is_block: bool) -> str:
    """Return one `<math>` element. Raises an error of docutils, a ValueError or SyntaxError, where it cannot translate."""
    markup: str = tex2mathml(latex, as_block=is_block)
    return markup


def written(node: nodes.math | nodes.math_block, *, is_block: bool) -> str:
    """Return the formula of a node; a warning, which ends the build, and its LaTeX if that cannot be translated."""
    try:
        return mathml(node.astext(), is_block=is_block)
    except (ValueError, SyntaxError) as error:
        LOG.warning("formula that docutils cannot translate: %s (%s)", node.astext(), error, location=node)
        return f"<code>{escape(node.astext())}</code>"


def visit_inline(self: HTML5Translator, node: nodes.math) -> None:
    """Write a formula in a line."""
    self.body.append(written(node, is_block=False))
    raise nodes.SkipNode


def visit_block(self: HTML5Translator, node: nodes.math_block) -> None:
    """Write a formula on lines of its own."""
    self.body.append(f'<div class="math">{written(node, is_block=True)}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
