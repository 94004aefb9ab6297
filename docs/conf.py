"""Configuration of the documentation site: `make site` builds it."""

import os
import sys
from pathlib import Path

import chaindrive

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "_ext"))

project = "chaindrive"
author = "The chaindrive developers"
project_copyright = author
version = release = chaindrive.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
    "lab_link",
    "mathml",
    "scene_reference",
    "validation_cases",
]
# The description of the package is for its index.
exclude_patterns = ["_ext", "_static", "package.md"]
# Two hyphens between words are a dash; quotation marks stay as they are.
smartquotes_action = "D"

# Tutorials are run while the site is built, and an error in one fails the build. CHAINDRIVE_PAGES
# can be "off", for whoever writes text, and "cache", which runs what was edited.
nb_execution_mode = os.environ.get("CHAINDRIVE_PAGES", "force")
if nb_execution_mode == "off":
    suppress_warnings = ["myst-nb.lexer"]  # the language is known from running them
nb_execution_raise_on_error = True
nb_execution_timeout = 300
# Tutorials write their files beside nothing of ours.
nb_execution_in_temp = True
# The gallery is drawn by an example; pages are run elsewhere, and inherit this.
os.environ["CHAINDRIVE_EXAMPLES"] = str(HERE.parent / "examples")
# Tutorials link to the lab on their drives.
os.environ["CHAINDRIVE_SITE"] = str(HERE / "_ext")
# Pictures have the colours of the scheme, seen on light and dark pages alike.
os.environ["MATPLOTLIBRC"] = str(HERE / "matplotlibrc")
nb_merge_streams = True

# In docstrings, single backticks stand about names.
default_role = "code"

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
myst_url_schemes = ["http", "https", "mailto"]

autodoc_typehints = "none"  # they stand in the signature and in the docstring
autodoc_member_order = "bysource"
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_rtype = False

html_math_renderer = "mathml"
html_theme = "furo"
html_title = f"chaindrive {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {"navigation_with_keys": True}
pygments_style = "friendly"
pygments_dark_style = "monokai"
copybutton_exclude = ".linenos, .gp, .go"

# Pages that stand elsewhere in the repository, and the page of the site that includes each.
ELSEWHERE = {
    "../tests/validation/README.md": "validation-cases.md",
    "../benchmarks/peers/README.md": "peers.md",
}


def lead_to_pages(app, docname, source):
    """Let links to pages elsewhere lead to the pages that include them."""
    for place, page in ELSEWHERE.items():
        source[0] = source[0].replace(f"]({place}", f"]({page}")


def setup(app):
    app.connect("source-read", lead_to_pages)
