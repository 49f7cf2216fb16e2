"""Refusals of scene files: one line each, with the file, the line and the key."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cmverify.exchange.toml_lines import Lines

if TYPE_CHECKING:
    from pydantic import ValidationError

Place = tuple[str | int, ...]


class SceneFileError(ValueError):
    """A scene file asks for something that does not exist or leaves out what is needed."""


class Source:
    """A scene file as it was read, to say where something in it is wrong.

    Parameters
    ----------
    path : Path
    text : str
    data : dict
        What `tomllib` made of the text.
    """

    def __init__(self, path: Path, text: str, data: Mapping[str, Any]) -> None:
        self.path, self.data, self._lines = path, data, Lines(text)

    def error(self, place: Place, message: str) -> SceneFileError:
        """A refusal of a table or key.

        Parameters
        ----------
        place : tuple
            Table, index in an array of tables, and key, such as ``("support", 0, "where")``.
        message : str
            Line breaks in it become blanks.
        """
        line = self._lines.line(place)
        where = f"{self.path}:{line}" if line else str(self.path)
        said = " ".join(message.split())
        section, key = _named(place)
        if not re.fullmatch(r"\w+( #\d+)?", section):
            section = ""  # no table has such a name: the message quotes it
        if key and not _mentions(said, key):
            said = f"{key}: {said}"
        return SceneFileError(f"{where}: [{section}] {said}" if section else f"{where}: {said}")

    def invalid(self, errors: ValidationError) -> SceneFileError:
        """The first refusal of the declared model, and how many there are besides."""
        found = [self._one(error) for error in errors.errors()]
        found.sort(key=lambda item: self._lines.line(item[0]) or 0)
        place, message = found[0]
        if len(found) > 1:
            message += f" (and {len(found) - 1} more)"
        return self.error(place, message)

    def _one(self, error: Any) -> tuple[Place, str]:
        """Place and message of one of the model's errors."""
        place, context = self._real(error["loc"]), error.get("ctx", {})
        kind, message = error["type"], str(error["msg"])
        if kind == "missing":
            key = str(error["loc"][-1])
            if not place:
                return place, f"the section [{key}] is missing"
            return place, f"the key {key!r} is missing"
        if kind == "scene":
            return (*place, *([context["key"]] if context["key"] else [])), context["said"]
        if kind == "value_error":
            return place, str(context["error"])
        if kind == "union_tag_not_found":
            return place, f"the key {context['discriminator']} is missing"
        if kind in ("union_tag_invalid", "literal_error"):
            key = str(context.get("discriminator", place[-1])).strip("'")
            known = str(context.get("expected_tags", context.get("expected"))).replace("'", "")
            given = self._at((*place, key)) if kind == "union_tag_invalid" else error["input"]
            place = (*place, key) if kind == "union_tag_invalid" else place
            return place, f"{key} = {_shown(given)} is not one of {known.replace(' or ', ', ')}"
        if kind in ("model_attributes_type", "dict_type", "model_type"):
            return place, "must be a table of keys and values"
        if kind == "list_type":
            return place, f"must be a list of tables: write [[{place[-1]}]]"
        return place, message.replace("Input should be", "must be")

    def _real(self, loc: tuple[Any, ...]) -> Place:
        """The model's place without the names of the kinds that a table was tried as."""
        here: Any = self.data
        place: list[str | int] = []
        for part in loc:
            inside = isinstance(here, Mapping) and part in here
            if inside or (isinstance(here, list) and isinstance(part, int)):
                here = here[part]
                place.append(part)
        return tuple(place)

    def _at(self, place: Place) -> Any:
        here: Any = self.data
        for part in place:
            here = here[part]
        return here

    @contextmanager
    def at(self, *place: str | int) -> Iterator[None]:
        """Whatever is refused inside the block is refused because of this table or key."""
        try:
            yield
        except SceneFileError:
            raise
        except (ValueError, TypeError, ArithmeticError, RuntimeError) as error:
            raise self.error(place, str(error) or type(error).__name__) from error
        except MemoryError as error:
            raise self.error(place, "there is not enough memory for it") from error


def _named(place: Place) -> tuple[str, str]:
    """Name of the table as a reader counts it, and of the key."""
    if not place:
        return "", ""
    section, rest = str(place[0]), list(place[1:])
    if rest and isinstance(number := rest[0], int):
        section, rest = f"{section} #{number + 1}", rest[1:]
    return section, ".".join(str(part) for part in rest if not isinstance(part, int))


def _mentions(message: str, key: str) -> bool:
    return message.startswith(f"{key} ") or repr(key) in message


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}…"
