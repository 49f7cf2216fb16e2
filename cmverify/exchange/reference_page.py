"""The reference page of scene files, written from their declaration."""

from __future__ import annotations

from typing import Any

from cmverify.exchange import schema
from cmverify.exchange.expressions import names

_HEAD = """\
# Scene files

What `cmverify solve SCENE.toml` reads, table by table. This page and
[`scene.schema.json`](scene.schema.json), which editors understand, are written by
`cmverify schema --folder docs --overwrite` from the declaration that checks the files. Begin with
`cmverify new KIND`; `examples/` has a file of every kind.

A file is TOML in UTF-8, in SI units. Whatever it says that does not exist or makes no sense is
refused in one line with the file, the line and the key.

**Formulas** are texts of x and y in metres, of t in seconds where that is said, and of {names}. A
**condition** compares: `"x < 1"`; `*` is "and", `+` is "or": `"(x < 1) * (y < 2)"`.

One analysis is asked for by its table; without one the file is solved as statics, or steady
conduction. Beside the scene's own tables there are
{analyses}
"""


def page() -> str:
    """The page, Markdown."""
    from solver.analyses import analyses

    found = schema.json_schema()
    listed = [f"\n- `[{one.name}]`: {one.says}" for one in analyses().values()]
    parts = [
        _HEAD.format(names=", ".join(f"`{name}`" for name in names()), analyses="".join(listed)),
        "## The file itself\n\n" + _rows(found),
    ]
    for name, entry in found["properties"].items():
        parts += _section(name, entry, found["$defs"], "##")
    return "\n".join(part.rstrip() + "\n" for part in parts)


def _section(name: str, entry: dict[str, Any], tables: dict[str, Any], level: str) -> list[str]:
    """Sections of a key whose value is a table, or one of several kinds."""
    kinds = schema.definitions(entry)
    if not kinds:
        return []
    many = entry.get("type") == "array"
    one_or_many = any(one.get("type") == "array" for one in entry.get("oneOf", ()))
    header = f"`[[{name}]]`" if many else f"`[{name}]`"
    if one_or_many:
        header += f" or `[[{name}]]`"
    parts = [f"{level} {header}"]
    for kind in kinds:
        table = tables[kind]
        said = table.get("description", "")
        if len(kinds) > 1:
            tag = next(
                f'{key} = "{value["const"]}"'
                for key, value in table["properties"].items()
                if "const" in value
            )
            parts.append(f"{level}# `{tag}`\n\n{said}\n\n{_rows(table)}")
        else:
            parts.append(f"{said}\n\n{_rows(table)}")
            for inner, value in table["properties"].items():
                if name == "output":
                    parts += _section(f"output.{inner}", value, tables, f"{level}#")
    return parts


def _rows(table: dict[str, Any]) -> str:
    lines = ["| key | value | default | |", "|---|---|---|---|"]
    keys = list(schema.keys(table))
    for key in keys:
        default = "**needed**" if key.needed else f"`{key.default}`" if key.default else ""
        cells = (f"`{key.name}`", key.kind, default, key.meaning)
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    told = {key.name for key in keys}
    for name, entry in table["properties"].items():
        kinds = schema.definitions(entry)
        if kinds and name not in told and "$defs" not in table and name != "line":
            cells = (
                f"`{name}`",
                f"a table as `[{name}]` of the file",
                "",
                entry.get("description", ""),
            )
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)
