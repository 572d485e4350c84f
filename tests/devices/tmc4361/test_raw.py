"""Raw datagrams: as the chip answers them, and decoded as it means them."""

from __future__ import annotations

import pytest

from app.errors import OutOfRange
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
