"""What a frame of the log says, for people: TMCL commands and 32-bit datagrams."""

from __future__ import annotations

from app.devices.pd42.frames import spelled
from app.links import datagram32, tmcl
from app.links.errors import BadReply
from app.registers.catalog import MODELS
from app.registers.model import RegisterTable
from app.registers.tmcl import Opcode, Status


def frame_text(model: str, tx: bytes, rx: bytes | None) -> str:
    """One transaction with a `model`: the question, and the answer where there is one."""
    if len(tx) == tmcl.FRAME_BYTES:
        return _tmcl(tx, rx)
    if len(tx) == datagram32.FRAME_BYTES:
        return _datagram(MODELS[model].table, tx, rx)
    return f"{len(tx)} bytes"


def _tmcl(tx: bytes, rx: bytes | None) -> str:
    request = tmcl.Request.decode(tx)
    asked = spelled(request)
    if not rx:
        return asked
    try:
        reply = tmcl.check_reply("", tx, rx)
    except BadReply:
        return f"{asked} -> ?"
    if not reply.ok:
        return f"{asked} -> {reply.status_text} ({reply.status})"
    if request.opcode == Opcode.GET_VERSION and not tmcl.has_plain_reply(tx) and not tmcl.sound(rx):
        return f"{asked} -> {tmcl.version_string(rx)}"
    if reply.status == Status.STORED:
        return f"{asked} -> {reply.status_text}"
    return f"{asked} -> {reply.value}"


def _datagram(table: RegisterTable, tx: bytes, rx: bytes | None) -> str:
    request = datagram32.Request.decode(tx)
    register = table.at(request.address)
    if register is None:
        name = f"{request.address:#04x}"
    else:
        name = register.name if register.axis is None else f"{register.name}.{register.axis}"

    def shown(data: int) -> str:
        return f"{data:#08x}" if register is None or register.fields else str(register.decode(data))

    if not request.read:
        return f"{name} := {shown(request.data)}"
    if rx is None or len(rx) != datagram32.FRAME_BYTES:
        return f"read {name}"
    return f"read {name} -> {shown(datagram32.Reply.decode(rx).data)}"
