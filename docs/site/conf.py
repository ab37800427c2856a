"""Sphinx: how scripts/site_pages.py's pages become the site."""

project = "flatspeckle"
extensions = ["myst_parser"]
myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence"]
myst_disable_syntax = ["html_inline"]  # "<u u'>" is a mean; blocks, as of the gallery, stay
root_doc = "index"
html_theme = "furo"
html_title = "flatspeckle"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
pygments_style = "friendly"
