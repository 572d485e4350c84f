"""Registers, one or many, and raw datagrams. A write is read back before it is reported as done."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query, Request

from ...devices.core.actor import actor
from ...devices.core.results import WriteItem
from ...errors import SoftLimit, WriteRefused
from ..abilities import CurrentStore
from ..audit import wording
from ..deps import AxisQuery, CurrentDevice, DeviceId, RegisterName, device_of
from ..devices.views import batch_result
from ..http.errors import ForeignPage, RoleTooLow
from ..http.guard import require_own_page
from ..http.identity import identity_of
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router
from ..schemas import (
    Exchange,
    ExchangeReply,
    RegisterBatch,
    RegisterBatchResult,
    RegisterReading,
    RegisterWrite,
    RegisterWritten,
)

router = subject_router(prefix="/devices/{device}", tags=["registers"])

GroupQuery = Annotated[
    list[str] | None,
    Query(description="only these groups of the catalog's rows: a slow wire is not asked for more", max_length=64),
]

KeptQuery = Annotated[
    bool, Query(description="also those that cannot be read, where the driver knows what they hold: marked `kept`")
]


@router.get("/registers", responses=problems(*DEVICE_PROBLEMS))
async def list_registers(
    device: CurrentDevice, axis: AxisQuery = None, group: GroupQuery = None, kept: KeptQuery = False
) -> list[RegisterReading]:
    """Every readable register, from the device; with `axis` or `group` only those of that axis or those groups."""
    readings = await device.registers.read_all(axis, group or ())
    if kept:
        readings += device.registers.kept(axis, group or ())
    return [RegisterReading.model_validate(reading) for reading in readings]


@router.post("/registers", responses=problems(*DEVICE_PROBLEMS, SoftLimit))
@policy(audit="told by drivers", partly=True, words=wording.batch)
async def write_registers(device: CurrentDevice, body: RegisterBatch) -> RegisterBatchResult:
    """Write several in order; the first that fails ends it, and the answer says how far it came."""
    items = [WriteItem(item.name, item.axis, item.value, item.fields) for item in body.writes]
    return batch_result(await device.registers.write_many(items))


@router.get("/registers/{name}", responses=problems(*DEVICE_PROBLEMS, ForeignPage, RoleTooLow))
async def read_register(
    request: Request, device: DeviceId, name: RegisterName, axis: AxisQuery = None
) -> RegisterReading:
    """Read one register, or a field by its own name, past any cache. Where reading clears it, this is a change."""
    # The call that scripts poll with: without the dependency it is a quarter faster.
    asked = device_of(request, device)
    if asked.registers.clears_when_read(name, axis):  # whoever only looks must not take an event from whoever works
        require_own_page(request.scope)
        identity_of(request.scope).require("drive", f"reading {name}, which clears it,")
        request.app.state.bench.lease.require(actor.get().session)
    return RegisterReading.model_validate(await asked.registers.read(name, axis))


@router.put("/registers/{name}", responses=problems(*DEVICE_PROBLEMS, SoftLimit, WriteRefused))
@policy(audit="told by drivers", words=wording.write)
async def write_register(
    device: CurrentDevice, name: RegisterName, body: RegisterWrite, axis: AxisQuery = None
) -> RegisterWritten:
    """Write one register, whole or some of its fields; answers with the read-back."""
    return RegisterWritten.model_validate(await device.registers.write(name, axis, body.value, body.fields))


@router.post("/registers/{name}/store", responses=problems(*DEVICE_PROBLEMS))
@policy(words=wording.of_register("store"))
async def store_register(device: CurrentStore, name: RegisterName, axis: AxisQuery = None) -> RegisterReading:
    """Copy what a parameter is now to the EEPROM, from where it comes back after power-on."""
    return RegisterReading.model_validate(await device.store(name, axis))


@router.post("/registers/{name}/restore", responses=problems(*DEVICE_PROBLEMS))
@policy(audit="told by drivers", words=wording.of_register("restore"))
async def restore_register(device: CurrentStore, name: RegisterName, axis: AxisQuery = None) -> RegisterReading:
    """Make a parameter what the EEPROM holds; answers with what it is now."""
    return RegisterReading.model_validate(await device.restore(name, axis))


@router.post("/exchange", responses=problems(*DEVICE_PROBLEMS, SoftLimit))
@policy(audit="told by drivers", words=wording.exchange, changed_nothing=wording.read_only)
async def exchange_frame(device: CurrentDevice, body: Exchange) -> ExchangeReply:
    """Send one raw datagram as it is, past every check but its length."""
    raw = await device.raw.exchange(bytes.fromhex(body.frame))
    return ExchangeReply(reply=raw.reply.hex(), decoded=raw.decoded)
