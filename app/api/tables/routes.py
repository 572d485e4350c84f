"""The tables in the chip's RAM: microsteps and the driver chain."""

from __future__ import annotations

from ...devices.core.capabilities import DriverChainRam, MicrostepRam, MslutTable
from ...errors import UsageError, WriteRefused
from ..audit import wording
from ..deps import AxisQuery, CurrentDevice
from ..devices.views import built_chain, chain_table
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router
from .mslut import has_mslut, held, registers_to_write
from .mslut_schemas import MslutWrite
from .schemas import AnyTable, AnyTableIn, ChainTable, DriverChain, MicrostepTable

router = subject_router(prefix="/devices/{device}", tags=["tables"])


@router.get("/microstep-table", responses=problems(*DEVICE_PROBLEMS))
async def read_microstep_table(device: CurrentDevice, axis: AxisQuery = None) -> AnyTable:
    """The quarter wave that the chip holds: 64 values of a TMC428; of a chip with an MSLUT 256, and its registers.

    Of a TMC5031 or TMC5062, which have two tables, that of axis 0 unless `axis` says otherwise.
    """
    if has_mslut(device.family.table):
        return held(await device.need(MslutTable).read_mslut(axis or 0), device.family.table, axis or 0)
    return MicrostepTable(values=await device.need(MicrostepRam).read_microstep_table())


@router.put("/microstep-table", responses=problems(*DEVICE_PROBLEMS, WriteRefused))
@policy(words=wording.done("write table", "microstep table"))
async def write_microstep_table(device: CurrentDevice, body: AnyTableIn, axis: AxisQuery = None) -> AnyTable:
    """Write a whole table, also while the motor runs; answers with what the chip then holds.

    Where a chip has a table for each axis, all of them get it unless `axis` names one.

    A wave that an MSLUT cannot hold is refused, naming the entry and the reason.
    """
    if has_mslut(device.family.table):
        if isinstance(body, MicrostepTable):
            raise UsageError(f"a {device.family.title} holds 256 values of 0..255, or the registers themselves")
        return held(
            await device.need(MslutTable).write_mslut(registers_to_write(body), axis), device.family.table, axis or 0
        )
    if isinstance(body, MslutWrite):
        raise UsageError(f"a {device.family.title} holds 64 values of 0..63")
    return MicrostepTable(values=await device.need(MicrostepRam).write_microstep_table(body.values))


@router.get("/driver-chain", responses=problems(*DEVICE_PROBLEMS))
async def read_driver_chain(device: CurrentDevice) -> ChainTable:
    """The driver chain that the chip's RAM describes, bit by bit."""
    held = await device.need(DriverChainRam).read_driver_chain()
    return chain_table(held.ram_words, held.lsmd)


@router.put("/driver-chain", responses=problems(*DEVICE_PROBLEMS, WriteRefused))
@policy(words=wording.with_body("write table", "driver chain"))
async def write_driver_chain(device: CurrentDevice, body: DriverChain) -> ChainTable:
    """Configure the chain from a list of drivers; answers with the read-back."""
    chain = built_chain(body.drivers)
    held = await device.need(DriverChainRam).write_driver_chain(chain.ram_words, chain.lsmd)
    return chain_table(held.ram_words, held.lsmd)
