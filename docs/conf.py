"""The site: ``make site``."""

import os
import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "extension"))

project = "forcefeel"
author = "the forcefeel project"
release = tomllib.loads((HERE.parent / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]["version"]
project_copyright = f"{author}, Apache-2.0"

extensions = [
    "manual",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
]
exclude_patterns = ["parts", "demo"]
nitpicky = True

# Manual: how much is run. The tests build without both, `make site PICTURES=0` without pictures.
manual_pictures = os.environ.get("PICTURES", "1") != "0"

# MyST
myst_enable_extensions = ["dollarmath", "deflist", "colon_fence", "substitution"]
myst_heading_anchors = 3

# Python
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
# Other people's types, and types that are no public names, are named and not linked.
nitpick_ignore_regex = [
    (r"py:.*", r"(?!forcefeel\.).*"),
    (r"py:.*", r"forcefeel\..*\..*"),
]

# Look
html_theme = "furo"
html_title = f"forcefeel {release}"
html_static_path = ["style", "demo"]
html_css_files = ["manual.css"]
html_copy_source = False
html_show_sphinx = False
pygments_style = "default"
pygments_dark_style = "monokai"
copybutton_prompt_text = "$ "
copybutton_exclude = ".linenos, .gp"
html_math_renderer = "pictures"
