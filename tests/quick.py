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
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BIN = Path(sys.executable).parent

# Tests of the crate `chaindrive` that are about scenes; other rooms are tested by all of them.
SCENE = ["catalogue", "scene", "wrong_", "resolved", "robust_scenes", "describe", "requests"]

# Tests of Python beside that of a module's own name: what every change of the package must keep.
ALWAYS = ["test_api.py", "test_starting.py"]

LINTS = ["cargo", "clippy", "--quiet", "--workspace", "--", "-D", "warnings"]

# A small drive, and how it is run by a command that is not optimised, which is built in seconds.
# Its kernels on wide registers would take more stack than a thread has.
DRIVE = ["run", "marine_two_sprockets", "--until", "2 ms", "--no-error", "-q"]
SMALL_DRIVE = [
    "env",
    "CHAINDRIVE_INSTRUCTION_SET=sse2",
    "cargo",
    "run",
    "--quiet",
    "-p",
    "chaindrive-cli",
    "--bin",
    "chaindrive",
    "--",
    *DRIVE,
]


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
    # Lints and the small drive have a profile, and with it a folder and a lock of their own: they
    # go beside the tests. Changed crates are looked at, and all that depend on them.
    with ThreadPoolExecutor(1) as beside:
        others = [beside.submit(told, *it) for it in (LINTS, SMALL_DRIVE)] if rust else []
        for crate in crates:
            if crate != "python":
                test_crate(crate, [path for path in changed if path.startswith(f"crates/{crate}/")])
        for other in others:
            report(*other.result())
    if python:
        step(BIN / "mypy")
        test_python(python)
    if not rust:
        install()
        step(BIN / "python", "-m", "chaindrive", *DRIVE)


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
    command = ["cargo", "test", "--profile", "quick", "--quiet", *selected]
    rooms = (
        "crates/chaindrive/src/scene/",
        "crates/chaindrive/src/catalogue/",
        "crates/chaindrive/scenes/",
    )
    if crate == "chaindrive" and all(path.startswith(rooms) for path in changed):
        step(*command, "--test", "it", "--", *SCENE)
    else:
        # Narrower registers are for `make test`.
        step(*command, "--tests", "--", "--skip", "narrower_registers")


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


def install() -> None:
    """Build and install the package, as far as it is not."""
    step("make", "--quiet", "setup")


def step(*command: object) -> None:
    """Run a command, and say how long it took; the first one that fails ends it all."""
    report(*told(*command, capture=False))


def told(*command: object, capture: bool = True) -> tuple[str, float, int, str]:
    """Run a command: what it was, how long it took, its exit code, and what it said if captured."""
    words = [str(word) for word in command]
    start = time.perf_counter()
    pipe = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT} if capture else {}
    done = subprocess.run(words, cwd=ROOT, check=False, text=True, **pipe)
    shown = " ".join(word.removeprefix(f"{ROOT}/") for word in words)
    return shown, time.perf_counter() - start, done.returncode, done.stdout or ""


def report(shown: str, seconds: float, code: int, said: str) -> None:
    """Print a line for a command that was run; the first one that failed ends it all."""
    print(f"{said}{seconds:6.1f} s  {shown}", flush=True)
    if code:
        sys.exit(code)


main()
