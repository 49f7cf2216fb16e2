"""What a terminal shows while cases run."""

from __future__ import annotations

from types import TracebackType

from rich.console import Console
from rich.markup import escape
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
)

from cmverify.run.runner import Event, Task


class LiveProgress:
    """One bar for the whole run and one line for each task that is running now.

    Use as a context manager and hand `listen` to `runner.run`. Finished tasks scroll by above the
    bar, also where the output is a file.
    """

    def __init__(self, console: Console, total: int) -> None:
        self._console = console
        self._bars = Progress(
            SpinnerColumn(),
            TextColumn("{task.description}"),
            BarColumn(bar_width=24),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
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
        label = f"{name}  {method}  1/{n}"
        if event.kind == "started":
            self._running[event.task] = self._bars.add_task(f"[dim]{label}", total=None)
            return
        if event.task in self._running:
            self._bars.remove_task(self._running.pop(event.task))
        self._bars.advance(self._whole)
        if event.kind == "failed":
            self._console.print(f"[red]failed  [/] {label}  [red]{escape(str(event.message))}[/]")
        elif event.kind == "reused":
            self._console.print(f"[dim]reused   {label}[/]")
        else:
            self._console.print(f"[green]done    [/] {label:<44}{event.seconds:7.2f} s")
