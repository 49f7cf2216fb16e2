"""What commands print: names and numbers are never cut, and brackets mean nothing.

Every command prints to a `console`. What it is given is text, not markup: a path such as
``a[/b]`` or the advice ``pip install 'cmverify[fenicsx]'`` comes out as it is. Where the output is
no terminal a line is as long as what it says, so that ``cmverify list | grep NAME`` finds NAME.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    from rich.console import Console
    from rich.text import Text

#: Longer than any line, for files and pipes.
_ENDLESS = 100_000
_GAP = 2
_LEAST_PROSE = 18


@dataclass(frozen=True)
class Manner:
    """How much is said: `quiet` leaves out progress and what holds, `verbose` says every check."""

    quiet: bool = False
    verbose: bool = False


_manner = Manner()


def manner() -> Manner:
    """How much this process says."""
    return _manner


def speak(quiet: bool = False, verbose: bool = False) -> None:
    """Choose how much this process says; the solver's remarks are shown if it is much."""
    import logging

    global _manner
    _manner = Manner(quiet, verbose)
    logger = logging.getLogger("solver")
    logger.handlers = [h for h in logger.handlers if h.get_name() != "cmverify"]
    if verbose:
        handler = logging.StreamHandler()
        handler.set_name("cmverify")
        handler.setLevel(logging.INFO)
        handler.setFormatter(logging.Formatter("%(name)s: %(message)s"))
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)


def console(width: int | None = None) -> Console:
    """A console for text without markup, endless where it is no terminal."""
    from rich.console import Console

    plain = Console(markup=False, highlight=False, emoji=False, width=width)
    if width is None and not plain.is_terminal:
        return Console(markup=False, highlight=False, emoji=False, width=_ENDLESS)
    return plain


def mark(good: bool | None) -> Text:
    """✓, ✗, or – for what is neither, in colour."""
    from rich.text import Text

    sign, style = {True: ("✓", "green"), False: ("✗", "red"), None: ("–", "yellow")}[good]
    return Text(sign, style=style)


@dataclass(frozen=True)
class Column:
    """One column: numbers stand to the `right`, `prose` may be broken into lines."""

    name: str
    right: bool = False
    prose: bool = False


def show(
    to: Console,
    columns: Sequence[Column],
    rows: Sequence[Sequence[str | Text]],
    title: str = "",
    keys: int = 1,
) -> None:
    """Print a table whose names and numbers are whole, however narrow the terminal is.

    Prose is broken into lines first. If that is not enough, columns go into a second table below,
    and its lines begin with the first `keys` columns again.
    """
    from rich.cells import cell_len

    if title:
        to.print(title, style="bold", soft_wrap=True)
    cells = [[cell if isinstance(cell, str) else cell.plain for cell in row] for row in rows]
    natural = [
        max([cell_len(column.name), *(cell_len(row[i]) for row in cells)], default=0)
        for i, column in enumerate(columns)
    ]
    least = [
        min(n, _LEAST_PROSE) if column.prose else n
        for n, column in zip(natural, columns, strict=True)
    ]
    for chosen in _blocks(least, keys, to.width):
        widths = _widths([natural[i] for i in chosen], [least[i] for i in chosen], to.width)
        _print(to, [columns[i] for i in chosen], [[row[i] for i in chosen] for row in rows], widths)


def _blocks(least: Sequence[int], keys: int, width: int) -> list[list[int]]:
    """Columns of each table: the keys, and as many others as fit; at least one."""
    first = list(range(min(keys, len(least))))
    blocks: list[list[int]] = []
    current, used = list(first), sum(least[i] + _GAP for i in first)
    start = used
    for i in range(len(first), len(least)):
        if len(current) > len(first) and used + least[i] > width:
            blocks.append(current)
            current, used = list(first), start
        current.append(i)
        used += least[i] + _GAP
    return [*blocks, current]


def _widths(natural: Sequence[int], least: Sequence[int], width: int) -> list[int]:
    """Natural widths, prose made narrower, the widest first, until the table fits."""
    widths = list(natural)
    over = sum(widths) + _GAP * (len(widths) - 1) - width
    while over > 0:
        slack = [w - low for w, low in zip(widths, least, strict=True)]
        if max(slack, default=0) <= 0:
            break
        widest = max((i for i, s in enumerate(slack) if s > 0), key=lambda i: widths[i])
        widths[widest] -= 1
        over -= 1
    return widths


def _print(
    to: Console, columns: Sequence[Column], rows: Sequence[Sequence[str | Text]], widths: list[int]
) -> None:
    from rich.table import Table

    view = Table(box=None, header_style="bold", pad_edge=False, padding=(0, _GAP, 0, 0))
    for column, width in zip(columns, widths, strict=True):
        view.add_column(
            column.name,
            justify="right" if column.right else "left",
            no_wrap=not column.prose,
            width=width,
            overflow="fold",
        )
    for row in rows:
        view.add_row(*row)
    whole = sum(widths) + _GAP * len(widths)
    if whole > to.width:  # not even one column fits: the terminal breaks the lines
        to = _wider(to, whole)
    to.print(view, crop=False)


def _wider(to: Console, width: int) -> Console:
    from rich.console import Console

    return Console(
        file=to.file, width=width, markup=False, highlight=False, emoji=False,
        force_terminal=to.is_terminal, no_color=to.no_color,
    )  # fmt: skip


def columns(*names: str, right: Sequence[str] = (), prose: Sequence[str] = ()) -> list[Column]:
    """Columns by their names, some of them numbers or prose."""
    return [replace(Column(n), right=n in right, prose=n in prose) for n in names]


def refuse(message: str) -> NoReturn:
    """Print an error and leave with code 2: the request is wrong."""
    import typer

    typer.secho(f"error: {message}", fg=typer.colors.RED, err=True)
    raise typer.Exit(2)


def interrupted(message: str) -> NoReturn:
    """Say how to go on and leave with code 3."""
    import typer

    typer.secho(f"interrupted: {message}", fg=typer.colors.YELLOW, err=True)
    raise typer.Exit(3)
