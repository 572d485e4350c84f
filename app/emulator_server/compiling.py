"""Compiles what one emulated model needs behind its answers, as a server does: `stepscope emulate` is there at once.

What is on disk is waited for, half a second: the emulator keeps real time from its first answer on.
"""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Callable, Iterator, Mapping

from ..emulators.board.options import MODEL as BOARD
from ..emulators.board.options import USUAL_CHIP
from ..kernels import all_compiled, plain_meanwhile
from ..preparation import Preparation, jobs_of
from ..registers.catalog import find_model

Jobs = Mapping[str, Callable[[], None]]


def serve_plain(model: str, chip: str = "") -> Jobs:
    """Have plain Python serve where `model`, or a board's `chip`, is not compiled yet; what is to be compiled then."""
    jobs = jobs_of(find_model(chip or USUAL_CHIP if model == BOARD else model).family)
    if not jobs or all_compiled(jobs):
        return {}
    plain_meanwhile(on=True)
    return jobs


@contextlib.contextmanager
def compiled_behind(jobs: Jobs) -> Iterator[None]:
    """Compile it in processes of their own, as long as the block runs; plain Python serves until then."""
    if not jobs:
        yield
        return
    loops: list[asyncio.AbstractEventLoop] = []
    begun, ended = threading.Event(), asyncio.Event()

    async def compile_all() -> None:
        loops.append(asyncio.get_running_loop())
        begun.set()
        preparation = Preparation(jobs=jobs, plain=jobs)
        await preparation.start()
        await ended.wait()
        await preparation.close()

    thread = threading.Thread(target=asyncio.run, args=(compile_all(),), name="compiling", daemon=True)
    thread.start()
    begun.wait()
    try:
        yield
    finally:
        loops[0].call_soon_threadsafe(ended.set)
        thread.join()
