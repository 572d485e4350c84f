"""What outlives a crash in the middle of applying a profile: what was to be written, over what, and how far it was.

One file a device in the data directory. Its first line says everything and is on the disk before the first register is
written; each further line is the number of the step that is about to be written. A transaction that ends well, or takes
itself back, removes it; one that leaves something keeps it with what is left. What is found at the next start was cut
off, by a crash or a power failure, and nothing is done about it until asked: the device may have been switched
off too, or set up anew by other means.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import os
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal, TextIO

from ..calc.tmcl.binary import from_binary, to_binary
from ..devices.core.actor import actor
from ..devices.core.device import Device
from ..errors import WrongState
from ..registers.catalog import is_model
from .document import ProfileDocument
from .errors import Change
from .program import NAME as PROGRAM
from .program import ProgramStep
from .steps import Step
from .writing import change_of, restored

log = logging.getLogger("stepscope.profiles")

FOLDER = "unfinished-profiles"
FORMAT, VERSION = "stepscope-unfinished-profile", 1
Reached = Literal["written", "perhaps written", "not begun", "left"]


@dataclass(frozen=True, slots=True)
class Half:
    """A register of a transaction that did not come to its end, and how far it got."""

    change: Change
    state: Reached


@dataclass(frozen=True, slots=True)
class Unfinished:
    """A transaction that was cut off, or whose rollback failed."""

    device: str
    """Its id at that time."""
    device_name: str
    model: str
    profile: str
    started_unix_s: float
    by: str
    crashed: bool
    """Whether the server ended in the middle; else the rollback failed, and `halves` are what it has left."""
    halves: tuple[Half, ...]
    program: ProgramStep | None = None
    """A program that may have been stored, or half of it."""

    @property
    def steps(self) -> list[Step]:
        """What may have been written, in that order; without what this version does not know."""
        changed = [half.change for half in self.halves if half.state != "not begun"]
        return [step for change in changed if (step := restored(self.model, change)) is not None]


class FileJournal:
    """The journal of one transaction: see `apply.Journal`."""

    def __init__(self, path: Path, device: Device, document: ProfileDocument) -> None:
        self._path = path
        self._head = {
            "format": FORMAT,
            "version": VERSION,
            "device": device.id,
            "device_name": device.name,
            "model": device.model,
            "profile": document.name,
            "started_unix_s": time.time(),
            "by": actor.get().name,
        }
        self._file: TextIO | None = None
        self._program: dict[str, object] = {}

    async def begin(self, steps: Sequence[Step], program: ProgramStep | None = None) -> None:
        """Raises WrongState where the disk does not take it: then nothing may be written either."""
        self._program = {} if program is None else {"program": _programs(program)}
        head = {
            **self._head,
            "crashed": True,
            "steps": [asdict(change_of(step, None)) for step in steps],
            **self._program,
        }
        try:
            self._file = await asyncio.to_thread(_begun, self._path, head)
        except OSError as error:
            raise WrongState(f"what is to be written cannot be noted down: {error}", "see to the disk") from error

    def reached(self, index: int) -> None:
        # No fsync: what was handed to the system outlives a crash, and a power failure resets the chip too.
        if self._file is not None:
            with contextlib.suppress(OSError):
                self._file.write(f"{index}\n")
                self._file.flush()

    async def end(self, left: Sequence[Change]) -> None:
        if self._file is not None:
            self._file.close()
            self._file = None
        with contextlib.suppress(OSError):
            if not left:
                await asyncio.to_thread(self._path.unlink, missing_ok=True)
                return
            head = {
                **self._head,
                "crashed": False,
                "steps": [asdict(change) for change in left if change.name != PROGRAM],
            }
            if any(change.name == PROGRAM for change in left):
                head |= self._program
            (await asyncio.to_thread(_begun, self._path, head)).close()


def _begun(path: Path, head: dict[str, Any]) -> TextIO:
    """The file with its first line on disk, open for more."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(path.name + ".new")
    with beside.open("w", encoding="utf-8") as file:
        file.write(json.dumps(head) + "\n")
        file.flush()
        os.fsync(file.fileno())
    beside.replace(path)
    return path.open("a", encoding="utf-8")


def path_of(data_dir: Path, device_id: str) -> Path:
    """Where the journal of a device is; its id is a slug."""
    return data_dir / FOLDER / f"{device_id}.jsonl"


def read(path: Path) -> Unfinished | None:
    """What an earlier transaction has left; None where there is nothing, or nothing that can be read."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        return _parsed(json.loads(lines[0]), lines[1:])
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError, IndexError) as error:
        log.warning("%s cannot be read (%r): what was half done there is not known", path, error)
        return None


def _parsed(head: dict[str, Any], lines: Sequence[str]) -> Unfinished:
    if head["format"] != FORMAT or head["version"] != VERSION or not is_model(head["model"]):
        raise ValueError("of another version")
    reached = -1
    for line in lines:
        with contextlib.suppress(ValueError):  # the last one may be torn
            reached = max(reached, int(line))
    crashed = bool(head["crashed"])
    halves = []
    for index, step in enumerate(head["steps"]):
        state: Reached = "left"
        if crashed:
            state = "written" if index < reached else "perhaps written" if index == reached else "not begun"
        halves.append(Half(Change(**step), state))
    program = None
    if "program" in head:
        was, wanted = (tuple(from_binary(bytes.fromhex(head["program"][side]))) for side in ("was", "wanted"))
        program = ProgramStep(was, wanted)
        why = "" if crashed else "it could not be brought back"
        halves.insert(0, Half(program.change(None, why), "perhaps written" if crashed else "left"))
    return Unfinished(
        str(head["device"]),
        str(head["device_name"]),
        str(head["model"]),
        str(head["profile"]),
        float(head["started_unix_s"]),
        str(head["by"]),
        crashed,
        tuple(halves),
        program,
    )


def _programs(step: ProgramStep) -> dict[str, str]:
    """Both as bytes in hexadecimal, eight a command."""
    return {"was": to_binary(step.was).hex(), "wanted": to_binary(step.wanted).hex()}


def read_all(data_dir: Path) -> list[Unfinished]:
    """Everything that is there, for the start of the program."""
    paths = sorted((data_dir / FOLDER).glob("*.jsonl"))
    return [found for path in paths if (found := read(path)) is not None]
