"""A directive that runs the audit of the paper and sets what it proves: ``audit``."""

from __future__ import annotations

from docutils import nodes
from sphinx.util.docutils import SphinxDirective


def _entry(judged) -> list[nodes.Node]:
    """An equation or statement: what is printed, what is right, how it is known, what follows."""
    field_list = nodes.field_list()
    said = {
        "printed": judged.printed,
        "derived": judged.derived,
        "known from": judged.how,
        "effect": judged.effect or judged.needs,
        "proof": judged.proof,
    }
    for name, text in said.items():
        if not text:
            continue
        body = nodes.field_body()
        formula = name in ("printed", "derived")
        body += nodes.paragraph("", "", nodes.literal(text=text) if formula else nodes.Text(text))
        field_list += nodes.field("", nodes.field_name(text=name), body)
    what = "Eq. " if judged.equation else ""
    return [nodes.rubric(text=f"{what}{judged.number}: {judged.title}"), field_list]


class Audit(SphinxDirective):
    """Every entry of a verdict."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        from cmverify.errata import judge
        from references.errata import entries

        wanted = [one for one in entries() if one.verdict.value == self.arguments[0]]
        if not wanted:
            raise self.error(f"no entry of the audit has the verdict {self.arguments[0]!r}")
        return [node for one in wanted for node in _entry(judge(one))]


def setup(app):
    app.add_directive("audit", Audit)
    return {"parallel_read_safe": True}
