"""Licences of the libraries in what ships, as one file for the wheel, the sources and units.

    python tests/licences.py

Asks cargo which libraries are compiled into the wheel, the command and the library of units, on any
system, and takes from the sources of each the text of one licence that it offers, with its notices
and those of the C code within it. Equal texts stand once.
"""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent
FILE = ROOT / "crates" / "couple" / "third-party.txt"
SHIPPED = {"chaindrive-python", "chaindrive-cli", "chaindrive-fmu"}

HEAD = """\
Libraries that are compiled into chaindrive, with their licences.
Of several that a library offers, one is taken. Written by tests/licences.py.

"""
# Of several licences the shortest text: all of them ask for the same, that it is handed on.
_PREFERRED = ("MIT", "BSL", "ZLIB", "BSD", "UNICODE", "APACHE", "LICENSE", "LICENCE", "COPYING")
_TEXTS = re.compile(r"(UN)?LICEN[SC]E|COPYING|COPYRIGHT|NOTICE", re.IGNORECASE)
# The text for sources without one.
_MIT = """\
MIT License

Copyright (c) {authors}

Permission is hereby granted, free of charge, to any person obtaining a copy of this software
and associated documentation files (the "Software"), to deal in the Software without
restriction, including without limitation the rights to use, copy, modify, merge, publish,
distribute, sublicense, and/or sell copies of the Software, and to permit persons to whom the
Software is furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in all copies or
substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING
BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND
NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM,
DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE.
"""


def packages(*options: str) -> list[dict[str, Any]]:
    """Return the libraries of others that are compiled into what ships, as cargo describes them."""
    command = ["cargo", "metadata", "--format-version", "1", "--locked", *options]
    told = json.loads(subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)
    known = {package["id"]: package for package in told["packages"]}
    needs = {
        node["id"]: [
            needed["pkg"]
            for needed in node["deps"]
            if any(kind["kind"] is None for kind in needed["dep_kinds"])
        ]
        for node in told["resolve"]["nodes"]
    }
    found: set[str] = set()
    open_ends = [key for key, package in known.items() if package["name"] in SHIPPED]
    while open_ends:
        key = open_ends.pop()
        if key not in found:
            found.add(key)
            open_ends += needs[key]
    listed = [known[key] for key in found if known[key]["source"]]
    return sorted(listed, key=lambda package: (package["name"], package["version"]))


def texts(package: dict[str, Any], lent: str) -> list[str]:
    """Return the licence taken of a library, its notices, and the licences of C code within."""
    folder = Path(package["manifest_path"]).parent
    found = [it for it in folder.rglob("*") if it.is_file() and _TEXTS.match(it.name)]
    own = [it for it in found if it.parent == folder]
    notices = [it for it in own if it.name.upper().startswith(("NOTICE", "COPYRIGHT"))]
    licences = sorted((it for it in own if it not in notices), key=_rank)
    # Folders of C code, which is compiled in. The GPL beside a licence is another choice; tests and
    # samples are not compiled.
    code = [it for it in found if it.parent != folder and it.name == "LICENSE"]
    within = [it for it in code if any((it.parent / name).is_dir() for name in ("lib", "include"))]
    taken = [it.read_text(encoding="utf-8", errors="replace") for it in notices + sorted(within)]
    if licences:
        # Where more than one binds, all of them do.
        number = len(licences) if " AND " in package["license"] else 1
        taken += [it.read_text(encoding="utf-8", errors="replace") for it in licences[:number]]
    elif "MIT" in package["license"]:
        authors = ", ".join(package["authors"]) or f"the authors of {package['name']}"
        taken.append(_MIT.format(authors=re.sub(r" <[^>]*>", "", authors)))
    elif "Apache-2.0" in package["license"]:
        taken.append(lent)
    else:
        sys.exit(f"{package['name']}: there is no text of {package['license']}: {folder}")
    return ["\n".join(line.rstrip() for line in text.strip().splitlines()) for text in taken]


def _rank(file: Path) -> tuple[int, str]:
    name = file.name.upper()
    ranks = (rank for rank, word in enumerate(_PREFERRED) if word in name.removeprefix("LICENSE-"))
    return next(ranks, len(_PREFERRED)), name


def named() -> list[str]:
    """Return names and versions of the libraries in the file."""
    lines = FILE.read_text(encoding="utf-8").splitlines()
    found = (re.fullmatch(r"([\w\-]+ \d[\w.+\-]*) \(.*\)", line) for line in lines)
    return [it[1] for it in found if it]


def main() -> None:
    """Write the file."""
    apache = (ROOT / "LICENSE-APACHE").read_text(encoding="utf-8")
    standard = _MIT.format(authors="The Rust Project Developers").strip()
    holders = {standard: ["The standard library of Rust (MIT OR Apache-2.0)"]}
    for package in packages():
        name = f"{package['name']} {package['version']} ({package['license']})"
        for text in texts(package, apache):
            names = holders.setdefault(text, [])
            if name not in names:
                names.append(name)
    rule = "=" * 80
    parts = ["\n".join([rule, *names, rule, "", text, ""]) for text, names in holders.items()]
    FILE.write_text(HEAD + "\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
