"""Where each key of a TOML text stands: `tomllib` does not keep it."""

from __future__ import annotations

import re

Path = tuple[str | int, ...]

_BARE = re.compile(r"[A-Za-z0-9_-]+")
# A whole string, or where one that runs over lines begins.
_STRINGS = re.compile(
    r'"""(?:[^\\]|\\.)*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\'', re.DOTALL
)


class Lines:
    """Line numbers of the tables and keys of a text that `tomllib` has accepted.

    Parameters
    ----------
    text : str

    Notes
    -----
    Paths are as in the parsed data: names of tables and keys, indices of arrays of tables. Keys
    within inline tables are where these begin.
    """

    def __init__(self, text: str) -> None:
        self._text, self._at = text, 0
        self.found: dict[Path, int] = {}
        self._counts: dict[Path, int] = {}
        self._table: Path = ()
        while self._skip_to_statement():
            self._statement()

    def line(self, path: Path) -> int | None:
        """Line of a path, or of the nearest table around it that has one; None without any."""
        for size in range(len(path), 0, -1):
            if path[:size] in self.found:
                return self.found[path[:size]]
        return None

    def _skip_to_statement(self) -> bool:
        match = re.compile(r"(?:\s+|#[^\n]*)*").match(self._text, self._at)
        assert match
        self._at = match.end()
        return self._at < len(self._text)

    def _statement(self) -> None:
        line = self._text.count("\n", 0, self._at) + 1
        if self._text[self._at] == "[":
            many = self._text.startswith("[[", self._at)
            self._at += 2 if many else 1
            path = self._full(self._key(), many)
            self._table = path
            self.found.setdefault(path, line)
            self._to_end_of_line()
            return
        path = self._table
        for name in self._key():
            path = (*path, name)
            self.found.setdefault(path, line)
        self._at += 1  # the "="
        self._value()

    def _full(self, names: list[str], many: bool) -> Path:
        """Path of a header: the last of each array of tables is meant on the way."""
        path: Path = ()
        for name in names[:-1]:
            path = (*path, name)
            if path in self._counts:
                path = (*path, self._counts[path] - 1)
        path = (*path, names[-1])
        if many:
            self._counts[path] = self._counts.get(path, 0) + 1
            self.found.setdefault(path, self._text.count("\n", 0, self._at) + 1)
            path = (*path, self._counts[path] - 1)
        return path

    def _key(self) -> list[str]:
        names: list[str] = []
        while True:
            self._blanks()
            string = _STRINGS.match(self._text, self._at)
            bare = string or _BARE.match(self._text, self._at)
            if bare is None:  # nothing that tomllib accepts
                self._at = len(self._text)
                return names or [""]
            names.append(_unquoted(bare[0]) if string else bare[0])
            self._at = bare.end()
            self._blanks()
            if not self._text.startswith(".", self._at):
                return names
            self._at += 1

    def _blanks(self) -> None:
        while self._at < len(self._text) and self._text[self._at] in " \t":
            self._at += 1

    def _to_end_of_line(self) -> None:
        end = self._text.find("\n", self._at)
        self._at = len(self._text) if end < 0 else end

    def _value(self) -> None:
        """Over a value: to the end of the line on which no bracket is open any more."""
        depth = 0
        while self._at < len(self._text):
            string = _STRINGS.match(self._text, self._at)
            character = self._text[self._at]
            if string:
                self._at = string.end()
                continue
            if character == "#":
                self._to_end_of_line()
                continue
            if character in "[{":
                depth += 1
            elif character in "]}":
                depth -= 1
            elif character == "\n" and depth <= 0:
                return
            self._at += 1


def _unquoted(text: str) -> str:
    import tomllib

    return next(iter(tomllib.loads(f"{text} = 0")))
