"""Formulas as MathML, written at build: pages need neither a script nor a network to show them."""

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx


def write(visitor, node: nodes.Node) -> None:
    """Write a formula, inline or as a block."""
    block = isinstance(node, nodes.math_block)
    formula = convert(node.astext(), display="block" if block else "inline")
    visitor.body.append(f'<div class="formula">{formula}</div>' if block else formula)
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, object]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", inline_renderers=(write, None), block_renderers=(write, None))
    app.config.html_math_renderer = "mathml"
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
