"""Options and fixtures that all tests share."""

import os
from collections.abc import Iterator

import pytest
from hypothesis import settings

from cmverify.run.threads import VARIABLES, threads_per_worker

# Processes that share the cores must share their threads too, or each small kernel waits for a
# thread that another process has. Libraries read this when they are imported; Numba keeps its own
# limit, which tests of threads need, and is told below.
SHARE = threads_per_worker(int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1")))
for _name in VARIABLES:
    if _name != "NUMBA_NUM_THREADS":
        os.environ.setdefault(_name, str(SHARE))


# The same scenes in each run, so that a failure is the change's and not the day's; `pytest
# --hypothesis-profile=explore` draws new ones.
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.register_profile("explore", derandomize=False, deadline=None, print_blob=True)
settings.load_profile("repeatable")


@pytest.fixture(scope="session", autouse=True)
def _threads_of_a_worker() -> Iterator[None]:
    import numba

    before = numba.get_num_threads()
    numba.set_num_threads(min(SHARE, before))
    yield
    numba.set_num_threads(before)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--slow", action="store_true", help="also run the studies at the paper's resolution"
    )


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--slow"):
        return
    skip = pytest.mark.skip(reason="paper's resolution: run with --slow")
    for item in items:
        if "slow" in item.keywords:
            item.add_marker(skip)
