"""Try the wheel of a folder in a fresh environment, the way a user gets it.

    python tests/wheels/fresh.py dist

Makes a virtual environment, installs the wheel with its extras, imports it, simulates a preset and
calls the command. Needs nothing but Python; what the wheel depends on comes from the index of pip.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import venv
import zipfile
from pathlib import Path

SCRIPT = """
import sys
import chaindrive as cd

assert "site-packages" in cd.__file__, cd.__file__
run = cd.simulate(cd.scenes.industrial_16b(), until=0.01, every=1e-3, record="span_tension")
tension = run["span_tension"]
assert tension.shape[0] == 11 and bool((tension > 0).any()), tension
unit = cd.scenes.industrial_16b().fmu("drive.fmu", run=False)
assert unit.stat().st_size > 1_000_000, unit
print(f"chaindrive {cd.__version__} on Python {sys.version.split()[0]}: simulates")
"""


def newest(folder: Path) -> Path:
    """Return the wheel of a folder that was built last."""
    wheels = sorted(folder.glob("chaindrive-*.whl"), key=lambda wheel: wheel.stat().st_mtime)
    if not wheels:
        sys.exit(f"{folder} has no wheel of chaindrive")
    return wheels[-1]


def traces(wheel: Path) -> list[str]:
    """Return files of a wheel that name a folder of this machine, where it was built."""
    here = Path(__file__).resolve().parent.parent.parent
    cargo = os.environ.get("CARGO_HOME", Path.home() / ".cargo")
    folders = [str(folder).encode() for folder in (here, cargo)]
    with zipfile.ZipFile(wheel) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    return [name for name, held in files.items() if any(it in held for it in folders)]


def stores(wheel: Path) -> list[str]:
    """Return libraries of units in a wheel that were built with stores, which no unit writes."""
    with zipfile.ZipFile(wheel) as archive:
        libraries = [name for name in archive.namelist() if "chaindrive_fmu" in name]
        # The list of licences, which may be in it, has no hyphen there.
        return [name for name in libraries if re.search(rb"zarrs-\d", archive.read(name))]


def main() -> None:
    parser = argparse.ArgumentParser(description="Try a wheel in a fresh environment.")
    parser.add_argument("folder", type=Path, help="folder with the wheel")
    wheel = newest(parser.parse_args().folder).resolve()
    # Elsewhere nobody has tried it.
    if sys.platform == "linux" and (found := traces(wheel)):
        sys.exit(f"{wheel.name}: paths of this machine are in {', '.join(found)}")
    if found := stores(wheel):
        sys.exit(f"{', '.join(found)} has stores: build it by itself, `-p chaindrive-fmu` alone")
    with zipfile.ZipFile(wheel) as archive:
        if not any(name.endswith("third-party.txt") for name in archive.namelist()):
            sys.exit(f"{wheel.name} has no licences of the libraries in it")
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        venv.create(place / "env", with_pip=True)
        scripts = place / "env" / ("Scripts" if os.name == "nt" else "bin")
        python = scripts / "python"
        # Nothing of the sources may be found by chance.
        clean = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}

        def call(*command: str | Path) -> str:
            told = subprocess.run(
                [str(part) for part in command],
                cwd=place,
                env=clean,
                check=True,
                stdout=subprocess.PIPE,
                text=True,
            )
            return told.stdout.strip()

        call(python, "-m", "pip", "install", "--quiet", f"{wheel}[plot,zarr]")
        print(call(python, "-c", SCRIPT))
        command = scripts / "chaindrive"
        print(call(command, "--version"))
        call(command, "run", "industrial_16b", "--until", "10ms", "-o", "out.zarr", "-q")
        assert (place / "out.zarr").is_dir()
        print(f"{wheel.name}: imported, simulated, and its command wrote a result")


if __name__ == "__main__":
    main()
