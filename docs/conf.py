"""The documentation: ``sphinx-build -W docs build/docs``."""

from __future__ import annotations

import os
import sys
from importlib.metadata import version as installed
from pathlib import Path

from docutils import nodes

sys.path.insert(0, str(Path(__file__).parent))
# The gallery's scenes are small: threads would cost more than they bring.
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

project = "cmverify"
author = "The cmverify developers"
version = release = installed("cmverify")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx_gallery.gen_gallery",
    "numpydoc",
    "audit",
    "commands",
    "places",
]
exclude_patterns = ["build", "gallery/README.rst", "**/README.md"]
source_suffix = {".rst": "restructuredtext", ".md": "markdown"}
myst_enable_extensions = ["dollarmath", "colon_fence", "html_image", "deflist"]
myst_heading_anchors = 3

autosummary_generate = True
autodoc_typehints = "none"
# Members are told of in their class's docstring; a page for each would say less.
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False

sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery",
    "filename_pattern": r"/plot_",
    "abort_on_example_error": True,
    "show_memory": False,
    "download_all_examples": False,
    "remove_config_comments": True,
    "within_subsection_order": "FileNameSortKey",
}

html_theme = "pydata_sphinx_theme"
html_title = "cmverify"
html_static_path = ["static"]
html_css_files = ["tables.css"]
#: Pages without a section of their own leave its place to their tables.
html_sidebars = {
    page: []
    for page in (
        "results",
        "validity",
        "errata",
        "architecture",
        "commands",
        "contributing",
        "changelog",
    )
}
html_theme_options = {"show_toc_level": 2, "navigation_with_keys": True}
html_copy_source = False
html_show_sourcelink = False


def _absolute_values(app, what, name, obj, options, lines):
    """|ξ| in a docstring is an absolute value, not a substitution."""
    for number, line in enumerate(lines):
        if "|" in line and not line.lstrip().startswith(("+", "| ", ">>>", "...")):
            parts = line.split("`")
            parts[::2] = [part.replace("|", r"\|") for part in parts[::2]]
            lines[number] = "`".join(parts)


def _figures_stay_whole(app, doctree, name):
    """A cell of one figure, such as 1.1e-4, has a class: browsers would break it at its sign."""
    for cell in doctree.findall(nodes.entry):
        if " " not in cell.astext().strip() and any(c.isdigit() for c in cell.astext()):
            cell["classes"].append("figure-cell")


def setup(app):
    app.connect("doctree-resolved", _figures_stay_whole)
    # After numpydoc has made sections of the docstring.
    app.connect("autodoc-process-docstring", _absolute_values, priority=900)
