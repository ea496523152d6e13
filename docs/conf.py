"""Sphinx configuration. Nothing here needs a network, nor do readers: MathJax is among the pages.

It is docs/_static/mathjax/tex-svg-full.js of the npm package mathjax 3.2.2, as it is, under the licence beside it.
"""

from importlib.metadata import version as installed_version
from pathlib import Path

from mckibben.spec.reference import reference_markdown

project = "mckibben"
author = "The mckibben developers"
copyright = "2026 The mckibben developers"
release = version = installed_version("mckibben")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
]
exclude_patterns = ["_build"]
root_doc = "index"
html_static_path = ["_static"]
mathjax_path = "mathjax/tex-svg-full.js"

myst_enable_extensions = ["amsmath", "dollarmath", "deflist"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"

html_theme = "furo"
html_title = f"mckibben {release}"

# The page of the specification's fields says what the code declares. Written only when it changed, so that an
# unchanged page is not rebuilt.
page = Path(__file__).parent / "reference" / "spec.md"
intro = """# Fields

What a muscle and a test can say, in Python and in a file. A number is text with its unit, a pint quantity, or SI.
"""
text = f"{intro}\n{reference_markdown()}"
if not page.exists() or page.read_text(encoding="utf-8") != text:
    page.write_text(text, encoding="utf-8")
