"""Measure each (case, method, resolution) once a session and print the order table at the end."""

from __future__ import annotations

import pytest

from cmverify.case import Case, Level
from cmverify.report import summary, terminal
from cmverify.report.summary import CaseResult
from cmverify.run import results, worker


class Measurements:
    """Case results by level, measured on demand in this process."""

    def __init__(self) -> None:
        self.records: dict[tuple[str, str, int], results.Record] = {}
        self.done: dict[str, CaseResult] = {}

    def of(self, case: Case, level: Level) -> CaseResult:
        """Run a case at a level (what a coarser level measured is not measured again)."""
        keys = []
        for method, n in case.plan(level):
            key = (case.name, method.name, n)
            keys.append(key)
            if key not in self.records:
                self.records[key] = worker.record(case, method, n, threads=0, fingerprint="")
        (found,) = summary.summarise([case], [self.records[key] for key in keys])
        self.done[case.name] = found
        return found


_measured = Measurements()


@pytest.fixture(scope="session")
def measurements() -> Measurements:
    return _measured


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """The order table of every case that was run."""
    if _measured.done:
        terminalreporter.section("orders of convergence")
        for line in terminal.order_lines(list(_measured.done.values())):
            terminalreporter.write_line(line)
