"""Documentation runs: blocks of Python in the README and the guides, and examples in docstrings."""

import doctest
import importlib.util
import pkgutil
import re
import sys
import tomllib
from pathlib import Path

import pytest

import chaindrive as cd

ROOT = Path(__file__).resolve().parents[2]
FILES = [
    file for file in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))] if file.exists()
]
# Packages that nothing but the blocks of a page take.
TAKES = {
    "assumptions.md": ["SALib"],
    "sweep-recipes.md": ["SALib", "optuna", "scipy"],
    "command-line.md": ["pyarrow"],
}
# Lengths of runs that pages are read with, and those that show as much of whether they run.
SHORTER = {
    "README.md": {"until=0.5": "until=0.02, run_in=0"},
    "exchange.md": {"until=5e-3": "until=5e-3, run_in=0"},
    "precision.md": {"until=0.05": "until=5e-3, run_in=0"},
    "replay.md": {"until=5e-3": "until=5e-3, run_in=0"},
    "spectra-and-modes.md": {
        "until=3": 'until=1.5, method="verlet"',
        "until=0.4, run_in=0.2": "until=0.15, run_in=0",
    },
    "sweeps.md": {'"10 ms"': '"0 s"', "-14.0, 20)": "-14.0, 4)", "== 20": "== 4"},
    "measured.md": {
        "until=0.4, every=2e-4": "until=0.25, every=2e-4",
        "    until=0.2,\n": "    until=0.06,\n",
        '    until=0.06,\n    store="fit",\n': "    until=0.06,\n    starts=1,\n",
        "until=0.4, every=5e-5": "until=0.25, every=5e-5",
        'cd.report(run, "report.html", comparison=found)': "pass",
        "drive = cd.scenes.industrial_16b()": "drive = cd.scenes.industrial_16b()"
        '.replace({"run.run_in": "50 ms"})',
        "    until=0.1,\n": "    until=0.02,\n    phases=(0.1, 0.6),\n",
    },
    "assumptions.md": {'"20 ms"': "0", "until=0.02": "until=2e-3", "until=0.01": "until=1e-3"},
    "wear-and-fatigue.md": {"run_in=0.2, until=0.1": "run_in=0.05, until=0.1"},
}
BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
TOML = re.compile(r"^```toml\n(.*?)^```", re.MULTILINE | re.DOTALL)
MODULES = [
    "chaindrive",
    *(module.name for module in pkgutil.walk_packages(cd.__path__, "chaindrive.")),
]


@pytest.fixture(autouse=True)
def figures_closed():
    """No test leaves a figure to the next: matplotlib warns of many."""
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_python_blocks_run(file, tmp_path, monkeypatch):
    """The blocks of one file follow each other in one namespace, in an empty folder."""
    for package in TAKES.get(file.name, []):
        pytest.importorskip(package)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    text = file.read_text(encoding="utf-8")
    for number, block in enumerate(TOML.findall(text)):
        if "[chain]" in block:
            drive = cd.Drive.from_toml(block, name=f"{file.name}, block {number}")
            (tmp_path / "my_engine.toml").write_text(drive.text, encoding="utf-8")
    for long, short in SHORTER.get(file.name, {}).items():
        assert long in text, long
        text = text.replace(long, short)
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


def test_description_of_the_package_stands_alone():
    """A package index shows it without the files beside it, and the project has no address yet."""
    text = (ROOT / "docs" / "package.md").read_text(encoding="utf-8")
    targets = re.findall(r"\]\(([^)]*)\)", text)
    assert all(target.startswith("https://") for target in targets), targets


@pytest.mark.parametrize("page", ["README.md", "docs/start.md", "docs/package.md"])
def test_every_extra_is_explained(page):
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    text = (ROOT / page).read_text(encoding="utf-8")
    told = set(re.findall(r"`([a-z-]+)`", "".join(re.findall(r"^\|.*\|.*\|.*\|$", text, re.M))))
    assert set(extras["optional-dependencies"]) <= told


def sections(page):
    """Return the names by which links ask for the sections of a page."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    heads = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", "\n".join(re.findall(r"^#+ .*$", text, re.M)))
    plain = [it.lstrip("# ") for it in heads.splitlines()]
    marked = re.findall(r"^\(([\w-]+)\)=$", text, re.M)
    return {re.sub(r"[^\w -]", "", it.lower()).replace(" ", "-") for it in plain} | set(marked)


def test_pages_link_to_what_exists():
    """Links lead to files of the repository, and to sections that these have."""
    pages = [ROOT / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md")]
    dead = []
    for page in [*pages, *(ROOT / "docs").rglob("*.md")]:
        if page.parent.name == "scene":
            continue  # made with the site, which checks its own links
        for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
            place, _, section = target.partition("#")
            if "://" in place or "/scene/" in f"/{place}" or section.startswith("preset-"):
                continue  # elsewhere, or made with the site
            file = page.parent / place if place else page
            known = file.exists()
            if section and known and file.suffix == ".md":
                known = section in sections(file)
            if not known:
                dead.append(f"{page.relative_to(ROOT)}: {target}")
    assert not dead


def test_tables_of_the_contact_laws_are_current():
    """The tables in docs/contact-laws.md are what examples/contact_laws.py computes now."""
    place = ROOT / "examples" / "contact_laws.py"
    spec = importlib.util.spec_from_file_location("contact_laws", place)
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    text = (ROOT / "docs" / "contact-laws.md").read_text(encoding="utf-8")
    for table in [script.against_johnson(), script.against_the_solution(), script.restitutions()]:
        assert table in text, "run python examples/contact_laws.py"
