"""The tables in the chip's RAM (microsteps, driver chain), and the whole configuration as a document."""

from __future__ import annotations

from fastapi import APIRouter

from app.api.convert import axis_config, built_chain, chain_table, profile_register
from app.api.deps import CurrentDevice
from app.api.problems import DEVICE_PROBLEMS, problems
from app.api.schemas_tables import ChainTable, DriverChain, MicrostepTable, Profile
from app.links.errors import WriteRefused

router = APIRouter(prefix="/devices/{device}", tags=["tables"])


@router.get("/microstep-table", responses=problems(*DEVICE_PROBLEMS))
async def read_microstep_table(device: CurrentDevice) -> MicrostepTable:
    """The 64 values of the quarter wave that the chip holds."""
    return MicrostepTable(values=await device.read_microstep_table())


@router.put("/microstep-table", responses=problems(*DEVICE_PROBLEMS, WriteRefused))
async def write_microstep_table(device: CurrentDevice, body: MicrostepTable) -> MicrostepTable:
    """Write all 64 values, also while the motor runs; answers with the read-back."""
    return MicrostepTable(values=await device.write_microstep_table(body.values))


@router.get("/driver-chain", responses=problems(*DEVICE_PROBLEMS))
async def read_driver_chain(device: CurrentDevice) -> ChainTable:
    """The driver chain that the chip's RAM describes, bit by bit."""
    held = await device.read_driver_chain()
    return chain_table(held.ram_words, held.lsmd)


@router.put("/driver-chain", responses=problems(*DEVICE_PROBLEMS, WriteRefused))
async def write_driver_chain(device: CurrentDevice, body: DriverChain) -> ChainTable:
    """Configure the chain from a list of drivers; answers with the read-back."""
    chain = built_chain(body.drivers)
    held = await device.write_driver_chain(chain.ram_words, chain.lsmd)
    return chain_table(held.ram_words, held.lsmd)


@router.get("/profile", responses=problems(*DEVICE_PROBLEMS))
async def get_profile(device: CurrentDevice) -> Profile:
    """The device's whole configuration as a document."""
    document = await device.profile()
    return Profile(
        name=device.name,
        model=device.model,
        clock_hz=device.clock_hz,
        axes=[axis_config(axis.settings) for axis in device.axes],
        registers=[profile_register(entry, device.family.table) for entry in document.registers],
        microstep_table=document.microstep_table,
        driver_chain=document.driver_chain,
    )
