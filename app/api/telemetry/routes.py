"""The telemetry socket: one JSON message that says what comes, then binary frames, JSON between them."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping

from fastapi import WebSocket, WebSocketDisconnect

from ...devices.core.results import ChipEvents, MotionEnd, ProgramEvent
from ...errors import BenchError, OutOfRange, UsageError
from ...telemetry.feed import Joined
from ...telemetry.frames import encode_body
from ...telemetry.reader import Event, MoveSeen, Status
from ..http.problems import problem_of
from ..http.sockets import accepted, until_one_ends
from ..policy import policy
from ..router import subject_router
from ..server_state import ServerState
from .schemas import (
    SUBPROTOCOL,
    TelemetryChannel,
    TelemetryEvent,
    TelemetryGap,
    TelemetryMove,
    TelemetryProblem,
    TelemetryProgram,
    TelemetryStart,
    TelemetryStatus,
    TelemetryStopped,
    TelemetryText,
)

router = subject_router(tags=["telemetry"])

HISTORY_ROWS_A_FRAME = 4096
RATE_DEFAULT_HZ = 100.0
BATCH_DEFAULT_HZ = 60.0
HISTORY_S_MAX = 24 * 3600.0
CHANNELS_MAX = 128
GONE = 4410
"""Close code: the device is not what it was, join again."""


@router.websocket("/devices/{device}/telemetry")
@policy(role="look")
async def telemetry(socket: WebSocket, device: str) -> None:
    """Stream channels of a device: `?channels=position.0,velocity.0&rate_hz=1000[&history_s=60][&batch_hz=60]`."""
    if not await accepted(socket, SUBPROTOCOL):
        return
    bench: ServerState = socket.app.state.bench
    with contextlib.suppress(WebSocketDisconnect):  # it closed under a send
        try:
            channels, rate_hz, batch_hz, history_s = _asked(socket.query_params)
            if history_s > 0:
                bench.hub.require_history_room()
            joined = bench.hub.join(device, channels, rate_hz, batch_hz, history_s)
        except BenchError as error:
            problem = problem_of(error, socket.url.path)
            await _say(socket, TelemetryProblem(problem=problem))
            await socket.close(4000 + problem.status, problem.title)
            return
        start = TelemetryStart(
            device=device,
            channels=[
                TelemetryChannel(name=name, unit=unit) for name, unit in zip(channels, joined.units, strict=True)
            ],
            rate_hz=joined.rate_hz,
            requested_rate_hz=rate_hz,
            chip_timed=joined.chip_timed,
            time_origin_unix_s=joined.time_origin_unix_s,
            history_rows=len(joined.history_time_s),
        )
        try:
            await until_one_ends(_send(socket, start, joined, bench), _hear(socket), name="telemetry socket")
        finally:
            bench.hub.leave(joined.reader)


def _asked(query: Mapping[str, str]) -> tuple[tuple[str, ...], float, float, float]:
    """Channels, rate, batch rate and history of a socket's address. Raises UsageError."""
    channels = tuple(dict.fromkeys(name.strip() for name in query.get("channels", "").split(",") if name.strip()))
    if not channels:
        raise UsageError("no channels are asked for: ?channels=position.0,velocity.0")
    if len(channels) > CHANNELS_MAX:
        raise OutOfRange("number of channels", len(channels), 1, CHANNELS_MAX)
    history_s = _number(query, "history_s", 0.0)
    if not 0 <= history_s <= HISTORY_S_MAX:
        raise OutOfRange("history_s", history_s, 0, HISTORY_S_MAX)
    return channels, _number(query, "rate_hz", RATE_DEFAULT_HZ), _number(query, "batch_hz", BATCH_DEFAULT_HZ), history_s


def _number(query: Mapping[str, str], name: str, default: float) -> float:
    text = query.get(name)
    if text is None:
        return default
    try:
        return float(text)
    except ValueError as error:
        raise UsageError(f"{name} is a number, not {text[:40]!r}") from error


async def _hear(socket: WebSocket) -> None:
    """Return when the client has gone. What it says means nothing (yet)."""
    while (await socket.receive())["type"] != "websocket.disconnect":
        pass


async def _send(socket: WebSocket, start: TelemetryStart, joined: Joined, bench: ServerState) -> None:
    reader, clock = joined.reader, bench.background
    with bench.hub.handing_over(joined):
        await _say(socket, start)
        for first in range(0, start.history_rows, HISTORY_ROWS_A_FRAME):
            time_s = joined.history_time_s[first : first + HISTORY_ROWS_A_FRAME]
            body = encode_body(time_s, joined.history[first : first + HISTORY_ROWS_A_FRAME])
            await socket.send_bytes(reader.frame(len(time_s), body))
    while True:
        await reader.wait()
        await clock.turn()  # many wake with one beat: not all of them before a stop
        for event in reader.take_events():
            await _say(socket, _text(event))
        while (frame := reader.take(clock.now())) is not None:
            await socket.send_bytes(frame)
        if reader.closed is not None:
            await _say(socket, TelemetryGap(reason=reader.closed))
            await socket.close(GONE, reader.closed)
            return


def _text(event: Event) -> TelemetryText:
    if isinstance(event, Status):
        return TelemetryStatus(
            achieved_rate_hz=event.achieved_rate_hz,
            jitter_ms=event.jitter_ms,
            dropped=event.dropped,
            latency_ms=event.latency_ms,
            calls_per_s=event.calls_per_s,
            calls_per_s_possible=event.calls_per_s_possible,
            row_spread_ms=event.row_spread_ms,
        )
    if isinstance(event, MoveSeen):
        return TelemetryMove(axis=event.axis, started_at_s=event.started_at_s)
    if isinstance(event, MotionEnd):
        return TelemetryStopped(
            axis=event.axis,
            reason=event.reason,
            time_s=event.time_s,
            position=event.position,
            detail=event.detail,
        )
    if isinstance(event, ChipEvents):
        return TelemetryEvent(axis=event.axis, seq=event.seq, time_s=event.time_s, names=list(event.names))
    if isinstance(event, ProgramEvent):
        return TelemetryProgram(axis=event.axis, time_s=event.time_s, address=event.address, text=event.text)
    return TelemetryGap(reason=event.reason)


async def _say(socket: WebSocket, message: TelemetryText) -> None:
    await socket.send_text(message.model_dump_json())
