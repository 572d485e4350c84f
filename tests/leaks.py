"""What is still there: objects of the program's own types, tasks and descriptors, and who holds an object."""

from __future__ import annotations

import asyncio
import gc
import os
from collections import Counter
from types import FrameType, ModuleType

OF_TASKS = ("app.devices.core.actor.Actor", "app.store.audit.Request")
"""Who has asked for what a task does: there as long as the task is."""


def app_objects() -> Counter[str]:
    """How many objects of each type of the program there are, by the type's whole name."""
    gc.collect()
    found: Counter[str] = Counter()
    for each in gc.get_objects():
        kind = type(each)
        if str(kind.__module__).startswith("app.") and not isinstance(each, type):
            found[f"{kind.__module__}.{kind.__qualname__}"] += 1
    for name in OF_TASKS:
        del found[name]
    return found


def tasks() -> Counter[str]:
    """Tasks of the running loop that have not ended, by name."""
    return Counter(task.get_name() for task in asyncio.all_tasks())


def descriptors() -> Counter[str]:
    """Open descriptors of this process, by what they are of."""
    found: Counter[str] = Counter()
    for each in os.listdir("/proc/self/fd"):
        try:
            found[os.readlink(f"/proc/self/fd/{each}").partition(":")[0]] += 1
        except OSError:  # the one of the listing itself
            continue
    return found


def holders(kind: str, depth: int = 12) -> str:
    """Who holds an object of that type, and who holds that, up to a module or something that waits: for a message."""
    held = next(
        (each for each in gc.get_objects() if f"{type(each).__module__}.{type(each).__qualname__}" == kind), None
    )
    told: list[str] = []
    seen: set[int] = set()
    while held is not None and len(told) < depth:
        told.append(f"{type(held).__qualname__} {repr(held)[:60]}")
        seen.add(id(held))
        above = [each for each in gc.get_referrers(held) if id(each) not in seen and not isinstance(each, FrameType)]
        seen.add(id(above))
        held = next((each for each in above if not isinstance(each, ModuleType)), None)
        del above
    return " <- ".join(told)
