"""An emulated TMC428 whose chain has drivers with motors: what they are set to changes what the motors do."""

from __future__ import annotations

import math

import pytest

from app.calc.driver_chain.chain import build_chain
from app.calc.microsteps.datagrams import table_ram_words
from app.clock import VirtualClock
from app.emulators.tmc428.device import EmulatedDevice
from app.emulators.tmc428.options import EmulatorOptions, EmulatorPatch
from app.errors import WrongState
from app.links import datagram32

CHOPPER = 0x9_01B5
COVER, COVER_DATAGRAM, LOW, HIGH = 0x32, 0x33, 0x30, 0x31
SINE = [round(63 * math.sin(math.pi / 2 * n / 64)) for n in range(64)]
SG, OT, OTPW, S2GA, S2GB, OLA, OLB, STST = (1 << n for n in range(8))


class Rig:
    """The chip with its drivers; time is the test's."""

    def __init__(self, drivers: list[str], **options: object) -> None:
        told = [{"driver": driver} for driver in drivers]
        self.device = EmulatedDevice(
            "tmc428", VirtualClock(), EmulatorOptions.model_validate({"drivers": told, **options})
        )
        self.drivers = drivers
        self.time_s = 0.0
        chain = build_chain(drivers)
        for n, word in enumerate(chain.ram_words):
            self.write(0x40 + n, word)
        for n, word in enumerate(table_ram_words(SINE)):
            self.write(0x60 + n, word)
        self.write(0x3F, len(drivers) - 1 | 7 << 8)

    def write(self, address: int, data: int) -> None:
        self.device.exchange(datagram32.write(address, data), self.time_s)

    def read(self, address: int) -> int:
        return datagram32.Reply.decode(self.device.exchange(datagram32.read(address), self.time_s)).data

    def wait(self, seconds: float) -> None:
        self.time_s += seconds
        self.device.state(self.time_s)

    def place(self, axis: int) -> tuple[int, int, int]:
        lengths = [20 if driver == "tmc2660" else 12 for driver in self.drivers]
        return sum(lengths[:axis]), lengths[axis], sum(lengths)

    def cover(self, axis: int, word: int) -> int:
        """Send a word to one driver; what it answered, as far as 48 bits have it."""
        first, length, total = self.place(axis)
        self.write(COVER, first << 8 | length)
        self.write(COVER_DATAGRAM, word)
        self.wait(0.001)
        stored = self.read(HIGH) << 24 | self.read(LOW)
        return stored >> total - first - length & (1 << length) - 1

    def set_up(self, axis: int, cs: int = 20, sgt: int = 5) -> None:
        self.cover(axis, 0xE_0090)  # SDOFF, load value
        self.cover(axis, 0xC_0000 | sgt << 8 | cs)
        self.cover(axis, CHOPPER)

    def move(self, axis: int, target: int) -> None:
        base = axis << 4
        self.write(base | 0x9, 0)
        self.write(base | 0xC, 6 << 12 | 7 << 8 | 4)  # sixteenths, 2.9 kpps at v_max 1500
        self.write(base | 0x2, 1)
        self.write(base | 0x3, 1500)
        self.write(base | 0x6, 200)
        self.write(base | 0x9, 128 - 128 << 8 | 4)
        self.write(base | 0xA, 0)
        self.write(base | 0x0, target & 0xFF_FFFF)

    def patch(self, axis: int, **change: object) -> None:
        self.device.patch(EmulatorPatch.model_validate({"drivers": [{"axis": axis, **change}]}), self.time_s)

    def truth(self, axis: int):  # type: ignore[no-untyped-def]
        chain = self.device.state(self.time_s).driver_chain
        assert chain is not None
        return chain.drivers[axis].truth

    def position(self, axis: int) -> float:
        return self.device.state(self.time_s).axes[axis].position_fullsteps


def test_the_motor_turns_as_the_currents_of_its_driver_let_it() -> None:
    rig = Rig(["tmc2660"] * 3)
    for axis in range(3):
        rig.set_up(axis)
    rig.move(1, 3200)
    rig.wait(3.0)
    assert rig.read(0x11) == 3200
    assert rig.truth(1).rotor_fullsteps == pytest.approx(3750 + 200, abs=1.5)
    assert rig.position(1) == pytest.approx(3950, abs=1.5)
    assert rig.truth(0).rotor_fullsteps == pytest.approx(3750, abs=1)
    assert abs(rig.truth(1).lost_fullsteps) == 0


def test_a_driver_that_is_off_turns_nothing_and_its_carriage_stays() -> None:
    rig = Rig(["tmc2660"] * 2)
    rig.set_up(0)
    rig.move(1, 1600)
    rig.move(0, 1600)
    rig.wait(2.0)
    assert rig.read(0x11) == 1600
    assert rig.position(1) == pytest.approx(3750, abs=0.1)
    assert rig.position(0) == pytest.approx(3850, abs=1.5)


def test_too_little_current_for_the_load_loses_steps() -> None:
    def ends(cs: int) -> float:
        rig = Rig(["tmc2660"])
        rig.set_up(0, cs=cs)
        rig.patch(0, friction=0.3)
        rig.move(0, 3200)
        rig.wait(3.0)
        return rig.position(0)

    assert ends(31) == pytest.approx(3950, abs=2)
    assert ends(2) < 3800


@pytest.mark.parametrize(
    ("change", "flags"),
    [
        ({"motor": {"temperature_c": 110.0}}, OTPW),
        ({"motor": {"temperature_c": 160.0}}, OT | OTPW),
        ({"motor": {"connected": False}}, OLA | OLB),
        ({"motor": {"short_to_ground": "a"}}, S2GA),
    ],
)
def test_one_of_three_says_what_is_wrong(change: dict[str, object], flags: int) -> None:
    rig = Rig(["tmc2660"] * 3)
    for axis in range(3):
        rig.set_up(axis)
    rig.wait(0.1)  # switched on they have jumped to where their currents are
    rig.patch(1, **change)
    rig.wait(0.01)
    answers = [rig.cover(axis, 0xE_0090) & 0xFF & ~STST for axis in range(3)]
    assert answers == [0, flags, 0]


def test_a_blocked_shaft_stalls() -> None:
    rig = Rig(["tmc2660"] * 3)
    for axis in range(3):
        rig.set_up(axis, sgt=0)
        rig.move(axis, 100_000)
    rig.wait(1.0)
    rig.patch(2, blocked=True)
    rig.wait(0.3)
    assert [rig.cover(axis, 0xE_0090) & SG for axis in range(3)] == [0, 0, 1]


def test_an_answer_has_what_48_bits_keep() -> None:
    rig = Rig(["tmc2660"] * 3)
    for axis in range(3):
        rig.set_up(axis)
        rig.cover(axis, 0xE_00A0)  # load value and current scale
    rig.wait(0.01)
    assert [rig.cover(axis, 0xE_00A0) >> 10 & 0x1F for axis in range(3)] == [0, 20, 20], "of the first only the flags"


def test_drivers_of_both_kinds_share_a_chain() -> None:
    rig = Rig(["tmc236", "tmc2660", "tmc236"])
    rig.set_up(1)
    rig.move(0, 1600)
    rig.move(1, 1600)
    rig.wait(2.0)
    assert rig.position(0) == 3850
    assert rig.position(1) == pytest.approx(3850, abs=1.5)
    rig.patch(0, status=0x123)
    assert rig.cover(0, 0) == 0x123
    with pytest.raises(WrongState, match="follows from what is so"):
        rig.patch(1, status=0)
    with pytest.raises(WrongState, match="no motor"):
        rig.patch(0, blocked=True)


def test_a_chain_set_up_for_other_drivers_shifts_bits_where_they_do_not_belong() -> None:
    rig = Rig(["tmc2660"] * 2)
    for n, word in enumerate(build_chain(["tmc236", "tmc236"]).ram_words):
        rig.write(0x40 + n, word)
    rig.set_up(0)
    rig.move(0, 1600)
    rig.wait(2.0)
    assert rig.position(0) == pytest.approx(3750, abs=3)


def test_switches_are_where_the_shaft_is() -> None:
    rig = Rig(["tmc2660"], stages=[{"right_at_fullsteps": 3800.0}])
    rig.set_up(0)
    rig.patch(0, blocked=True)
    rig.move(0, 16_000)
    rig.wait(2.0)
    state = rig.device.state(rig.time_s).axes[0]
    assert (state.switches.right.active, round(state.position_fullsteps)) == (False, 3750)


def test_time_in_pieces_makes_no_difference() -> None:
    def end(pieces: int) -> tuple[object, ...]:
        rig = Rig(["tmc2660"] * 2)
        for axis in range(2):
            rig.set_up(axis)
            rig.move(axis, 800)
        for _ in range(pieces):
            rig.wait(0.5 / pieces)
        rig.time_s = round(rig.time_s, 6)
        return rig.read(0x01), rig.truth(0), rig.truth(1)

    assert end(1) == end(50)


def test_a_power_cycle_leaves_shafts_and_forgets_registers() -> None:
    rig = Rig(["tmc2660"])
    rig.set_up(0)
    rig.move(0, 1600)
    rig.wait(2.0)
    before = rig.position(0)
    rig.device.patch(EmulatorPatch(power_cycle=True), rig.time_s)
    rig.wait(0.5)
    assert rig.position(0) == pytest.approx(before, abs=0.5)
    assert rig.truth(0).current_a_a == 0


def test_what_acts_on_the_motor_of_a_driver_is_told_as_it_was_changed() -> None:
    rig = Rig(["tmc2660", "tmc236"])
    rig.patch(0, load_torque_nm=0.05, friction=0.01, blocked=True, supply_v=30.0)
    chain = rig.device.state(rig.time_s).driver_chain
    assert chain is not None
    load = chain.drivers[0].load
    assert load is not None
    assert (load.load_torque_nm, load.friction, load.blocked, load.supply_v) == (0.05, 0.01, True, 30.0)
    assert chain.drivers[1].load is None
