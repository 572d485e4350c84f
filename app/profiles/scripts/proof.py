"""Trying a script on an emulated device that was just switched on: what the device holds afterwards.

Python and curl run as programs against a server of our own, which nobody else knows of; a TMCL program is assembled,
stored in an emulated module in this process and run by it, or sent to it command by command where it has no memory for
programs; the frames that a C header makes go to an emulated device. Where a compiler, a shell or curl is missing, our
own reader takes the writes out of the script: `how` tells which it was.
"""

from __future__ import annotations

import asyncio
import shutil
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, assert_never

from ...devices.core.capabilities import ProgramMemory
from ...devices.core.device import Device
from ...errors import BenchError
from ...links.tmcl import Request, check_reply, has_reply
from ...registers.tmcl.commands import STATUS_TEXTS
from ..capture import capture
from ..document import ProfileDocument, parse
from ..items import key_of
from ..preconditions import require_rest
from . import c
from .emulated_device import NAME, emulated, emulator_link
from .errors import ScriptFailed
from .plan import Plan
from .process import Ended, guest_server, run, temporary_folder
from .readers import commands_of_tmcl, frames_of_c, writes_of_curl

Language = Literal["python", "tmcl", "c", "curl"]
How = Literal["run", "sent", "compiled", "read"]
COMPILERS = ("cc", "gcc", "clang")
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic")
CALL_WITHIN_S = 30.0
PROGRAM_WITHIN_S = 30.0
PROGRAM_LOOKS_S = 0.02

_MAIN = """\
#include "{header}"

#include <stdio.h>

static int show(void *bus, const uint8_t frame[{macro}_FRAME_BYTES])
{{
    size_t i;
    (void)bus;
    for (i = 0; i < {macro}_FRAME_BYTES; i++)
        printf("%02x", (unsigned)frame[i]);
    printf("\\n");
    return 0;
}}

int main(void)
{{
    return {name}_apply(show, NULL) == {macro}_WRITES ? 0 : 1;
}}
"""


@dataclass(frozen=True, slots=True)
class Trial:
    """What a device holds after a script, and how that came there."""

    how: How
    held: ProfileDocument


async def attempt(plan: Plan, language: Language, text: str) -> Trial:
    """Try `text` on an emulator of the plan's model. Raises ScriptFailed where it does not run through."""
    import httpx  # 0.15 s of work, with pygments and rich: for those who try a script, not for each start

    try:
        match language:
            case "python":
                return await _on_server(plan, text, "profile.py", (sys.executable, "-P", "profile.py"))
            case "curl":
                shell = shutil.which("sh")
                if shell is None or shutil.which("curl") is None:
                    return await _read_curl(plan, text)
                return await _on_server(plan, text, "profile.sh", (shell, "profile.sh"))
            case "tmcl":
                return await _program(plan, text)
            case "c":
                return await _c(plan, text)
            case _:
                assert_never(language)
    except (OSError, ValueError, BenchError, httpx.HTTPError) as error:
        if isinstance(error, ScriptFailed):
            raise
        raise ScriptFailed(language, plan.model, str(error) or type(error).__name__) from error


# --- against a server -------------------------------------------------------------------------------


async def _on_server(plan: Plan, text: str, file: str, command: tuple[str, ...]) -> Trial:
    import httpx

    async with temporary_folder() as folder, guest_server(folder) as guest:
        own = folder / "script"
        _put(own, file, text)
        async with httpx.AsyncClient(
            base_url=f"{guest.url}/api/v1",
            headers={"Authorization": f"Bearer {guest.token}"},
            timeout=CALL_WITHIN_S,
            trust_env=False,
        ) as http:
            link = emulator_link(plan.model, plan.clock_hz)
            body = {"name": NAME, "model": plan.model, "clock_hz": plan.clock_hz, "link": link}
            (await http.post("/devices", json=body)).raise_for_status()
            option = ("--device", NAME) if file.endswith(".py") else (NAME,)
            environment = {"STEPSCOPE_URL": guest.url, "STEPSCOPE_TOKEN": guest.token}
            _expect_end(await run((*command, *option), own, environment))
            for axis in range(plan.family.axes):
                state = (await http.get(f"/devices/{NAME}/axes/{axis}")).raise_for_status().json()
                if state["moving"]:
                    raise ValueError(f"it has set axis {axis} off")
            held = (await http.get(f"/devices/{NAME}/profile")).raise_for_status()
        return Trial("run", parse(held.json()))


def _expect_end(ended: Ended) -> None:
    if ended.code:
        said = ended.said.strip()[-400:] or "it said nothing"
        raise ValueError(f"it ended with {ended.code}: {said}")


def _put(folder: Path, file: str, text: str) -> None:
    folder.mkdir(exist_ok=True)
    (folder / file).write_text(text, encoding="utf-8", newline="\n")


async def _read_curl(plan: Plan, text: str) -> Trial:
    async with emulated(plan.model, plan.clock_hz) as device:
        result = await device.registers.write_many(writes_of_curl(text))
        if result.failed is not None:
            raise result.failed
        return Trial("read", await _captured(device, plan))


# --- in this process --------------------------------------------------------------------------------


async def _program(plan: Plan, text: str) -> Trial:
    """Assembled, stored and run, as whoever takes it to a module would do it; or sent, to one that cannot store it."""
    async with emulated(plan.model, plan.clock_hz) as device:
        memory = device.part(ProgramMemory)
        if memory is None:
            for command in commands_of_tmcl(text):
                await _send(device, Request(1, *command).encode())
            return Trial("sent", await _captured(device, plan))
        made = memory.assemble(text, {})
        if made.problems:
            raise ValueError("; ".join(str(problem) for problem in made.problems))
        await memory.download(made.commands)
        await memory.run_program(0)
        async with asyncio.timeout(PROGRAM_WITHIN_S):
            while True:
                state = await memory.program_state()
                if state.status != "running":
                    break
                await asyncio.sleep(PROGRAM_LOOKS_S)
        if state.error:
            raise ValueError(f"the module refused one of its commands: {STATUS_TEXTS.get(state.error, state.error)}")
        return Trial("run", await _captured(device, plan))


async def _c(plan: Plan, text: str) -> Trial:
    read = frames_of_c(text, plan.family)
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    if compiler is None:
        return Trial("read", await _frames(plan, read))
    name = c.prefix(plan)
    async with temporary_folder() as folder:
        _put(folder, "profile.h", text)
        _put(folder, "main.c", _MAIN.format(header="profile.h", name=name, macro=name.upper()))
        _expect_end(await run((compiler, *STRICT, "-o", "show", "main.c"), folder))
        shown = await run((str(folder / "show"),), folder)
    _expect_end(shown)
    frames = [bytes.fromhex(line) for line in shown.said.split()]
    if frames != read:
        raise ValueError("the compiled arrays say something else than their text")
    return Trial("compiled", await _frames(plan, frames))


async def _frames(plan: Plan, frames: Iterable[bytes]) -> ProfileDocument:
    async with emulated(plan.model, plan.clock_hz) as device:
        for frame in frames:
            await _send(device, frame)
        return await _captured(device, plan)


async def _captured(device: Device, plan: Plan) -> ProfileDocument:
    """What it holds, of all that the script writes at least. Raises WrongState where the script has set a motor off."""
    await require_rest(device)
    wanted = {key_of(write.register) for part in plan.parts for write in part.writes}
    return await capture(device, wanted=wanted)


async def _send(device: Device, frame: bytes) -> None:
    reply = (await device.raw.exchange(frame)).reply
    if device.family.kind == "module" and has_reply(frame):
        answer = check_reply(device.session.port.name, frame, reply)
        if not answer.ok:
            request = Request.decode(frame)
            raise ValueError(f"command {request.opcode} {request.type}, {request.value}: {answer.status_text}")
