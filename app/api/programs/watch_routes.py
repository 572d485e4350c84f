"""The socket of a program: what its interpreter does, as it changes."""

from __future__ import annotations

import asyncio
import contextlib
from dataclasses import replace

from fastapi import WebSocket, WebSocketDisconnect
from pydantic import ValidationError

from ...clock import BackgroundClock
from ...devices.core.device import Device
from ...errors import BenchError, UsageError
from ..http.problems import problem_of
from ..http.sockets import accepted, until_one_ends
from ..policy import policy
from ..router import subject_router
from ..server_state import ServerState
from .schemas import (
    SUBPROTOCOL,
    DebugState,
    ProgramAlive,
    ProgramLost,
    ProgramRefused,
    ProgramSeen,
    ProgramStarted,
    ProgramTold,
    ProgramWatched,
)
from .watch import News, ProgramSample, ProgramWatch, Reader

ALIVE_S = 1.0
"""How long nothing is said at the most: whoever hears nothing for longer knows nothing any more [s]."""

router = subject_router(tags=["programs"])


@router.websocket("/devices/{device}/program/watch")
@policy(role="look")
async def watch_program(socket: WebSocket, device: str) -> None:
    """Tell what the program of a device does: the first look, then what changes. A client may choose variables."""
    if not await accepted(socket, SUBPROTOCOL):
        return
    bench: ServerState = socket.app.state.bench
    with contextlib.suppress(WebSocketDisconnect):  # it closed under a send
        try:
            watched = bench.manager.get(device)
            reader, leave = bench.programs.join(watched, ())
        except BenchError as error:
            problem = problem_of(error, socket.url.path)
            await _say(socket, ProgramRefused(problem=problem))
            await socket.close(4000 + problem.status, problem.title)
            return
        start = ProgramStarted(device=watched.id, rate_hz=bench.programs.rate_hz(watched, 0))
        try:
            await until_one_ends(
                _send(socket, start, reader, bench.background),
                _hear(socket, bench.programs, watched, reader),
                name="program socket",
            )
        finally:
            leave()


async def _send(socket: WebSocket, start: ProgramStarted, reader: Reader, clock: BackgroundClock) -> None:
    await _say(socket, start)
    before: object = None
    said_s = clock.now()
    while True:
        message: ProgramTold | None = None
        try:
            news, trace = await asyncio.wait_for(reader.next(), ALIVE_S)
        except TimeoutError:
            message = ProgramAlive()
        else:
            told = _what_counts(news)
            if told != before or trace:
                message = _told(news, trace, socket.url.path)
            elif clock.now() - said_s >= ALIVE_S:
                message = ProgramAlive()
            before = told
        if message is not None:
            await clock.turn()
            await _say(socket, message)
            said_s = clock.now()


def _what_counts(news: News) -> object:
    """What is told only where it differs."""
    if isinstance(news, ProgramSample):
        return replace(news, time_s=0.0, trace=(), debug=replace(news.debug, steps_per_s=None))
    return str(news)


def _told(news: News, trace: tuple[int, ...], path: str) -> ProgramTold:
    return _seen(news, trace) if isinstance(news, ProgramSample) else ProgramLost(problem=problem_of(news, path))


def _seen(news: ProgramSample, trace: tuple[int, ...]) -> ProgramSeen:
    truth = news.ground_truth
    state = news.state
    return ProgramSeen(
        time_s=news.time_s,
        status=state.status,
        downloading=state.downloading,
        counter=state.counter,
        accumulator=state.accumulator,
        x=state.x,
        error=state.error,
        variables=state.variables,
        flags=None if truth is None else list(truth.flags),
        stack=None if truth is None else list(truth.stack),
        waits=None if truth is None else truth.waits,
        interrupted=None if truth is None else truth.interrupted,
        debug=DebugState.model_validate(news.debug),
        trace=list(trace),
    )


async def _hear(socket: WebSocket, watch: ProgramWatch, device: Device, reader: Reader) -> None:
    """Return when the reader has gone. What it says is which variables it wants; what else is said is refused."""
    while (message := await socket.receive())["type"] != "websocket.disconnect":
        try:
            wanted = ProgramWatched.model_validate_json(message.get("text") or "")
            watch.choose(device, reader, wanted.variables)
        except ValidationError:
            error = UsageError('a client says {"variables": [0, 7]}: up to 64 numbers of user variables, 0..255')
            await _say(socket, ProgramRefused(problem=problem_of(error, socket.url.path)))
        except BenchError as error:
            await _say(socket, ProgramRefused(problem=problem_of(error, socket.url.path)))


async def _say(socket: WebSocket, message: ProgramTold) -> None:
    await socket.send_text(message.model_dump_json())
