"""Pages about every key of a scene file, made of the JSON Schema that `chaindrive schema` prints.

A page is a top-level key with all tables below it that no earlier page has. Examples are taken from
the presets, with the name of the preset; where none has a key, the schema gives one.
"""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

import chaindrive as cd
from preset_examples import Examples

Node = dict[str, Any]

# Shared tables stand on the page of the key that comes first here.
ORDER = [
    "route",
    "sprockets",
    "guides",
    "tensioners",
    "contact",
    "chain",
    "chains",
    "shafts",
    "couplings",
    "gears",
    "run",
]
INDEX = """\
# Scene files

A scene is a TOML file. Every key that it can have is described here as the program itself describes
it: these pages are made of what `chaindrive schema` prints and `chaindrive.schema()` returns.
Numbers are in SI units; texts carry a unit, such as `"88.9 mm"`, whose dimension is checked.

`chaindrive check my.toml` names everything that is wrong with a file at once. An editor that knows
TOML completes keys when the first line is `#:schema chaindrive.schema.json`, with the file that
`chaindrive schema > chaindrive.schema.json` writes.

[Presets](presets.md) are scenes to begin with. [Defaults](defaults.md) lists the values that a
scene may leave open, with the source of each.
"""
DEFAULTS = """\
# Defaults

The values that a scene may leave open, and the source of each. Those that begin with *assumed* are
nobody's measurement: [how real](../how-real.md) tries how much they matter. `chaindrive resolve
my.toml` prints a scene with all of them written out, and every result carries that text as
`resolved_scene`. `defaults = "0.3"` in a scene keeps the defaults of that version.
"""
PRESETS = """\
# Presets

Scenes that come with the program: `chaindrive scenes NAME` prints one, `chaindrive.scenes.NAME()`
makes its drive. Each says which of its values are published, which reconstructed and which assumed.
[The gallery](../gallery.md) shows how they look.
"""
REPEATED = {"sprockets", "guides", "tensioners", "chains", "shafts", "couplings", "gears"}


def write_pages(app: Sphinx) -> None:
    """Write the pages into the folder `scene` of the sources, which is not kept."""
    folder = Path(app.srcdir) / "scene"
    folder.mkdir(exist_ok=True)
    schema = cd.schema()
    examples = Examples(schema)
    for name in cd.scenes.presets():
        text = getattr(cd.scenes, name)().text
        examples.take(tomllib.loads(text), name)
    pages = assign(schema)
    missing = sorted(set(schema["$defs"]) - {name for names in pages.values() for name in names})
    if missing:
        raise ValueError(f"no page of the scene reference has the tables {missing}")
    written = {"index": index(schema, examples), "defaults": defaults(schema), "presets": presets()}
    for key, names in pages.items():
        if key != "index":
            written[key] = page(key, names, schema, examples)
    if unknown := examples.left_over():
        raise ValueError(f"examples.toml has keys that the schema has not: {unknown}")
    for old in folder.glob("*.md"):
        if old.stem not in written:
            old.unlink()
    for stem, text in written.items():
        place = folder / f"{stem}.md"
        # An unchanged page keeps its time, so that it is not built again.
        if not place.exists() or place.read_text(encoding="utf-8") != text:
            place.write_text(text, encoding="utf-8")


def assign(schema: Node) -> dict[str, list[str]]:
    """Return the tables of every page, in the order in which they are met."""
    taken: set[str] = set()
    pages: dict[str, list[str]] = {}
    for key in [*ORDER, "index"]:
        names: list[str] = []
        roots = [key] if key != "index" else [k for k in schema["properties"] if k not in ORDER]
        for root in roots:
            for name in reachable(schema["properties"][root], schema):
                if name not in taken:
                    taken.add(name)
                    names.append(name)
        pages[key] = names
    return pages


def reachable(node: Any, schema: Node) -> Iterator[str]:
    """Yield the names of the tables to which a node refers, breadth first, each once."""
    seen: list[str] = []
    queue = [node]
    while queue:
        found = list(references(queue.pop(0)))
        for name in found:
            if name not in seen:
                seen.append(name)
                queue.append(schema["$defs"][name])
                yield name


def references(node: Any) -> Iterator[str]:
    if isinstance(node, dict):
        if "$ref" in node:
            yield node["$ref"].rsplit("/", 1)[1]
        for value in node.values():
            yield from references(value)
    elif isinstance(node, list):
        for value in node:
            yield from references(value)


def index(schema: Node, examples: Examples) -> str:
    """Return the page about the top level of a scene file."""
    lines = [INDEX, "```{toctree}", ":hidden:", "", "presets", "defaults", *ORDER, "```", ""]
    lines += ["## Top level", ""]
    for key, node in schema["properties"].items():
        if key in ORDER:
            lines += [f"[`{bracketed(key)}`]({key}.md)", f": {prose(node['description'])}", ""]
        else:
            lines += entry("scene", key, node, False, examples)
    for name in assign(schema)["index"]:
        lines += table(name, schema["$defs"][name], examples)
    return "\n".join(lines) + "\n"


def bracketed(key: str) -> str:
    return f"[[{key}]]" if key in REPEATED else f"[{key}]"


def page(key: str, names: list[str], schema: Node, examples: Examples) -> str:
    node = schema["properties"][key]
    lines = [f"# `{bracketed(key)}`", "", prose(node["description"]), ""]
    first = next(references(node))
    if first not in names:
        lines += [f"Its keys are those of {link(first)}.", ""]
    for name in names:
        lines += table(name, schema["$defs"][name], examples)
    return "\n".join(lines) + "\n"


def table(name: str, node: Node, examples: Examples) -> list[str]:
    """Return a section about one table, choice of words, or family of tables."""
    lines = [f"(scene-{name})=", f"## {title(name)}", "", prose(node.get("description", "")), ""]
    if "properties" in node:
        lines += entries(name, node, examples)
    for variant in node.get("oneOf", []):
        kind = variant.get("properties", {}).get("kind", {}).get("const")
        if kind:
            lines += [f'### `kind = "{kind}"`', "", prose(variant.get("description", "")), ""]
            lines += entries(f"{name}.{kind}", variant, examples)
        elif "const" in variant:
            lines += [f'`"{variant["const"]}"`', f": {prose(variant['description'])}", ""]
        elif "enum" in variant:
            words = ", ".join(f'`"{word}"`' for word in variant["enum"])
            lines += [f"May be written as a bare name: {words}.", ""]
        else:
            lines += [f"Or {kind_of(variant)}.", ""]
    if "type" in node and "properties" not in node:
        lines += [f"{kind_of(node).capitalize()}{limits(node)}.", ""]
    return lines


def title(name: str) -> str:
    return name.replace("_of_", " of ")


def link(name: str) -> str:
    return f"[{title(name)}](#scene-{name})"


def entries(owner: str, node: Node, examples: Examples) -> list[str]:
    required = set(node.get("required", []))
    lines: list[str] = []
    for key, value in node["properties"].items():
        if key == "kind" and "const" in value:
            continue
        lines += entry(owner, key, value, key in required, examples)
    return lines


def entry(owner: str, key: str, node: Node, required: bool, examples: Examples) -> list[str]:
    """Return the entry of one key in a list of definitions."""
    facts = [f"{kind_of(node)}{limits(node)}"]
    if required:
        facts.append("**required**")
    lines = [f"`{key}`", f": {'; '.join(facts)}", ""]
    if node.get("description"):
        lines += [f"  {prose(node['description'])}", ""]
    for default in node.get("x-defaults", []):
        lines += [f"  Default {amount(default)}: {default['basis']}.", ""]
    if "default" in node and not node.get("x-defaults") and node["default"] not in ("", None):
        lines += [f"  Default: `{examples.toml(node['default'])}`.", ""]
    if not node.get("writeOnly"):
        text, place = examples.of(owner, key, node)
        told = f", in the preset `{place}`" if place else ""
        lines += [f"  Example: `{text}`{told}.", ""]
    return lines


def amount(default: Node) -> str:
    unit = default.get("unit", "")
    return f"**{default['value']}**" + (f" {unit}" if unit not in ("", "1") else "")


def kind_of(node: Node) -> str:
    """Say in words what a value can be."""
    if "$ref" in node:
        return link(node["$ref"].rsplit("/", 1)[1])
    if "x-dimension" in node:
        unit = node["x-unit"]
        return node["x-dimension"] + (f" [{unit}]" if unit != "1" else "")
    if "anyOf" in node and "type" not in node:
        kinds = [kind_of(part) for part in node["anyOf"]]
        # A list may also be written as a table of unit and values.
        return " or ".join(dict.fromkeys(kind for kind in kinds if kind))
    if "oneOf" in node or "enum" in node:
        words = node.get("enum") or [part.get("const") for part in node["oneOf"]]
        return "one of " + ", ".join(f'`"{word}"`' for word in words if word is not None)
    kind = node.get("type")
    if kind == "array":
        count = node.get("minItems")
        inner = kind_of(node["items"])
        if count is not None and count == node.get("maxItems"):
            return f"list of {count}, each {inner}"
        return f"list, each {inner}"
    if kind == "object":
        return (
            "a table of `unit` and `values`"
            if "values" in node.get("properties", {})
            else "a table"
        )
    if isinstance(kind, list):
        return "a number or a text"
    return {
        "integer": "whole number",
        "string": "text",
        "boolean": "`true` or `false`",
        "number": "number",
    }[kind]


def limits(node: Node) -> str:
    """Return the range of a number, or nothing."""
    told = []
    for name, sign in [
        ("minimum", "≥"),
        ("exclusiveMinimum", "\\>"),
        ("maximum", "≤"),
        ("exclusiveMaximum", "\\<"),
    ]:
        if name in node:
            told.append(f"{sign} {node[name]:g}")
    if node.get("type") == "array" and node.get("minItems") != node.get("maxItems"):
        least, most = node.get("minItems"), node.get("maxItems")
        if least is not None:
            told.append(f"at least {least}")
        if most is not None:
            told.append(f"at most {most}")
    return ", " + ", ".join(told) if told else ""


def prose(text: str) -> str:
    """Return a description as one paragraph of Markdown."""
    return " ".join(text.split()).replace("*", "\\*").replace("<", "\\<")


def defaults(schema: Node) -> str:
    """Return the page with all defaults and their bases."""
    lines = [DEFAULTS, "| where | key | value | basis |", "|---|---|---|---|"]
    places: dict[tuple[str, str, str], list[str]] = {}
    for owner, key, default in every_default(schema):
        places.setdefault((key, amount(default), default["basis"]), []).append(owner)
    for (key, value, basis), owners in places.items():
        where = ", ".join(dict.fromkeys(owners))
        lines.append(
            f"| {where} | `{key}` | {value} | {prose(basis).replace('|', chr(92) + '|')} |"
        )
    return "\n".join(lines) + "\n"


def every_default(schema: Node) -> Iterator[tuple[str, str, Node]]:
    for key, node in schema["properties"].items():
        for default in nested_defaults(node):
            yield "scene", key, default
    for name, definition in schema["$defs"].items():
        parts = [(link(name), definition)]
        for variant in definition.get("oneOf", []):
            kind = variant.get("properties", {}).get("kind", {}).get("const")
            parts.append((f"{link(name)} `{kind}`" if kind else link(name), variant))
        for where, part in parts:
            for key, node in part.get("properties", {}).items():
                for default in nested_defaults(node):
                    yield where, key, default


def nested_defaults(node: Any) -> list[Node]:
    """Return the defaults in a value, each once, without those of tables to which it refers."""
    found: list[Node] = []
    if isinstance(node, dict):
        found += node.get("x-defaults", [])
        for key, value in node.items():
            if key != "x-defaults":
                found += [default for default in nested_defaults(value) if default not in found]
    elif isinstance(node, list):
        for value in node:
            found += [default for default in nested_defaults(value) if default not in found]
    return found


def presets() -> str:
    """Return the page with the text of every preset."""
    lines = [PRESETS]
    for name, description in cd.scenes.presets().items():
        lines += [
            f"(preset-{name})=",
            f"## `{name}`",
            "",
            f"{prose(description)}.",
            "",
            "::::{dropdown} The scene",
        ]
        lines += ["```toml", getattr(cd.scenes, name)().text.rstrip(), "```", "::::", ""]
    return "\n".join(lines) + "\n"


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
