"""Shapes of what goes on on a link: its frames, its budget, its incidents; and of the search for modules."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints

from ...registers.names import AnyModelName
from ..schemas import Answer, Body


class FrameEntry(Answer):
    """One transaction of the log."""

    seq: int
    time_unix_s: float
    priority: Literal["stop", "command", "sample"]
    tx: str = Field(description="hex")
    rx: str | None = Field(description="hex; null where nothing came")
    took_ms: float
    text: str = Field(description="decoded: what was asked, and what came back")
    error: str | None = Field(description="why there is no good answer")


class FrameLog(Answer):
    """A stretch of the log, oldest first."""

    frames: list[FrameEntry]
    next: int = Field(description="`after` of the next call")
    lost: int = Field(description="entries from `after` on that are not here: overwritten, or more than `limit`")


class LinkCounts(Answer):
    """What has happened on this link since it was made."""

    stops: int = Field(description="frames of stops")
    commands: int = Field(description="frames of commands")
    samples: int = Field(description="frames of telemetry")
    waited: int = Field(description="turns that found the link busy")
    overtaken: int = Field(description="times that a turn gave way to a more urgent one between two frames")
    samples_dropped: int = Field(description="samples that found the link too busy")
    timeouts: int
    failures: int = Field(description="failed exchanges of any kind, timeouts included")
    incidents: dict[str, int] = Field(description="by kind; also those that the list no longer holds")


class LinkIncident(Answer):
    """Something on the wire went wrong and was mended, or not."""

    time_unix_s: float
    kind: str
    text: str


class LinkInfo(Answer):
    """The wire of one device: what it can carry, what it carries, and what went wrong on it lately."""

    name: str
    kind: str
    baud: int | None = Field(description="null where the link has no such limit (emulators, TCP, USB)")
    calls_per_s_possible: float | None = Field(description="one call is a frame and its reply; null without a limit")
    calls_per_s: float = Field(description="calls of all devices on this wire, mean of two seconds")
    share: float | None = Field(description="used over possible, 0..1; null without a limit")
    counts: LinkCounts
    incidents: list[LinkIncident] = Field(description="newest first")
    shared_with: list[str] = Field(description="ids of other devices on the same wire")
    status_alone: bool = Field(
        description="the chip's status can be asked for by eight clocks: POST exchange with the frame 00"
    )


Baud = Annotated[int, Field(strict=True, ge=300, le=4_000_000)]
Address = Annotated[int, Field(strict=True, ge=1, le=255)]


AddressOrNode = Annotated[int, Field(strict=True, ge=0, le=255)]


class ProbeStart(Body):
    """Where to look, and for whom. Each baud rate and each address costs a question, and the wait for its answer."""

    port: Annotated[str, StringConstraints(strict=True, min_length=1, max_length=200)] = Field(
        description="device name, or an address of pyserial: socket://, rfc2217://, spy://"
    )
    bauds: Annotated[list[Baud], Field(min_length=1, max_length=16)] | None = Field(
        default=None, description="null: the rates that modules use"
    )
    addresses: Annotated[list[AddressOrNode], Field(min_length=1, max_length=255)] | None = Field(
        default=None, description="null: the first ones; modules have 1..255, nodes of chips are 0..254"
    )
    kind: Literal["modules", "chips"] = Field(
        default="modules", description="modules and evaluation boards, which speak TMCL; or chips on a UART"
    )


class ProbeFound(Answer):
    """A module, an evaluation board, or a chip on a UART, that answered."""

    kind: Literal["module", "board", "chip"] = Field(
        description="how it is reached: by a link of kind serial (or tcp), landungsbruecke, or uart"
    )
    port: str
    baud: int | None = Field(description="null where the line has no baud rate")
    address: int = Field(description="of a chip its node; 0 where it has none")
    model: AnyModelName | None = Field(
        description="the module's, or that of the chip on the board; null where stepscope has no driver for it"
    )
    board: str | None = Field(
        description='null for a module; else "Landungsbrücke with TMC4361A": reached by a link of kind landungsbruecke'
    )
    module: int = Field(description="the number that the module calls itself by, e.g. 1241; of a chip its version")
    version: str = Field(description='as the module tells it, e.g. "1241V144"; of a chip "version 0x30"')
    candidates: list[str] = Field(
        default=[],
        description="of a chip on a UART: further models whose lists have a version at that place and do not tell "
        "which number it is; of these one has to choose",
    )


class ProbeState(Answer):
    """The search for modules that runs, or the latest one."""

    running: bool
    done: int = Field(description="questions asked")
    total: int
    port: str | None
    found: list[ProbeFound]
    message: str
