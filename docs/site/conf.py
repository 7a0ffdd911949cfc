# SPDX-License-Identifier: Apache-2.0
"""The documentation as a site: scripts/site.sh copies what it is made of, and runs Sphinx."""
project = "gcdt"
author = "the gcdt developers"
copyright = author  # Sphinx wants the name
extensions = ["myst_parser", "breathe"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
breathe_projects = {"gcdt": "../xml"}
breathe_default_project = "gcdt"
breathe_domain_by_extension = {"h": "c", "hpp": "cpp"}
breathe_show_define_initializer = True
primary_domain = None
highlight_language = "none"
myst_heading_anchors = 4
html_theme = "alabaster"
html_theme_options = {"description": "Exact constrained Delaunay triangulation", "page_width": "1080px"}
html_show_sphinx = False
html_show_copyright = False
