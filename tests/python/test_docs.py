"""Documentation runs: blocks of Python in the README and the guides, and examples in docstrings."""

import doctest
import importlib.util
import pkgutil
import re
from pathlib import Path

import pytest

import chaindrive as cd

ROOT = Path(__file__).resolve().parents[2]
FILES = [
    file for file in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))] if file.exists()
]
BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
TOML = re.compile(r"^```toml\n(.*?)^```", re.MULTILINE | re.DOTALL)
MODULES = [
    "chaindrive",
    *(module.name for module in pkgutil.walk_packages(cd.__path__, "chaindrive.")),
]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_python_blocks_run(file, tmp_path, monkeypatch):
    """The blocks of one file follow each other in one namespace, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    text = file.read_text(encoding="utf-8")
    for number, block in enumerate(TOML.findall(text)):
        if "[chain]" in block:
            drive = cd.Drive.from_toml(block, name=f"{file.name}, block {number}")
            (tmp_path / "my_engine.toml").write_text(drive.text, encoding="utf-8")
    namespace = {}
    for block in BLOCK.findall(text):
        exec(compile(block, file.name, "exec"), namespace)


@pytest.mark.parametrize(
    "name", [name for name in MODULES if not name.endswith(("__main__", "_core"))]
)
def test_docstring_examples(name):
    failed, _ = doctest.testmod(
        importlib.import_module(name), optionflags=doctest.NORMALIZE_WHITESPACE
    )
    assert failed == 0


def test_tables_of_the_contact_laws_are_current():
    """The tables in docs/contact-laws.md are what examples/contact_laws.py computes now."""
    place = ROOT / "examples" / "contact_laws.py"
    spec = importlib.util.spec_from_file_location("contact_laws", place)
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    text = (ROOT / "docs" / "contact-laws.md").read_text(encoding="utf-8")
    for table in [script.against_johnson(), script.against_the_solution(), script.restitutions()]:
        assert table in text, "run python examples/contact_laws.py"
