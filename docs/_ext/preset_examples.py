"""Examples of every key of a scene: of the presets, else of `examples.toml` or the schema."""

import json
import tomllib
from pathlib import Path
from typing import Any

Node = dict[str, Any]

# Longer values are not shown: a key is described by a short one as well.
LONGEST = 90

WRITTEN: Node = tomllib.loads(Path(__file__).with_name("examples.toml").read_text("utf-8"))


class Examples:
    """The shortest way in which presets write each key of each table."""

    def __init__(self, schema: Node) -> None:
        self.schema = schema
        self.found: dict[tuple[str, str], tuple[str, str]] = {}
        self.asked: set[tuple[str, str]] = set()

    def take(self, scene: Any, preset: str) -> None:
        """Remember the values of a preset."""
        self._walk("scene", self.schema, scene, preset)

    def of(self, owner: str, key: str, node: Node) -> tuple[str, str]:
        """Return an example of a key, and the preset that has it, or no name."""
        self.asked.add((owner, key))
        if (owner, key) in self.found:
            return self.found[owner, key]
        written = WRITTEN.get(owner, {})
        if key in written or key in WRITTEN["any"]:
            return f"{key} = {self.toml(written.get(key, WRITTEN['any'].get(key)))}", ""
        return f"{key} = {self.toml(self._made(node, key))}", ""

    def left_over(self) -> list[str]:
        """Return the written examples of keys for which none was asked: keys that there are not."""
        tables = (name for name in WRITTEN if name != "any")
        keys = ((name, key) for name in tables for key in WRITTEN[name])
        return [f"{name}.{key}" for name, key in keys if (name, key) not in self.asked]

    def toml(self, value: Any) -> str:
        """Write a value as TOML in one line."""
        if isinstance(value, dict):
            inner = ", ".join(f"{key} = {self.toml(inner)}" for key, inner in value.items())
            return "{ " + inner + " }"
        if isinstance(value, list):
            return "[" + ", ".join(self.toml(inner) for inner in value) + "]"
        return json.dumps(value, ensure_ascii=False)

    def _walk(self, owner: str, node: Node, value: Any, preset: str) -> None:
        """Go down the schema beside a value."""
        if "$ref" in node:
            owner = node["$ref"].rsplit("/", 1)[1]
            self._walk(owner, self.schema["$defs"][owner], value, preset)
        elif isinstance(value, list):
            items = node.get("items") or next(
                (part["items"] for part in node.get("anyOf", []) if "items" in part), {}
            )
            for inner in value:
                self._walk(owner, items, inner, preset)
        elif isinstance(value, dict):
            properties = node.get("properties", {})
            for variant in node.get("oneOf", []):
                kind = variant.get("properties", {}).get("kind", {}).get("const")
                if kind and kind == value.get("kind"):
                    owner, properties = f"{owner}.{kind}", variant["properties"]
            if not properties and "anyOf" in node:
                for part in node["anyOf"]:
                    if "$ref" in part:
                        self._walk(owner, part, value, preset)
                return
            for key, inner in value.items():
                if key not in properties:
                    continue
                self._keep(owner, key, inner, preset)
                self._walk(owner, properties[key], inner, preset)

    def _keep(self, owner: str, key: str, value: Any, preset: str) -> None:
        text = f"{key} = {self.toml(value)}"
        if len(text) <= LONGEST and (owner, key) not in self.found:
            self.found[owner, key] = (text, preset)

    def _made(self, node: Node, key: str) -> Any:
        """Return a value that the schema allows."""
        if "examples" in node:
            return node["examples"][0]
        if "$ref" in node:
            return self._made(self.schema["$defs"][node["$ref"].rsplit("/", 1)[1]], key)
        if "const" in node:
            return node["const"]
        if "enum" in node:
            return node["enum"][0]
        for family in ("oneOf", "anyOf"):
            if family in node and "properties" not in node:
                return self._made(node[family][0], key)
        kind = node.get("type")
        if kind == "object":
            needed = node.get("required", list(node["properties"])[:1])
            return {name: self._made(node["properties"][name], name) for name in needed}
        if kind == "array":
            return [self._made(node["items"], key)] * node.get("minItems", 1)
        if kind == "integer":
            return max(1, node.get("minimum", 1))
        if kind == "number":
            return node.get("minimum", 0.5)
        if kind == "boolean":
            return not node.get("default", False)
        return NAMES.get(key, "name")


# Texts that the schema leaves free.
NAMES = {
    "name": "driver",
    "chain": "primary",
    "sprockets": "driver",
    "of": "crank",
    "record": "span_tension",
    "title": "Two-sprocket test rig",
}
