"""Links to parts of the repository that are not pages: a folder's page if it has one, otherwise the plain path."""

import posixpath
from pathlib import Path

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parent.parent

#: The pages of folders that do not have a README.
FOLDERS = {"docs/help": "docs/help/taotie", "python/notebooks": "notebooks"}


def resolve(app: Sphinx, doctree: nodes.document) -> None:
    """Replace links to existing files and folders; a link to anything else stays, and is an error."""
    folder = posixpath.dirname(app.env.docname)
    for link in list(doctree.findall(addnodes.pending_xref)):
        target, anchor = link.get("reftarget", ""), "#" in link.get("reftarget", "")
        if link.get("reftype") != "myst" or link.get("refdomain") or not target or anchor:
            continue
        path = posixpath.normpath(posixpath.join(folder, target))
        if path.startswith("..") or not (ROOT / path).exists():
            continue
        page = FOLDERS.get(path, f"{path}/README")
        if page in app.env.found_docs:
            link["refdomain"], link["reftarget"], link["reftargetid"] = "doc", page, None
        else:
            link.replace_self(nodes.inline("", "", *[child.deepcopy() for child in link.children]))


def setup(app: Sphinx) -> dict[str, object]:
    """Look at the links of each page once it is read."""
    app.connect("doctree-read", resolve)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
