"""Checks what a change needs: format, lints, types, the tests of what changed, one small drive.

What changed is told by git: against the revision in `--base` (the last commit unless given), files
that git does not know yet included. Crates that depend on a changed one are checked and not tested;
`make test` tests them.
"""

import argparse
import subprocess
import sys
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BIN = Path(sys.executable).parent

# Tests of the crate `chaindrive` that are about scenes; other rooms are tested by all of them.
SCENE = ["catalogue", "scene", "wrong_", "resolved", "robust_scenes", "describe", "requests"]

# Tests of Python beside that of a module's own name: what every change of the package must keep.
ALWAYS = ["test_api.py", "test_starting.py"]


def main() -> None:
    """Run all that a change needs, and stop at the first failure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--base", default="HEAD", help="revision that the change is measured from")
    changed = changed_files(parser.parse_args().base)
    crates = sorted({path.split("/")[1] for path in changed if path.startswith("crates/")})
    rust = bool(crates) or any(path.startswith("Cargo") for path in changed)
    python = [path for path in changed if path.endswith((".py", ".pyi"))]

    step("cargo", "fmt", "--all", "--check")
    step(BIN / "ruff", "format", "--check", "--quiet", ".")
    step(BIN / "ruff", "check", "--quiet", ".")
    if python:
        step(BIN / "mypy")
    if rust:
        # Changed crates and all that depend on them: the others are fresh.
        step("cargo", "clippy", "--release", "--quiet", "--workspace", "--", "-D", "warnings")
    for crate in crates:
        if crate != "python":
            test_crate(crate, [path for path in changed if path.startswith(f"crates/{crate}/")])
    if python:
        test_python(python)
    smoke(rust=rust)


def changed_files(base: str) -> list[str]:
    """List what differs from a revision, by git; what was removed is not there to be tested."""
    differing = ["git", "diff", "--name-only", "--diff-filter=d", base]
    unknown = ["git", "ls-files", "--others", "--exclude-standard"]
    told = [subprocess.check_output(it, cwd=ROOT, text=True) for it in (differing, unknown)]
    return sorted(set("".join(told).split("\n")) - {""})


def test_crate(crate: str, changed: list[str]) -> None:
    """Test a crate; of the large one, the room that changed."""
    manifest = tomllib.loads((ROOT / "crates" / crate / "Cargo.toml").read_text())
    # With the bindings, of which nothing is built, libraries have the features that they have in
    # `make test` and in the wheel.
    selected = ["-p", manifest["package"]["name"], "-p", "chaindrive-python"]
    command = ["cargo", "test", "--release", "--quiet", *selected]
    rooms = (
        "crates/chaindrive/src/scene/",
        "crates/chaindrive/src/catalogue/",
        "crates/chaindrive/scenes/",
    )
    if crate == "chaindrive" and all(path.startswith(rooms) for path in changed):
        step(*command, "--test", "it", "--", *SCENE)
    else:
        step(*command, "--tests")


def test_python(changed: list[str]) -> None:
    """Test changed tests, and those that bear the name of a changed module."""
    tests = ROOT / "tests" / "python"
    chosen = {tests / name for name in ALWAYS}
    for path in changed:
        name = Path(path).name
        if name.startswith("test_"):
            chosen.add(ROOT / path)
        chosen.update(tests.glob(f"test_{Path(path).stem}*.py"))
    install()
    step(BIN / "pytest", *sorted(chosen))


def smoke(*, rust: bool) -> None:
    """Simulate a small drive by what there is now."""
    drive = ["run", "marine_two_sprockets", "--until", "2 ms", "--no-error", "-q"]
    if rust:
        # Hardly optimised, which is built in seconds.
        step("cargo", "run", "--quiet", "-p", "chaindrive-cli", "--bin", "chaindrive", "--", *drive)
    else:
        install()
        step(BIN / "python", "-m", "chaindrive", *drive)


def install() -> None:
    """Build and install the package, as far as it is not."""
    step("make", "--quiet", "setup")


def step(*command: object) -> None:
    """Run a command, and say how long it took; the first one that fails ends it all."""
    words = [str(word) for word in command]
    start = time.perf_counter()
    code = subprocess.run(words, cwd=ROOT, check=False).returncode
    shown = " ".join(word.removeprefix(f"{ROOT}/") for word in words)
    print(f"{time.perf_counter() - start:6.1f} s  {shown}", flush=True)
    if code:
        sys.exit(code)


main()
