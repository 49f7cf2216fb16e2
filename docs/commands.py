"""A directive that shows what every command says of itself: ``commands``."""

from __future__ import annotations

from docutils import nodes
from sphinx.util.docutils import SphinxDirective


class Commands(SphinxDirective):
    """The help of each command, as the installed program prints it."""

    def run(self) -> list[nodes.Node]:
        from typer.main import get_command
        from typer.testing import CliRunner

        from cmverify.cli import app

        found: list[nodes.Node] = []
        for name in get_command(app).commands:
            plain = {"COLUMNS": "74", "TERM": "dumb", "NO_COLOR": "1"}
            said = CliRunner().invoke(app, [name, "--help"], env=plain, prog_name="cmverify")
            if said.exit_code:
                raise self.error(f"cmverify {name} --help ends with {said.exit_code}")
            section = nodes.section(ids=[f"cmverify-{name}"])
            section += nodes.title(text=f"cmverify {name}")
            section += nodes.literal_block(said.output.strip("\n"), said.output.strip("\n"))
            found.append(section)
        return found


def setup(app):
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True}
