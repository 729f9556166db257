"""Sphinx's configuration of the docs site. `make docs` builds it from the Markdown of the repository, without network.

Sources are the pages of docs/ and those at the top of the repository: so a relative link leads to the same page here and there.
"""

import sys
from pathlib import Path

# the extensions import avatarsim, reports and one another from the checkout
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import avatarsim

project = "avatarsim"
version = release = avatarsim.__version__
project_copyright = "avatarsim's authors, Apache-2.0"

extensions = [
    "sphinx.ext.autodoc", "myst_parser",
    "docs.extensions.docstrings", "docs.extensions.filled", "docs.extensions.formulas", "docs.extensions.no_request",
    "docs.extensions.public_names", "docs.extensions.shared_pages",
]

root_doc = "docs/index"
include_patterns = ["docs/*.md", "README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md"]
# Sphinx walks through all folders that are not named here.
exclude_patterns = [
    ".*", "*.egg-info", "avatarsim", "benchmarks", "build", "dist", "docs/extensions", "docs/templates", "reference", "reports",
    "scenarios", "tests",
]

# Every name that is referred to has to be documented, or to be another package's.
nitpicky = True
nitpick_ignore_regex = [("py:.*", r"(?!avatarsim\.).*")]

myst_enable_extensions = ["dollarmath"]
myst_dmath_allow_space = False
myst_heading_anchors = 4

autodoc_typehints = "signature"
maximum_signature_line_length = 100

# Docstrings are plain text, and quote commands as they are typed.
smartquotes = False

html_theme = "furo"
html_title = "avatarsim"
html_math_renderer = "mathml"
html_copy_source = False
html_show_sourcelink = False
# The pages lie in docs/ of the output, as their sources do: a request for the folder itself is led there.
templates_path = ["templates"]
html_additional_pages = {"index": "to_the_first_page.html"}
