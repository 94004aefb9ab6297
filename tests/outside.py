"""Builds and tests examples/own_laws outside of the workspace, as a program of somebody else.

In the workspace it shares libraries, profiles and the lock with everything else; a stranger has
none of them.
"""

import json
import shutil
import subprocess
import tempfile
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
EXAMPLE = ROOT / "examples" / "own_laws"
SECTIONS = ("dependencies", "dev-dependencies", "build-dependencies")


def standing_alone(value: Any, of_workspace: Any, base: Path) -> Any:
    """Return what a key says without the workspace: its value there, and whole paths."""
    if not isinstance(value, dict):
        return value
    told = {key: it for key, it in value.items() if key != "workspace"}
    if value.get("workspace"):
        if not isinstance(of_workspace, dict):
            return {"version": of_workspace, **told} if told else of_workspace
        told, base = {**of_workspace, **told}, ROOT
    if "path" in told:
        told["path"] = (base / told["path"]).resolve().as_posix()
    return told


def written(value: Any) -> str:
    """Write a value as TOML has it."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {written(it)}" for key, it in value.items()) + " }"
    return json.dumps(value)


def manifest() -> str:
    """Return the manifest of the example for a folder anywhere."""
    own = tomllib.loads((EXAMPLE / "Cargo.toml").read_text(encoding="utf-8"))
    workspace = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]
    inherited = {"package": workspace["package"]}
    inherited |= dict.fromkeys(SECTIONS, workspace["dependencies"])
    lines = []
    for section in ("package", *SECTIONS):
        lines.append(f"[{section}]")
        for key, value in own.get(section, {}).items():
            alone = standing_alone(value, inherited[section].get(key), EXAMPLE)
            lines.append(f"{key} = {written(alone)}")
    return "\n".join([*lines, "[workspace]", ""])


def main() -> None:
    """Copy the example, and run its tests and its command there."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "own_laws"
        shutil.copytree(EXAMPLE, place, ignore=shutil.ignore_patterns("target", "Cargo.lock"))
        (place / "Cargo.toml").write_text(manifest(), encoding="utf-8")
        for command in (["test"], ["run", "--", "scenes"]):
            cargo = ["cargo", command[0], "--release", "--quiet", *command[1:]]
            subprocess.run(cargo, cwd=place, check=True)


if __name__ == "__main__":
    main()
