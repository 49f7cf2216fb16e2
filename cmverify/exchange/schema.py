"""The declared scene file as a JSON schema, and what its keys are, in words."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any


@dataclass(frozen=True)
class Key:
    """A key of a table.

    Attributes
    ----------
    name, kind, meaning : str
        `kind` is what its value may be, in words.
    default : str
        As TOML; empty where there is none.
    needed : bool
    example : str
        A value as TOML.
    """

    name: str
    kind: str
    meaning: str
    default: str
    needed: bool
    example: str


@cache
def json_schema() -> dict[str, Any]:
    """The JSON schema of scene files."""
    from cmverify.exchange.analysis_table import scene_model

    found = scene_model().model_json_schema()
    found["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    found["title"] = "cmverify scene"
    return found


def as_text() -> str:
    """The schema as JSON."""
    return json.dumps(json_schema(), indent=1, ensure_ascii=False) + "\n"


def definitions(entry: dict[str, Any]) -> list[str]:
    """Names of the tables that a key's value may be."""
    found: dict[str, None] = {}

    def walk(node: Any) -> None:
        if isinstance(node, dict):
            if "$ref" in node:
                found[node["$ref"].rsplit("/", 1)[1]] = None
            for name, value in node.items():
                if name != "discriminator":
                    walk(value)
        elif isinstance(node, list):
            for value in node:
                walk(value)

    walk(entry)
    return list(found)


def keys(table: dict[str, Any]) -> Iterator[Key]:
    """Keys of a table's schema whose values need not be tables themselves."""
    for name, entry in table["properties"].items():
        if not _plain(entry):
            continue
        default = entry.get("default")
        yield Key(
            name,
            in_words(entry),
            entry.get("description", ""),
            "" if default is None else toml(default),
            name in table.get("required", ()),
            toml(_example(entry)) if default is None else toml(default),
        )


def _choices(entry: dict[str, Any]) -> list[dict[str, Any]]:
    """What a value may be, one by one."""
    inner = entry.get("anyOf") or entry.get("oneOf")
    return [choice for one in inner for choice in _choices(one)] if inner else [entry]


def _plain(entry: dict[str, Any]) -> bool:
    """Whether a key takes something that is no table."""
    return any(not definitions(one) and one.get("type") != "null" for one in _choices(entry))


def in_words(entry: dict[str, Any]) -> str:
    """What a value may be."""
    if "const" in entry:
        return f'"{entry["const"]}"'
    if "enum" in entry:
        return " or ".join(f'"{word}"' for word in entry["enum"])
    if "anyOf" in entry or "oneOf" in entry:
        choices = [one for one in _choices(entry) if one.get("type") != "null"]
        kinds = [in_words(one) for one in choices if not definitions(one)]
        if definitions(entry):
            kinds.append("a table as `[region]` of the file")
        return " or ".join(dict.fromkeys(kinds))
    if entry.get("type") == "array":
        item = in_words(entry["items"])
        item = f"({item})" if " or " in item and '"' not in item else item
        return f"list of {entry['maxItems']}: {item}" if "maxItems" in entry else f"list: {item}"
    simple = {"number": "number", "integer": "whole number", "boolean": "true or false"}
    if entry.get("type") in simple:
        word = simple[entry["type"]]
        if entry.get("exclusiveMinimum") == 0:
            word += " > 0"
        elif "minimum" in entry:
            word += f" ≥ {entry['minimum']:g}"
        return word
    return str(entry.get("description", "text")) if "formula" in str(entry) else _text(entry)


def _text(entry: dict[str, Any]) -> str:
    return "condition" if entry.get("format") == "condition" else "text"


def _example(entry: dict[str, Any]) -> Any:
    """Some value of the right kind."""
    if "examples" in entry:
        return entry["examples"][0]
    if "const" in entry or "enum" in entry:
        return entry.get("const") or entry["enum"][0]
    if "anyOf" in entry or "oneOf" in entry:
        return _example(_choices(entry)[0])
    if entry.get("type") == "array":
        return [_example(entry["items"])] * entry.get("maxItems", 1)
    if entry.get("format") == "condition":
        return "x > 0"
    return {"number": 1.0, "integer": 1, "boolean": True}.get(entry.get("type", ""), "name")


def toml(value: Any) -> str:
    """A value as TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k} = {toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, float) and abs(value) >= 1e5:
        return f"{value:.12g}"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)
