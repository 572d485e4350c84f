"""A server of our own in a process of its own, which a script may try itself on: it ends when whoever began it does.

Run as a module with `serve ...`, it is `stepscope serve ...`, as long as its parent holds its standard
input open. A parent that was killed holds nothing open: so no server is left behind.
"""

from __future__ import annotations

import contextlib
import os
import runpy
import sys
import threading

NICER = 10
"""How far behind a bench that is in use the trial stands."""


def main() -> None:
    """Run the command line until the standard input ends."""
    threading.Thread(target=_end_with_input, name="parent", daemon=True).start()
    with contextlib.suppress(OSError, AttributeError):  # not every system knows of niceness
        os.nice(NICER)
    sys.argv[0] = "stepscope"
    # By its name: this room may not know the command line, and does not; it starts a program.
    runpy.run_module(f"{(__package__ or '').partition('.')[0]}.cli", run_name="__main__", alter_sys=True)


def _end_with_input() -> None:
    while os.read(0, 4096):
        pass
    os._exit(1)


if __name__ == "__main__":
    main()
