"""Reading and writing: two registers at one address, words that cannot be read, words that reading clears."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from app.clock import VirtualClock
from app.devices.core.config import DeviceConfig
from app.devices.core.register_file import READ_AT_ONCE
from app.devices.core.results import WriteItem
from app.devices.tmc4361.family import compose
from app.errors import OutOfRange, WriteRefused, WrongState
from app.links.port import FramePort, PortTraits
from tests.devices.tmc4361.harness import bench


class Bus:
    """An SPI bus on which every bit reads the same, or some other chip answers."""

    pipelined = True
    name = "spidev 0.0"
    last_exchange_s = 0.0

    def __init__(self, reply: bytes) -> None:
        self.reply = reply
        self.traits = PortTraits(chains=self)

    def device_time_s(self) -> float:
        return 0.0

    async def exchange(self, frame: bytes, timeout_s: float | None = None) -> bytes:
        return self.reply

    async def exchange_chain(self, frames: Sequence[bytes], timeout_s: float | None = None) -> list[bytes]:
        return [self.reply for _ in frames]

    async def aclose(self) -> None:
        pass


async def test_a_chip_says_who_it_is() -> None:
    async with bench(None) as b:
        assert await b.device.identity.probe() == "a TMC4361 answers, version 2, CLK_FREQ 16 MHz"


@pytest.mark.parametrize("reply", [bytes(5), b"\xff" * 5, bytes.fromhex("00 00000011")], ids=["zeros", "ones", "other"])
async def test_a_bus_without_the_chip_is_told_apart(reply: bytes) -> None:
    config = DeviceConfig("x", "tmc4361", {"kind": "spidev", "bus": 0, "device": 0})
    port: FramePort = Bus(reply)
    device = compose("x", config, port, VirtualClock())
    with pytest.raises(WrongState, match=r"no TMC4361"):
        await device.identity.probe()


async def test_reading_and_writing_reach_different_registers_at_one_address() -> None:
    async with bench() as b:
        await b.device.registers.write("ENC_POS", 0, 1234)
        await b.device.registers.write("CL_TR_TOLERANCE", 0, 77)  # 0x52, where ENC_POS_DEV is read
        await b.clock.advance(0.001)
        deviation = (await b.device.registers.read("ENC_POS_DEV", 0)).value
        assert deviation == 1234 - (await b.device.registers.read("XACTUAL", 0)).value
        with pytest.raises(WrongState, match="read only"):
            await b.device.registers.write("ENC_POS_DEV", 0, 1)
        with pytest.raises(WrongState, match="write only"):
            await b.device.registers.read("CL_TR_TOLERANCE", 0)


async def test_a_write_that_cannot_be_read_is_seen_to_arrive() -> None:
    async with bench() as b:
        written = await b.device.registers.write("PID_P", 0, 321)
        assert (written.value, written.written, written.verified) == (321, 321, True)
        assert "arrived" in written.note


async def test_fields_of_a_word_that_cannot_be_read_go_over_what_was_written_before() -> None:
    async with bench() as b:
        # Of the reset's word at first: X1 of MSLUTSEL is 0x80.
        assert (await b.device.registers.write("MSLUTSEL", 0, fields={"W0": 3})).written == 0xFFFF8057
        assert (await b.device.registers.write("MSLUTSEL", 0, fields={"X3": 200})).written == 0xC8FF8057


async def test_all_registers_are_read_without_clearing_any() -> None:
    async with bench() as b:
        await b.device.registers.write("EVENT_CLEAR_CONF", 0, 0)
        before = len(b.port.frames)
        readings = await b.device.registers.read_all(0)
        names = [reading.name for reading in readings]
        assert len(names) == len(set(names)) > 90
        assert "EVENTS" not in names
        assert "CL_TR_TOLERANCE" not in names
        assert not any(frame[0] == 0x0E for frame in b.port.frames[before:])


async def test_reading_many_costs_one_datagram_more_than_there_are_registers() -> None:
    async with bench() as b:
        b.port.frames.clear()
        await b.device.registers.read_all(0, groups=("ramp",))
        read = [frame for frame in b.port.frames if frame[0] != 0x7F]
        chains = len(b.port.frames) - len(read)
        assert chains == -(-len(read) // READ_AT_ONCE)


async def test_several_writes_end_at_the_first_that_cannot_be() -> None:
    async with bench() as b:
        result = await b.device.registers.write_many(
            [WriteItem("VSTART", 0, 256), WriteItem("AMAX", 0, 1 << 24), WriteItem("DMAX", 0, 1)]
        )
        assert [written.name for written in result.done] == ["VSTART"]
        assert isinstance(result.failed, OutOfRange)
        assert result.not_tried == 1


async def test_a_flipped_bit_on_the_way_back_is_no_refusal() -> None:
    async with bench() as b:
        real, left = b.wire.exchange, [1]

        def flip_once(frame: bytes, at_s: float | None = None) -> bytes:
            reply = real(frame, at_s)
            if frame[0] == 0x7F and reply[1:] == (512).to_bytes(4, "big") and left.pop():
                b.wire.exchange = real  # type: ignore[method-assign]  # a wire that errs once
                return reply[:4] + bytes([reply[4] ^ 1])
            return reply

        b.wire.exchange = flip_once  # type: ignore[method-assign]
        written = await b.device.registers.write("VSTOP", 0, 512)
        assert written.verified is True
        assert written.value == 512


async def test_a_chip_that_does_not_take_a_write_is_an_error() -> None:
    async with bench() as b:
        real = b.wire.exchange

        def without(frame: bytes, at_s: float | None = None) -> bytes:  # writes to VSTOP get lost
            return real(b"\x7f" + frame[1:] if frame[0] == 0xA6 else frame, at_s)

        b.wire.exchange = without  # type: ignore[method-assign]
        with pytest.raises(WriteRefused, match="VSTOP"):
            await b.device.registers.write("VSTOP", 0, 999)


@pytest.mark.parametrize("name", ["home_event", "stop_left_en"])
async def test_a_field_by_its_own_name(name: str) -> None:
    async with bench() as b:
        written = await b.device.registers.write(name, 0, 1)
        assert (written.name, written.value) == (name, 1)
