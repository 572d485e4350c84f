"""Datagrams, SPI status, events and resets of an emulated TMC4361."""

from __future__ import annotations

import pytest

from app.links.datagram40 import FETCH, read, write
from app.registers.tmc4361.table import TMC4361
from tests.emulators.tmc4361.rig import TRAPEZOID_POSITION, Ramp, Rig

RST, TARGET_REACHED, VEL_REACHED = 1 << 31, 1 << 0, 1 << 2


@pytest.mark.sheet("DS-TMC4361", "5")
@pytest.mark.sheet("DS-TMC4361", "5.1")
@pytest.mark.sheet("DS-TMC4361", "5.1.1")
def test_the_worked_exchange_is_answered_as_printed() -> None:
    """The data belong to the datagram before: a register after a read, what was written after a write.

    The sheet's example writes VACTUAL, which can only be read; VMAX stands in for it.
    """
    rig = Rig()
    rig.write("XACTUAL", 0x01020304)
    rig.send(FETCH)
    frames = ("2100000000", "2100000000", "a400abcdef", "a400123456", "0000000000")
    replies = [rig.send(bytes.fromhex(frame)).data for frame in frames]
    assert replies[1:] == [0x01020304, 0x01020304, 0x00ABCDEF, 0x00123456]


@pytest.mark.sheet("DS-TMC4361", "5.1.1")
def test_a_write_is_mirrored_as_it_came_even_where_bits_do_not_exist() -> None:
    rig = Rig()
    rig.write("RAMPMODE", 0xFFFFFFFE)
    assert rig.send(FETCH).data == 0xFFFFFFFE
    assert rig.read("RAMPMODE") == 6


@pytest.mark.sheet("DS-TMC4361", "5.1.1")
def test_data_are_latched_right_after_the_datagram_that_asks() -> None:
    rig = Rig()
    rig.ramp(Ramp(), 0)
    rig.send(read(0x21))
    rig.wait(0.1)  # 5000 steps later
    assert rig.send(read(0x21)).data == 0
    assert rig.send(FETCH).data == 5000


@pytest.mark.sheet("DS-TMC4361", "5.2")
@pytest.mark.parametrize("length", [1, 2, 4])
def test_less_than_40_bits_are_no_command_and_show_the_status_first(length: int) -> None:
    rig = Rig()
    rig.write("XACTUAL", 77)
    answer = rig.chip.transfer(write(0x21, 1)[:length])
    assert answer == (bytes((rig.status,)) + (77).to_bytes(4, "big"))[:length]
    assert rig.position == 77


@pytest.mark.sheet("DS-TMC4361", "5.2")
def test_of_more_than_40_bits_the_last_count_and_the_first_leave_again() -> None:
    rig = Rig()
    rig.write("XACTUAL", 5)
    answer = rig.chip.transfer(bytes.fromhex("aabbccddee") + write(0x21, 9))
    assert answer[1:] == (5).to_bytes(4, "big") + bytes.fromhex("aabbccddee")
    assert rig.position == 9


def test_two_chips_in_a_chain_are_written_by_one_long_datagram() -> None:
    first, second = Rig(), Rig()
    sent = write(0x21, 222) + write(0x21, 111)
    second.chip.transfer(first.chip.transfer(sent)[:5] + b"")
    out = first.chip.transfer(sent)
    second.chip.transfer(out)
    assert (first.position, second.position) == (111, 222)


def test_frames_of_another_length_are_refused_by_exchange() -> None:
    with pytest.raises(ValueError, match="5 bytes, or 1 for the status, not 4"):
        Rig().chip.exchange(bytes(4))


def test_addresses_without_a_register_answer_zero_and_take_nothing() -> None:
    rig = Rig()
    known = {row.address for row in TMC4361}
    unknown = [address for address in range(128) if address not in known]
    assert unknown
    before = rig.state()
    for address in unknown:
        rig.write(address, 0xFFFFFFFF)
        assert rig.read(address) == 0
    assert rig.state() == before


def test_registers_hold_their_reset_values_after_power_on() -> None:
    rig = Rig()
    rig.write("EVENT_CLEAR_CONF", 0)
    for row in TMC4361:
        if row.access.readable and not row.when and not row.volatile and row.reset is not None:
            assert rig.read(row.address) == row.reset, row.name


@pytest.mark.sheet("DS-TMC4361", "5.1.2")
def test_what_is_written_to_a_plain_register_reads_back_through_its_mask() -> None:
    rig = Rig()
    active = {"RESET_CLK_GATING", "FREEZE"}
    for row in TMC4361:
        if row.access.readable and row.access.writable and not row.when and not row.volatile and row.name not in active:
            rig.write(row.address, 0x00A5A5A5 & row.write_mask)
            assert rig.read(row.address) & row.write_mask == 0x00A5A5A5 & row.write_mask, row.name


@pytest.mark.sheet("DS-TMC4361", "17.12")
@pytest.mark.sheet("DS-TMC4361", "7.2")
def test_the_status_byte_packs_the_selected_events_in_their_order() -> None:
    rig = Rig()
    assert rig.send(FETCH).status == 1 << 7  # RST_EV is the eighth of the default selection
    rig.write("SPI_STATUS_SELECTION", RST | TARGET_REACHED)
    assert rig.send(FETCH).status == 1 << 1
    rig.write("SPI_STATUS_SELECTION", RST)
    assert rig.send(FETCH).status == 1 << 0


@pytest.mark.sheet("DS-TMC4361", "7.2")
def test_of_more_than_eight_selected_events_the_first_eight_are_told() -> None:
    rig = Rig()
    rig.write("SPI_STATUS_SELECTION", RST | 0xFF)
    assert rig.send(FETCH).status == 0
    rig.write("SPI_STATUS_SELECTION", RST | 0x7F)
    assert rig.send(FETCH).status == 1 << 7


@pytest.mark.sheet("DS-TMC4361", "7")
@pytest.mark.sheet("DS-TMC4361", "17.13")
@pytest.mark.sheet("DS-TMC4361", "7.2")
def test_reading_events_clears_them_but_for_those_that_are_kept() -> None:
    rig = Rig()
    rig.ramp(Ramp(), TRAPEZOID_POSITION)
    rig.write("XTARGET", 100)
    rig.wait(1.0)
    rig.write("EVENT_CLEAR_CONF", TARGET_REACHED)
    first = rig.read("EVENTS")
    assert first & (TARGET_REACHED | RST) == TARGET_REACHED | RST
    assert rig.read("EVENTS") == TARGET_REACHED
    rig.write("EVENT_CLEAR_CONF", 0)
    assert rig.read("EVENTS") == TARGET_REACHED
    assert rig.read("EVENTS") == 0


def test_writing_ones_to_events_clears_those_as_the_later_chip_does() -> None:
    """Open whether a TMC4361-LA does; the choice is named in registers.py."""
    rig = Rig()
    assert rig.state().pins.intr
    rig.write("INTR_CONF", RST)
    rig.write("EVENTS", RST)
    rig.write("EVENT_CLEAR_CONF", 0xFFFFFFFF)
    assert rig.read("EVENTS") & RST == 0


@pytest.mark.sheet("DS-TMC4361", "7.2")
def test_an_event_is_an_edge_and_not_a_level() -> None:
    rig = Rig()
    rig.ramp(Ramp(), TRAPEZOID_POSITION)
    rig.write("XTARGET", 2000)
    rig.wait(0.05)
    assert "VEL_STATE_01" in rig.events()
    rig.wait(0.05)
    assert rig.flag(3)  # still turning, but the event was told
    assert "VEL_STATE_01" not in rig.events()
    rig.wait(1.0)
    assert {"TARGET_REACHED", "VEL_STATE_00"} <= rig.events()
    rig.wait(1.0)
    assert rig.flag(0)
    assert "TARGET_REACHED" not in rig.events()


@pytest.mark.sheet("DS-TMC4361", "1.6")
@pytest.mark.sheet("DS-TMC4361", "7.1")
@pytest.mark.sheet("DS-TMC4361", "17.14")
@pytest.mark.sheet("DS-TMC4361", "7.2")
def test_each_code_of_a_state_of_two_bits_has_an_event() -> None:
    rig = Rig()
    rig.ramp(Ramp(vmax=20_000.0), TRAPEZOID_POSITION)
    rig.events()
    rig.write("XTARGET", 20_000)
    rig.wait(0.01)
    assert {"VEL_STATE_01", "RAMP_STATE_01"} <= rig.events()
    rig.wait(0.5)
    assert rig.events() >= {"RAMP_STATE_00", "VEL_REACHED"}
    rig.wait(0.57)
    assert rig.events() - {"N_ACTIVE"} == {"RAMP_STATE_10"}
    rig.wait(0.2)
    assert rig.events() >= {"RAMP_STATE_00", "VEL_STATE_00", "TARGET_REACHED"}
    rig.write("XTARGET", 0)
    rig.wait(0.01)
    assert {"VEL_STATE_10", "RAMP_STATE_01"} <= rig.events()


@pytest.mark.sheet("DS-TMC4361", "7.2")
def test_intr_is_the_or_of_the_chosen_events_with_its_polarity() -> None:
    rig = Rig()
    rig.write("INTR_CONF", VEL_REACHED)
    assert rig.state().pins.intr  # low active by default
    rig.write("INTR_CONF", VEL_REACHED | RST)
    assert not rig.state().pins.intr
    rig.write("GENERAL_CONF", 0x6020 | 1 << 15)
    assert rig.state().pins.intr
    rig.read("EVENTS")
    assert not rig.state().pins.intr


@pytest.mark.sheet("DS-TMC4361", "17.18")
def test_a_soft_reset_brings_registers_back_and_tells_so() -> None:
    rig = Rig()
    rig.ramp(Ramp(), 1)
    rig.wait(0.5)
    rig.events()
    rig.write("RESET_CLK_GATING", 0x52535400)
    assert rig.events() == {"RST_EV"}
    assert (rig.read("VMAX"), rig.position, rig.read("CLK_FREQ")) == (0, 0, 16_000_000)
    assert rig.state().ramp.kind == "rest"
    rig.write("VMAX", 1)
    rig.write("RESET_CLK_GATING", 0x52535300)  # not the word
    assert rig.read("VMAX") == 1


def test_a_power_cycle_leaves_the_motor_where_it_is() -> None:
    rig = Rig()
    rig.ramp(Ramp(), TRAPEZOID_POSITION)
    rig.write("XTARGET", 20_000)
    rig.wait(2.0)
    stood = rig.state().truth.rotor_fullsteps
    state = rig.patch(power_cycle=True)
    assert state.truth.rotor_fullsteps == pytest.approx(stood)
    assert stood > 70
    assert rig.position == 0


def test_faults_lose_answers_spoil_bits_and_unplug() -> None:
    rig = Rig()
    rig.patch(faults={"silence": True})
    with pytest.raises(TimeoutError):
        rig.write("XACTUAL", 12)
    rig.patch(faults={"silence": False})
    assert rig.position == 12  # obeyed all the same
    rig.patch(faults={"bit_error_rate": 1.0})
    assert rig.send(FETCH).status == (rig.status & 0xFF)
    assert rig.send(read(0x21)).data == 0xFFFFFFFF ^ 2  # VERSION_NO, all bits flipped
    rig.patch(faults={"bit_error_rate": 0.0, "unplugged": True})
    with pytest.raises(ConnectionError):
        rig.read("XACTUAL")


def test_the_version_is_a_documented_choice() -> None:
    assert Rig().read("VERSION_NO") == 2
