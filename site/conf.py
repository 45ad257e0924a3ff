"""Settings of the docs site: pages of `docs`, the README, help pages, notebooks and, if the package is there, Python."""

import importlib.util
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path.insert(0, str(HERE))

project = "Taotie"
copyright = "the Taotie developers"
root_doc = "index"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "mathml", "repository_links"]

# `stage.py` copies the sources into one folder.
include_patterns = ["*.md", "docs/**.md", "python/notebooks/*.ipynb"]

myst_enable_extensions = ["colon_fence", "dollarmath", "html_image"]
myst_heading_anchors = 4
myst_links_external_new_tab = False

# Notebooks have no stored outputs: without the package, their pages show the code. Sphinx defines `tags`.
HAS_PACKAGE = importlib.util.find_spec("taotie") is not None and not tags.has("check")
nb_execution_mode = "force" if HAS_PACKAGE else "off"
nb_execution_raise_on_error = True
nb_execution_timeout = 600
nb_execution_in_temp = True

autodoc_member_order = "bysource"
autodoc_typehints = "none"
default_role = "literal"
napoleon_google_docstring = False
napoleon_use_param = False
napoleon_use_rtype = False

html_theme = "furo"
html_title = "Taotie"
html_static_path = [str(HERE / "static")]
html_css_files = ["site.css"]
EXTRA = ROOT / "target/site/extra"
html_extra_path = [str(EXTRA)] if EXTRA.is_dir() else []
html_copy_source = False
html_show_sphinx = False
templates_path = []

if HAS_PACKAGE:
    tags.add("package")
if (EXTRA / "viewer.html").exists():
    tags.add("viewer")
