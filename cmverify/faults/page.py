"""The page of the fault table, beside the report of a run."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from cmverify.run.results import write_text

if TYPE_CHECKING:
    from cmverify.faults.table import Result

NAME = "faults.html"
TEMPLATE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>cmverify: faults put in on purpose</title>
<style>{{ css|safe }}</style>
</head>
<body>
<header>
<h1>cmverify <span class="soft">faults put in on purpose</span></h1>
<p class="banner {{ 'good' if good else 'bad' }}" role="status">
{{ "✓" if good else "✗" }} {{ caught }} of {{ results|length }} faults are caught
{%- if argued %}, {{ argued }} more are argued to be harmless{% endif %}.</p>
<p>Each line makes one function of the solver, the references or the judges wrong and runs cases at
level quick. A fault is caught if a check fails that holds without it.
{% if not every %}Cases were tried until two had caught it; <code>--all</code> runs all that call
the function.{% endif %}</p>
</header>
<main>
{% for kind, group in results|groupby("fault.kind") %}
<section><h2>{{ kind|capitalize }}</h2>
<div class="scroll"><table>
<thead><tr><th>Verdict</th><th>Fault</th><th>Function</th><th>Caught by</th></tr></thead>
<tbody>{% for r in group %}
<tr class="{{ 'good' if r.good else 'bad' }}"><td class="verdict">{{ "✓ caught" if r.catching else
 "– " ~ r.state if r.good else "✗ " ~ r.state }}</td>
<td>{{ r.fault.name }}</td><td><code>{{ r.fault.target }}</code></td>
<td>{% if r.catching %}{% for f in r.catching[:3] %}
{{ f.case }} <span class="soft">({{ f.method }}: {{ f.caught }})</span>
{{- "; " if not loop.last }}{% endfor %}
{% if r.catching|length > 3 %} and {{ r.catching|length - 3 }} more{% endif %}
{% else %}{{ r.fault.harmless }}{% endif %}</td></tr>{% endfor %}
</tbody></table></div></section>
{% endfor %}
<p>Reproduce: <code>{{ command }}</code></p>
</main>
</body>
</html>
"""


def write(results: Sequence[Result], command: str, folder: Path) -> Path:
    """Write faults.html into a folder; returns its path."""
    from jinja2 import Environment, StrictUndefined

    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    text = environment.from_string(TEMPLATE).render(
        css=(files("cmverify.report") / "style.css").read_text(),
        results=list(results),
        good=all(r.good for r in results),
        caught=sum(bool(r.catching) for r in results),
        argued=sum(r.good and not r.catching for r in results),
        every="--all" in command,
        command=command,
    )
    path = folder / NAME
    write_text(path, text)
    return path
