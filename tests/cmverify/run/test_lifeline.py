"""Runs that are ended from outside: no process is left, and a line says how to go on."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import psutil
import pytest

from cmverify.run.lifeline import in_good_order, sheltered

ROOT = Path(__file__).parents[3]
PROGRAM = """
import sys
from cmverify.cases import registry
from cmverify.run import runner
from tests.cmverify import toy_registry as toys

registry.all_cases = lambda: tuple(toys.CASES.values())
original = runner.run
runner.run = lambda *a, **k: original(*a, registry=toys.__name__, **k)

if __name__ == "__main__":
    from cmverify.cli import main

    main()
"""

STARTING = """
import multiprocessing
import os
import signal

from cmverify.run.lifeline import hold, sheltered, workers

if __name__ == "__mp_main__":
    signal.raise_signal(signal.SIGINT)

if __name__ == "__main__":
    with workers(1) as pool:
        print(pool.submit(abs, -3).result())
    process = multiprocessing.get_context("spawn").Process(target=hold, args=(os.getpid(),))
    with sheltered():
        process.start()
    process.join()
    print(process.exitcode)
"""


def started(out, tmp_path):
    """A run of a case that finishes soon and of one that sleeps, when it has come so far."""
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    command = [sys.executable, str(program), "run", "toy", "sleeping", "--jobs", "2"]
    process = subprocess.Popen(
        [*command, "--out", str(out)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        text=True, start_new_session=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONFAULTHANDLER": "1"},
        # Who runs tests in the background has it ignored, and Python leaves it so.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    deadline = time.monotonic() + 60
    while len(list(out.glob("results/toy/*/*.json"))) < 2 and time.monotonic() < deadline:
        time.sleep(0.1)
    children = psutil.Process(process.pid).children(recursive=True)
    assert len(children) >= 3
    return process, children


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="needs POSIX signals")
@pytest.mark.parametrize("name", ["SIGTERM", "SIGINT", "SIGKILL"])
def test_a_run_that_is_ended_leaves_no_process_and_can_be_reported(tmp_path, name):
    out = tmp_path / "out"
    process, children = started(out, tmp_path)
    if name == "SIGINT":  # as a terminal does
        os.killpg(process.pid, signal.SIGINT)
    else:
        process.send_signal(getattr(signal, name))
    # The pipe closes only when the last process that holds it has ended.
    try:
        said, _ = process.communicate(timeout=120)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGABRT)  # says where every thread is
        for child in children:
            with suppress(psutil.NoSuchProcess):
                child.kill()
        pytest.fail(f"it does not end: {process.communicate(timeout=60)[0]}")
    _, left = psutil.wait_procs(children, timeout=60)
    assert not left
    assert "Traceback" not in said
    if name != "SIGKILL":
        assert process.returncode == 3, said
        assert "2 of 4 measurements are finished and kept; go on with: cmverify run toy" in said
        assert "--resume" in said
        return
    again = subprocess.run(
        [sys.executable, str(tmp_path / "program.py"), "report", "--out", str(out)],
        capture_output=True, text=True, check=False, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert again.returncode == 1, again.stderr
    assert "2 measurements are missing: sleeping" in " ".join(again.stdout.split())
    assert json.loads((out / "results.json").read_text())["passed"] is False
    assert "2 measurements are missing" in (out / "index.html").read_text(encoding="utf-8")


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="needs masks of signals")
def test_a_process_that_still_imports_hears_no_interrupt(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(STARTING)
    done = subprocess.run(
        [sys.executable, str(program)],
        capture_output=True, text=True, check=False, timeout=120,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    assert done.stderr == ""
    assert done.stdout.split() == ["3", "0"]


def test_processes_are_started_where_an_interrupt_is_thought_of():
    sources = (ROOT / "cmverify").rglob("*.py")
    starting = {p.name for p in sources if 'get_context("spawn")' in p.read_text(encoding="utf-8")}
    assert starting == {"lifeline.py", "runner.py"}


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="needs masks of signals")
def test_an_interrupt_waits_for_the_end_of_a_start():
    heard = []
    before = signal.signal(signal.SIGINT, lambda number, frame: heard.append(number))
    try:
        with sheltered():
            signal.raise_signal(signal.SIGINT)
            assert not heard
        assert heard == [signal.SIGINT]
    finally:
        signal.signal(signal.SIGINT, before)
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def test_handlers_are_put_back():
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(KeyboardInterrupt), in_good_order():
        signal.raise_signal(signal.SIGTERM)
    assert signal.getsignal(signal.SIGTERM) is before
