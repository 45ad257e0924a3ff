"""THIRD-PARTY.html: the licence texts of everything linked into a release."""

from __future__ import annotations

import html
import re
from collections import defaultdict

import place
from packages import Package

FILES = re.compile(r"(?i)(licen[cs]e|copying|notice|copyright|patents)")
# Two crates with a choice of licences also have the text of this one, which is not chosen.
COPYLEFT = "GNU GENERAL PUBLIC LICENSE"
STYLE = "body{font:16px/1.5 system-ui,sans-serif;max-width:60em;margin:2em auto;padding:0 1em}th{text-align:left}td{padding-right:1em}pre{white-space:pre-wrap;font-size:13px}"
INTRODUCTION = "Taotie is available under the MIT or the Apache-2.0 licence. Its programs and wheels contain the packages listed here."


def page(packages: list[Package]) -> bytes:
    """Return the page: all packages, then each text once, with the packages that have it."""
    users: dict[str, list[Package]] = defaultdict(list)
    for package in packages:
        for text in texts_of(package):
            users[text].append(package)
    texts = sorted(users, key=lambda text: (-len(users[text]), users[text][0].name, text))
    number = {text: at for at, text in enumerate(texts, 1)}
    rows = "\n".join(row(package, sorted(number[text] for text in set(texts_of(package)))) for package in packages)
    parts = "\n".join(part(text, number[text], users[text]) for text in texts)
    head = f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>Third-party licences of Taotie</title><style>{STYLE}</style></head>'
    table = f"<table><tr><th>Package</th><th>Version</th><th>Licence</th><th>Texts</th></tr>\n{rows}\n</table>"
    return f"{head}\n<body><h1>Third-party licences of Taotie {place.version()}</h1>\n<p>{INTRODUCTION}</p>\n{table}\n{parts}\n</body></html>\n".encode()


def row(package: Package, numbers: list[int]) -> str:
    links = " ".join(f'<a href="#text-{number}">{number}</a>' for number in numbers)
    name = html.escape(package.name)
    cells = (f'<a href="{html.escape(package.source)}">{name}</a>' if package.source else name, html.escape(package.version), html.escape(package.licence), links)
    return f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"


def part(text: str, number: int, packages: list[Package]) -> str:
    names = ", ".join(sorted({package.name for package in packages}))
    return f'<h2 id="text-{number}">{number}: {html.escape(names)}</h2>\n<pre>{html.escape(text)}</pre>'


def texts_of(package: Package) -> list[str]:
    """Return the texts of a package's licence files, or those of its licences if it has no such files."""
    if not package.texts:
        package.texts = sorted(set(files_of(package))) or [standard(package)]
    return package.texts


def files_of(package: Package) -> list[str]:
    if package.folder is None:
        return []
    paths = sorted(path for path in package.folder.rglob("*") if FILES.match(path.name) and path.is_file() and path.suffix != ".rs")
    texts = [plain(path.read_text(encoding="utf-8", errors="replace")) for path in paths]
    return [text for text in texts if COPYLEFT not in text[:200]]


def plain(text: str) -> str:
    """Return a text without differences that nobody sees, so that equal ones are listed once."""
    return "\n".join(line.rstrip() for line in text.replace("\f", "\n").splitlines()).strip("\n")


def standard(package: Package) -> str:
    """Return the text of a licence for a package that only names it: Apache-2.0, which names nobody, or MIT."""
    if "Apache-2.0" in package.licence:
        return plain((place.ROOT / "LICENSE-APACHE").read_text())
    if "MIT" not in package.licence:
        raise SystemExit(f"make dist: {package.name} {package.version} has no licence file and is not under MIT or Apache-2.0: add its text to dist/licences.py")
    terms = plain((place.ROOT / "LICENSE-MIT").read_text())
    authors = ", ".join(re.sub(r" <.*>", "", author) for author in package.authors) or f"the authors of {package.name}"
    return f"MIT License\n\nCopyright (c) {authors}\n\n{terms[terms.index('Permission is hereby granted'):]}"
