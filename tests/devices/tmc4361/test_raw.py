"""Raw datagrams: as the chip answers them, and decoded as it means them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.errors import OutOfRange, UsageError, WrongState
from tests.devices.tmc4361.harness import bench


def frame(text: str) -> bytes:
    return bytes.fromhex(text)


@pytest.mark.sheet("DS-TMC4361", "5.1")
async def test_the_reply_belongs_to_the_datagram_before() -> None:
    """The data sheet's example, with VMAX in the place of VACTUAL, which is read only."""
    async with bench() as b:
        await b.device.registers.write("XACTUAL", 0, 0x1234)
        data = []
        for sent in ("21 00000000", "21 00000000", "A4 00ABCDEF", "A4 00123456", "24 00000000"):
            raw = await b.device.raw.exchange(frame(sent))
            data.append(raw.reply[1:].hex())
        assert data[1:] == ["00001234", "00001234", "00abcdef", "00123456"]


async def test_what_a_read_brings_is_decoded_at_once() -> None:
    async with bench() as b:
        raw = await b.device.raw.exchange(frame("24 00000000"))
        assert (raw.decoded["register"], raw.decoded["rw"], raw.decoded["value"]) == ("VMAX", "read", 50_000 * 256)
        raw = await b.device.raw.exchange(frame("52 00000000"))
        assert raw.decoded["register"] == "ENC_POS_DEV"
        raw = await b.device.raw.exchange(frame("D2 00000007"))
        assert (raw.decoded["register"], raw.decoded["value"]) == ("CL_TR_TOLERANCE", 7)


async def test_a_raw_target_is_predicted_and_ends_what_was() -> None:
    async with bench() as b:
        raw = await b.device.raw.exchange(frame("B7") + (9_000).to_bytes(4, "big"))
        assert raw.decoded["register"] == "XTARGET"
        expected = b.device.motion.prediction(0)
        assert expected is not None
        await b.clock.advance(expected.duration_s + 0.01)
        assert (await b.state()).position == 9_000


async def test_reading_events_raw_is_never_done_twice() -> None:
    async with bench() as b:
        b.port.frames.clear()
        raw = await b.device.raw.exchange(frame("0E 00000000"))
        assert b.port.frames == [frame("0E 00000000")]
        assert raw.decoded["data"] is None


async def test_the_status_byte_has_names() -> None:
    async with bench() as b:
        await b.device.identity.refresh()
        flags = (await b.device.raw.exchange(frame("7F 00000000"))).decoded["flags"]
        assert isinstance(flags, dict)
        assert list(flags) == [
            "TARGET_REACHED",
            "VEL_REACHED",
            "STOPL_EVENT",
            "STOPR_EVENT",
            "HOME_ERROR",
            "FS_ACTIVE",
            "COVER_DONE",
            "RST_EV",
        ]


@pytest.mark.parametrize("sent", ["", "21 0000", "21 00000000 00"])
async def test_a_datagram_of_another_length_names_the_length(sent: str) -> None:
    async with bench() as b:
        with pytest.raises(OutOfRange, match=r"5\.\.5"):
            await b.device.raw.exchange(frame(sent))


@pytest.mark.sheet("DS-TMC4361", "5.2")
async def test_eight_clocks_bring_the_status_and_leave_the_pipeline_as_it_was() -> None:
    async with bench() as b:
        await b.device.registers.read("SPI_STATUS_SELECTION", 0)
        await b.device.registers.write("EVENT_CLEAR_CONF", 0, 0xFFFF_FFFF)  # what has come stays
        await b.device.motion.move(0, 500)
        await b.clock.advance(2.0)
        await b.device.raw.exchange(frame("A4 00ABCDEF"))
        for _ in range(2):
            raw = await b.device.raw.exchange(frame("00"))
            assert (len(raw.reply), raw.decoded["rw"], raw.decoded["register"]) == (1, "read", None)
        assert raw.decoded["status"] == raw.reply[0]
        flags = raw.decoded["flags"]
        assert isinstance(flags, dict)
        assert sum(value << place for place, value in enumerate(flags.values())) == raw.reply[0]
        assert flags["TARGET_REACHED"]
        behind = await b.device.raw.exchange(frame("24 00000000"))
        assert behind.reply.hex() == f"{raw.reply[0]:02x}00abcdef"
        with pytest.raises(UsageError, match="eight clocks write nothing"):
            await b.device.raw.exchange(frame("A4"))
        with pytest.raises(OutOfRange):
            await b.device.raw.exchange(frame("A4 00"))


async def test_a_link_of_whole_datagrams_says_that_it_cannot_carry_eight_clocks() -> None:
    async with bench() as b:
        b.device.session.port.traits = replace(b.device.session.port.traits, cuts=False)  # type: ignore[misc]
        assert not b.device.raw.status_alone
        with pytest.raises(WrongState, match="none of eight clocks"):
            await b.device.raw.exchange(frame("00"))
