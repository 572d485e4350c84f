"""Chips out of register maps with datagrams and names of their own: real driver, plain emulated chip, over TCP too."""

from __future__ import annotations

import itertools
from typing import cast

import numpy as np
import pytest

from app.clock import WallClock
from app.devices.core.config import DeviceConfig
from app.devices.manager import DeviceManager
from app.emulators.build import build_emulator
from app.emulators.listed.chip import PlainChip
from app.emulators.server import serve_tcp
from app.errors import OutOfRange
from app.links.registry import tcp_factory
from app.links.spi_datagram import Request, encode
from app.profiles.capture import capture
from app.profiles.scripts.service import Scripts
from app.registers.catalog import MODELS
from app.registers.entry import Model
from app.registers.maps.models import entry
from app.registers.maps.reader import read
from app.registers.spi_format import SpiFormat
from tests.devices.listed.chip_harness import bench

HEAD = 'format = 1\ntitle = "Own"\naxes = 1\n'
REGISTERS = """
[[register]]
name = "CTRL"
address = 0x0
width = 8
  [[register.field]]
  name = "how"
  lsb = 4
  width = 2
  role = "mode"
  [[register.field]]
  name = "on"
  lsb = 0
[[register]]
name = "GOTO"
address = 0x1
width = 16
signed = true
role = "target"
[[register]]
name = "WHERE"
address = 0x2
width = 16
signed = true
role = "position"
[[register]]
name = "PACE"
address = 0x3
width = 16
signed = true
access = "R"
role = "velocity"
[[register]]
name = "SPEED"
address = 0x4
width = 16
role = "max_velocity"
[[register]]
name = "VMAX"
address = 0x5
width = 16
[[register]]
name = "GAIN"
address = 0x6
width = 16
role = "acceleration"
[[register]]
name = "FLAGS"
address = 0x7
width = 16
role = "status"
reset = 5
  [[register.field]]
  name = "ready"
  lsb = 0
  [[register.field]]
  name = "hot"
  lsb = 1
  [[register.field]]
  name = "level"
  lsb = 2
  width = 3
"""
WIDE = '[[register]]\nname = "WIDE"\naddress = 0x9\nwidth = 53\n'


def own(**spi: object) -> Model:
    keys = "".join(f"{key} = {value if isinstance(value, int) else repr(value)}\n" for key, value in spi.items())
    wide = WIDE if spi.get("data_bits", 32) == 64 else ""
    return entry(read("own", f"{HEAD}[spi]\n{keys}{REGISTERS}{wide}".encode()))


FORMS = [
    {"data_bits": bits, "address_bits": address, "write_bit": place, "write_is": polarity, "byte_order": order,
     "answer": when}
    for (bits, address), (place, polarity), (order, when) in itertools.product(
        ((16, 7), (24, 7), (32, 7), (32, 10), (64, 4)),
        (("high", 1), ("high", 0), ("low", 0)),
        (("big", "next"), ("little", "same")),
    )
]  # fmt: skip


@pytest.mark.parametrize("spi", FORMS, ids=lambda spi: "-".join(str(value) for value in spi.values()))
async def test_registers_motion_and_samples_in_every_format(spi: dict[str, object]) -> None:
    async with bench(own(**spi)) as made:
        device = made.device
        for name, value in (("CTRL", 1), ("VMAX", 0x1234), ("GOTO", 0)):
            done = await device.registers.write(name, 0 if name == "NONE" else None, value)
            assert done.verified, (name, done.note)
        if spi["data_bits"] == 64:
            done = await device.registers.write("WIDE", None, (1 << 53) - 1)
            assert (done.verified, done.value) == (True, (1 << 53) - 1)
        await device.motion.move(0, -1000)
        await made.clock.advance(10.0)
        state = await device.monitor.axis_state(0)
        assert (state.position, state.position_reached) == (-1000, True)
        assert state.flags == {"ready": True, "hot": False}
        channels = ["position.0", "velocity.0", "VMAX.0", "FLAGS.level.0"]
        if spi["data_bits"] == 64:
            channels.append("WIDE.0")
        plan = device.telemetry.sample_plan(channels)
        taken = await device.telemetry.take_samples(plan)
        columns = plan.decode(np.asarray(taken.times_s), taken.replies[0])
        assert columns[0].tolist() == [
            -1000.0,
            0.0,
            0x1234,
            1.0,
            *([float((1 << 53) - 1)] if len(columns[0]) > 4 else []),
        ]
        await device.motion.rotate(0, 300, "chip")
        await made.clock.advance(5.0)
        assert (await device.monitor.axis_state(0)).velocity_pps == 300
        (stopped,) = await device.motion.stop_axes([0], "ramp")
        assert stopped.problem is None


async def test_a_role_goes_before_a_name() -> None:
    async with bench(own()) as made:
        done = await made.device.registers.write("VMAX", None, 0)
        assert done.verified
        await made.device.motion.move(0, 50)
        await made.clock.advance(5.0)
        assert (await made.device.monitor.axis_state(0)).position == 50


@pytest.mark.parametrize("answer", ["next", "same"])
async def test_single_frames_are_those_of_the_format(answer: str) -> None:
    form = SpiFormat(16, 10, answer=answer)  # type: ignore[arg-type]
    async with bench(own(data_bits=16, address_bits=10, answer=answer)) as made:
        wrote = await made.device.raw.exchange(encode(form, Request(5, True, 77)))
        assert (wrote.decoded["register"], wrote.decoded["value"], wrote.decoded["rw"]) == ("VMAX", 77, "write")
        back = await made.device.raw.exchange(encode(form, Request(5, False)))
        assert (back.decoded["register"], back.decoded["value"], back.decoded["rw"]) == ("VMAX", 77, "read")
        with pytest.raises(OutOfRange, match="frame length"):
            await made.device.raw.exchange(b"\0\0\0")


@pytest.mark.parametrize("spi", [FORMS[2], FORMS[10], FORMS[21], FORMS[28]], ids=str)
async def test_over_tcp_with_two_clients(spi: dict[str, object]) -> None:
    """Each sees the chip as if it were alone, whenever the answers come."""
    MODELS["own"] = own(**spi)
    clock = WallClock()
    chip = cast("PlainChip", build_emulator("own", clock))
    manager = DeviceManager({"tcp": tcp_factory}, clock)
    server = await serve_tcp(chip, "127.0.0.1", 0)
    try:
        async with server:
            link = {"kind": "tcp", "host": "127.0.0.1", "port": server.sockets[0].getsockname()[1]}
            first = await manager.add(DeviceConfig("First", "own", link))
            second = await manager.add(DeviceConfig("Second", "own", link))
            for number in range(20):
                assert (await first.registers.write("VMAX", None, number)).verified
                assert (await second.registers.read("VMAX", None)).value == number
            await manager.close()
    finally:
        await manager.close()
        del MODELS["own"]


@pytest.mark.parametrize("spi", FORMS[::7], ids=str)
async def test_a_profile_as_c_sends_the_same(spi: dict[str, object]) -> None:
    async with bench(own(**spi)) as made:
        await made.device.registers.write("VMAX", None, 0x1234)
        document = await capture(made.device)
        script = Scripts().make(document, "c")
        if spi["data_bits"] == 64:
            with pytest.raises(Exception, match="more than 32 bits"):
                await script
        else:
            assert (await script).checked.registers == 3
