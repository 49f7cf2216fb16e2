"""`python -m cmverify` and the script `cmverify`: ready for signals before it imports anything."""

from __future__ import annotations

import os
import sys

if __name__ == "__main__":
    # Python puts the working folder first: a file there that is called as a module of Python, or
    # a folder called solver, is not to be imported instead of it.
    _HOME = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    _FIRST = os.path.abspath(sys.path[0]) if sys.path and not sys.flags.safe_path else ""
    if _FIRST == os.getcwd() != _HOME:
        del sys.path[0]

import signal
from typing import Any


def _not_begun(number: int, frame: Any) -> None:
    os.write(2, b"interrupted: nothing was begun\n")
    os._exit(3)


def main() -> None:
    """Entry point."""
    before = signal.getsignal(signal.SIGINT)
    handled = before is signal.default_int_handler
    if handled:
        signal.signal(signal.SIGINT, _not_begun)
    from cmverify.cli import main as run

    if handled:
        signal.signal(signal.SIGINT, before)
    run()


if __name__ == "__main__":
    main()
