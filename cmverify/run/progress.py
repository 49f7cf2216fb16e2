"""What a terminal shows while cases or analyses run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import TracebackType

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TaskID,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from cmverify.console import manner
from cmverify.run.runner import Event, Task


@contextmanager
def share_done(console: Console, label: str) -> Iterator[Callable[[float], None]]:
    """A bar with the time that is left, for a run that tells the share of it that is done.

    It moves to and fro until the run says something, never backwards, and is gone at the end.
    Nothing is shown where the output is no terminal.
    """
    bars = Progress(
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=24),
        TaskProgressColumn(),
        TimeRemainingColumn(),
        console=console,
        transient=True,
        disable=not console.is_terminal,
    )
    task = bars.add_task(label, total=None)
    furthest = 0.0

    def tell(done: float) -> None:
        nonlocal furthest
        furthest = max(furthest, done)
        bars.update(task, total=1.0, completed=furthest)

    with bars:
        yield tell


class LiveProgress:
    """One bar for the whole run and one line for each task that is running now.

    Use as a context manager and hand `listen` to `runner.run`. Finished tasks scroll by above the
    bar, also where the output is a file.
    """

    def __init__(self, console: Console, total: int, lengths: Mapping[str, str] = {}) -> None:
        """`lengths` of cases by name are what their resolutions divide."""
        self._console = console
        self._lengths = lengths
        self._bars = Progress(
            SpinnerColumn(),
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=24),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._whole = self._bars.add_task("all measurements", total=total)
        self._running: dict[Task, TaskID] = {}

    def __enter__(self) -> LiveProgress:
        self._bars.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bars.stop()

    def listen(self, event: Event) -> None:
        """Show an event of the runner."""
        name, method, n = event.task
        label = f"{name}  {method}  {self._lengths.get(name, '1')}/{n}"
        if event.kind == "started":
            self._running[event.task] = self._bars.add_task(label, total=None)
            return
        if event.task in self._running:
            self._bars.remove_task(self._running.pop(event.task))
        self._bars.advance(self._whole)
        if event.kind == "failed":
            self._say("failed  ", "red", f"{label}  {event.message}")
        elif manner().quiet:
            return
        elif event.kind == "reused":
            self._say("reused  ", "dim", label)
        else:
            self._say("done    ", "green", f"{label:<48}{event.seconds:7.2f} s")

    def _say(self, state: str, style: str, text: str) -> None:
        line = Text(f"{state} ", style=style).append(text, style="default")
        self._console.print(line, soft_wrap=True)
