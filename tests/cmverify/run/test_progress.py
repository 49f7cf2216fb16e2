"""What a terminal shows of a run, and what a file does not."""

import io

from rich.console import Console

from cmverify.run.progress import share_done


def shown(terminal):
    console = Console(file=io.StringIO(), force_terminal=terminal, width=80)
    with share_done(console, "waves") as tell:
        for share in (0.25, 0.5, 0.4, 0.75):
            tell(share)
    return console.file.getvalue()


def test_a_terminal_sees_the_share_and_the_time_that_is_left():
    said = shown(True)
    assert "waves" in said
    assert "75%" in said
    assert "40%" not in said


def test_a_file_sees_nothing():
    assert not shown(False).strip()
