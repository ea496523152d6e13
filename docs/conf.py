"""Sphinx configuration. Nothing here needs a network: MathJax is loaded by the reader's browser."""

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
