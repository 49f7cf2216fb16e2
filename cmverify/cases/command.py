"""``cmverify list``, and how any command is told which cases it is about."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from cmverify.console import console, refuse

if TYPE_CHECKING:
    from cmverify.case import Case


def complete(incomplete: str) -> list[str]:
    """Cases and tags that begin so, for the shell."""
    from cmverify.cases import registry

    cases = registry.all_cases()
    known = {case.name for case in cases} | {tag for case in cases for tag in case.tags}
    return sorted(name for name in known if name.startswith(incomplete))


Names = Annotated[
    list[str] | None,
    typer.Argument(metavar="[CASE]...", help="Cases or tags.", autocompletion=complete),
]


def list_cases(
    names: Names = None,
    json: Annotated[bool, typer.Option("--json", help="Print them as JSON.")] = False,
) -> None:
    """List cases with their tags and the spacings (a/n) of each level."""
    from cmverify.report import terminal

    cases = chosen(names)
    if json:
        from json import dumps

        typer.echo(dumps(terminal.cases_as_data(cases), indent=1, ensure_ascii=False))
    else:
        terminal.print_cases(console(), cases)


def chosen(names: list[str] | None) -> tuple[Case, ...]:
    """Cases by name or tag; refuses what is neither."""
    from cmverify.cases import registry

    try:
        return registry.select(names or [])
    except ValueError as error:
        refuse(str(error))
