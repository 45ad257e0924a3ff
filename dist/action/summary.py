"""The table on the page of the job."""

from __future__ import annotations

import html
import json

from figures import in_words
from proofs import Result

VERDICTS = {"passed": "passed", "not met": "<b>requirement not met</b>", "failed": "<b>failed</b>"}


def table(mode: str, results: list[Result]) -> str:
    """Return a table of all results in HTML, which no file name can break out of."""
    head = "".join(f"<th>{title}</th>" for title in ("asset", "scan", "verdict", "figures and messages"))
    rows = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells(result))}</tr>\n" for result in results)
    return f"\n<h3>taotie {mode}</h3>\n<table>\n<tr>{head}</tr>\n{rows}</table>\n\n"


def cells(result: Result) -> list[str]:
    figures = [visible(in_words(figure)) for figure in result.figures]
    marked = [line if figure["met"] else f"<b>{line}</b>" for line, figure in zip(figures, result.figures)]
    text = "<br>".join(marked + [visible(line) for line in [*result.errors, *result.warnings]])
    return [f"<code>{visible(result.pair.asset)}</code>", f"<code>{visible(result.pair.scan)}</code>", VERDICTS[result.verdict], text]


def visible(text: str) -> str:
    """Return text for HTML; control characters are escaped as in JSON."""
    plain = text if text.isprintable() else json.dumps(text, ensure_ascii=True)[1:-1]
    return html.escape(plain)
