"""Sphinx's configuration of the site. build_site.py stages its sources and runs Sphinx."""

import ballpiston
from sphinx.ext.napoleon.docstring import GoogleDocstring

project = "ballpiston"
author = copyright = "the ballpiston developers"
release = ballpiston.__version__
extensions = ["breathe", "myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
html_title = f"ballpiston {release}"
html_copy_source = False
html_static_path = ["style.css"]
html_css_files = ["style.css"]
highlight_language = "text"  # blocks without a language: shell with its output, and formulas
default_role = "code"
toc_object_entries_show_parents = "hide"
myst_heading_anchors = 4
breathe_projects = {"client": "../doxygen/xml"}
breathe_default_project = "client"
breathe_show_include = False
autodoc_member_order = "bysource"

# Napoleon would read the text of a property before its first colon as a type.
GoogleDocstring._parse_attribute_docstring = GoogleDocstring._consume_to_end
