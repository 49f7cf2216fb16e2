"""Names and numbers are never cut, and brackets come out as they went in."""

import io
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console

import cmverify
from cmverify import console
from cmverify.case import Level, Measurement
from cmverify.cases import registry
from cmverify.report import summary, terminal
from cmverify.run import results

words = st.text("abc[]/ν=0'", min_size=1, max_size=30)


def printed(width, columns, rows, **given) -> str:
    stream = io.StringIO()
    screen = Console(file=stream, width=width, markup=False, highlight=False)
    console.show(screen, columns, rows, **given)
    return stream.getvalue()


@settings(max_examples=25, deadline=None)
@given(
    st.integers(20, 130), st.lists(st.tuples(words, words, words, words), min_size=1, max_size=4)
)
def test_a_table_of_any_width_holds_every_cell(width, rows):
    columns = console.columns("name", "one", "two", "three", right=("two",))
    text = printed(width, columns, rows)
    for row in rows:
        for cell in row:
            assert cell in text


@settings(max_examples=15, deadline=None)
@given(st.integers(40, 130), st.lists(st.tuples(words, words), min_size=1, max_size=3))
def test_only_prose_is_broken_and_lines_fit(width, rows):
    long = [(name, f"{text} and more of it, word after word after word") for name, text in rows]
    text = printed(width, console.columns("name", "about", prose=("about",)), long)
    for name, _ in long:
        assert name in text
    room = max(width, 2 + max(len(name) for name, _ in long) + 18)
    assert all(len(line.rstrip()) <= room for line in text.splitlines())


def test_brackets_survive(capsys):
    screen = console.console()
    for said in ("pip install 'cmverify[fenicsx]'", "a[/b]/index.html", ":smile: [bold]x[/]"):
        screen.print(said)
    out = capsys.readouterr().out
    assert out.splitlines() == [
        "pip install 'cmverify[fenicsx]'", "a[/b]/index.html", ":smile: [bold]x[/]",
    ]  # fmt: skip


def test_lines_in_a_pipe_are_as_long_as_what_they_say(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    console.console().print("word " * 100)
    terminal.print_cases(console.console(), registry.all_cases())
    out = capsys.readouterr().out
    lines = out.splitlines()
    assert "word " * 99 in lines[0]
    assert len(lines) == 2 + len(registry.all_cases())
    for case in registry.all_cases():
        assert sum(re.match(rf"{re.escape(case.name)} .*{re.escape(case.title)}", x) is not None
                   for x in lines) == 1  # fmt: skip


def test_no_command_makes_a_console_of_its_own():
    """Only one that `console` makes takes text for text."""
    home = Path(cmverify.__file__).parent
    for path in home.rglob("*.py"):
        if path.name != "console.py":
            text = path.read_text(encoding="utf-8")
            assert not re.search(r"(?<!\.)\bConsole\(", text), path
            assert not re.search(r"\[/\]|\[bold |\[red\]|\[green\]", text), path


@pytest.mark.parametrize("case", registry.all_cases(), ids=lambda case: case.name)
def test_order_tables_fit_into_120_columns(case):
    def measured(n):
        values = dict.fromkeys(case.quantities, 0.001234 / n**2)
        return Measurement(123_456, values, {"setup": 12.3456, "solve": 1.0})

    records = [
        results.Record(case.name, m.name, n, measured(n), 1, 0.0, "")
        for m, n in case.plan(Level.STANDARD)
    ]
    judged = summary.summarise([case], records)
    lines = terminal.order_lines(judged)
    assert max(map(len, lines)) <= terminal.ORDER_WIDTH
    text = "\n".join(lines)
    for quantity in case.quantities:
        assert quantity[:60] in text


def test_counts_are_counts():
    case = registry.get("particle-counts")
    found = Measurement(1, {"particles": 45244.0})
    n = next(case.plan(Level.QUICK))[1]
    record = results.Record(case.name, case.methods[0].name, n, found, 1, 0.0, "")
    assert any(
        x.endswith(" 45244") for x in terminal.order_lines(summary.summarise([case], [record]))
    )
