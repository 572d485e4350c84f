"""Shapes of TMCL in direct mode: one command, given as fields or as a line of text."""

from __future__ import annotations

from typing import Annotated

from pydantic import Discriminator, Field, StringConstraints, Tag

from ..schemas import Answer, Body

Byte = Annotated[int, Field(strict=True, ge=0, le=255)]
Word = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=24)]


class TmclFields(Body):
    """A command by its four fields."""

    command: Byte | Word = Field(description='opcode or mnemonic, e.g. 4 or "MVP"')
    type: Byte | Word = Field(default=0, description='a number, or a name where the command has names, e.g. "ABS"')
    motor: Byte = Field(default=0, description="motor or bank")
    value: Annotated[int, Field(strict=True, ge=-(1 << 31), le=(1 << 32) - 1)] = Field(
        default=0, description="signed 32 bits; unsigned ones are taken for the same bits"
    )


class TmclLine(Body):
    """A command as one writes it in a program: `MVP ABS, 0, 51200`. Numbers may be decimal, 0x or $ hexadecimal."""

    line: Annotated[str, StringConstraints(strict=True, min_length=1, max_length=120)] = Field(
        description='mnemonic, then up to three operands with commas between them, e.g. "GAP 1, 0"'
    )


def _which(body: object) -> str:
    line = "line" in body if isinstance(body, dict) else isinstance(body, TmclLine)
    return "line" if line else "fields"


TmclCommand = Annotated[
    Annotated[TmclFields, Tag("fields")] | Annotated[TmclLine, Tag("line")],
    Discriminator(_which),
]


class TmclReply(Answer):
    """What the module answered. A status other than 100 is an answer like any other, not an error of this call."""

    request: str = Field(description="9 bytes, hex")
    reply: str | None = Field(description="9 bytes, hex; null where the module answers nothing to this command")
    status: int | None
    status_text: str
    value: int | None
    text: str = Field(description="the whole exchange, readable")
    took_ms: float
