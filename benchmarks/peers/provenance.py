"""Machine, versions, commit and date of a measurement."""

import datetime
import hashlib
import importlib.metadata
import os
import platform
import subprocess
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("chaindrive", "numba", "numpy", "scipy", "exudyn")


def processor() -> str:
    """Return the name of the processor as the system gives it."""
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


def commit() -> str:
    """Return the commit of the sources, and whether files differ from it."""
    command = ["git", "describe", "--always", "--dirty", "--abbrev=9", "--exclude=*"]
    try:
        answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "none, the sources are in no repository"
    return answer.stdout.strip().replace("-dirty", " with changes")


def library() -> str:
    """Return a hash of the compiled library, which may be older than the sources."""
    from chaindrive import _core

    return hashlib.sha256(Path(_core.__file__).read_bytes()).hexdigest()[:12]


def version(package: str) -> str | None:
    """Return the version of a package that is installed."""
    if package == "chaindrive":
        from chaindrive import __version__

        return __version__
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def machine() -> dict[str, Any]:
    """Return where, with what and when a measurement is made."""
    return {
        "processor": processor(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {package: version(package) for package in PACKAGES},
        "library": library(),
        "commit": commit(),
        "date": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
    }


def told(about: dict[str, Any]) -> str:
    """Put machine, versions, commit and date in words."""
    versions = ", ".join(
        f"{package} {number}" for package, number in about["versions"].items() if number
    )
    return (
        f"{about['processor']}, {about['cores']} cores, {about['system']}, "
        f"Python {about['python']}; {versions}; library {about['library']}, "
        f"commit {about['commit']}; {about['date']}"
    )


def dated(machine: dict[str, Any]) -> str:
    """Say in one line of which version and day a measurement is; it stands first on its page."""
    version, day = machine["versions"]["chaindrive"], machine["date"][:10]
    return f"Measured with chaindrive {version} on {day}; not repeated since."
