"""A driver moved by the steps of a controller: none lost, none invented, each in its time."""

from __future__ import annotations

import random
from typing import Any

import pytest

from app.clock import VirtualClock
from app.emulators.build import build_emulator, options_of
from app.emulators.tmc428.device import EmulatedDevice
from app.emulators.tmc4361 import EmulatedTmc4361, Tmc4361Patch
from app.emulators.tmcdrivers.chip import EmulatedDriver
from app.emulators.tmcdrivers.options import TmcDriverPatch
from app.emulators.tmcdrivers.tagged import EmulatedTagged
from app.emulators.wiring import EmulatorWiring, Present
from app.links.datagram40 import write
from app.registers.catalog import MODELS
from app.registers.tmc4361.table import TMC4361
from tests.emulators.tmc4361.moves import random_ramp
from tests.emulators.tmc4361.rig import S_POSITION, TRAPEZOID_POSITION

_ADDRESSES = {row.name: row.address for row in TMC4361}
TICK_S = 256 / 12e6


def emulator(model: str, clock: VirtualClock, **options: Any) -> Any:
    return build_emulator(model, clock, options_of(model).model_validate(options))


def wire(*emulators: Any) -> EmulatorWiring:
    wiring = EmulatorWiring()
    wiring.sync([Present(f"{number}", each) for number, each in enumerate(emulators)])
    return wiring


def switch_on(driver: EmulatedDriver | EmulatedTagged) -> None:
    """Bridges on, 256 microsteps, so that a step is the least there is."""
    if isinstance(driver, EmulatedTagged):
        for datagram in (0xE_0010, 0x0_0000, 0xD_051F, 0x9_01B5):
            driver.exchange(datagram.to_bytes(3, "big"))
        return
    table = MODELS[driver.model].table
    for name, word in (("GCONF", 0x80 if driver.model == "tmc2209" else 0), ("CHOPCONF", 0x10000053)):
        driver.write(table.get(name, None if name == "GCONF" else 0).address, word)
    driver.write(table.get("IHOLD_IRUN", 0).address, 0x1F1F)


def moved(driver: EmulatedDriver | EmulatedTagged) -> int:
    """Microsteps by the driver's own counter, which no register of it shows."""
    return int(driver._chip.drive.read("XACTUAL"))


class Pair:
    """A TMC4361 and the driver that takes its steps."""

    def __init__(self, model: str = "tmc2209", clock_hz: float = 16e6, *, rigid: bool = True) -> None:
        self.clock = VirtualClock()
        wires = {"wires": [{"pin": "STEP1", "net": "x"}]}
        self.controller: EmulatedTmc4361 = emulator("tmc4361", self.clock, **wires)
        self.clock.set(0.001234)
        motor = {"motor": "rigid"} if rigid else {}
        self.driver: EmulatedDriver = emulator(model, self.clock, clock_hz=clock_hz, **motor, **wires)
        self.wiring = wire(self.controller, self.driver)
        assert [net.open for net in self.wiring.nets] == [None]
        switch_on(self.driver)

    def write(self, register: str, word: int) -> None:
        self.controller.exchange(write(_ADDRESSES[register], word & 0xFFFFFFFF))

    def wait(self, seconds: float) -> None:
        self.clock.set(self.clock.now() + seconds)

    def settled(self) -> tuple[int, int, int]:
        """Steps sent less those backwards, steps that the driver took, and the microsteps that its counter moved."""
        for _ in range(6000):
            if self.controller.state().ramp.kind == "rest":
                break
            self.wait(0.01)
        self.wait(2 * TICK_S)
        self.controller.state()
        return self.controller.wired.sent("STEP1"), self.driver.state().pins.steps, moved(self.driver)


@pytest.mark.parametrize(
    ("model", "clock_hz"), [("tmc2130", 16e6), ("tmc2209", 12e6), ("tmc2240", 13.2e6), ("tmc2660", 15e6)]
)
def test_steps_sent_are_microsteps_moved_after_any_moves(model: str, clock_hz: float) -> None:
    source = random.Random(f"{model} {clock_hz}")
    pair = Pair(model, clock_hz)
    sent_in_all = 0
    for _ in range(6):
        mode = source.choice((S_POSITION, TRAPEZOID_POSITION))
        for name, word in random_ramp(source, mode).words().items():
            pair.write(name, word)
        pair.write("RAMPMODE", mode)
        for _ in range(source.randint(1, 4)):
            pair.write("XTARGET", source.randint(-20_000, 20_000))
            pair.wait(source.uniform(0, 0.4))
            source.choice((pair.controller, pair.driver)).state()  # whoever is asked
        sent, taken, counted = pair.settled()
        assert sent == taken == counted
        sent_in_all += abs(sent)
    assert sent_in_all > 1000
    pair.write("VMAX", 0)


def test_the_driver_is_at_each_moment_where_the_controller_has_sent_it() -> None:
    pair = Pair(clock_hz=16e6)
    for name, word in {
        "AMAX": 800_000,
        "DMAX": 800_000,
        "VMAX": 256 * 50_000,
        "RAMPMODE": 5,
        "XTARGET": 30_000,
    }.items():
        pair.write(name, word)
    behind = []
    for _ in range(500):
        pair.wait(0.00171)
        pair.driver.state()
        behind.append(pair.controller.wired.sent("STEP1") - moved(pair.driver))
    assert max(behind) <= 50_000 * 256 / 16e6 + 1, "no more than the steps of its own tick"
    assert min(behind) >= 0
    assert pair.settled() == (30_000, 30_000, 30_000)


def test_a_motor_with_physics_follows_and_its_speed_is_known() -> None:
    pair = Pair("tmc2130", clock_hz=16e6, rigid=False)
    for name, word in {"AMAX": 800_000, "DMAX": 800_000, "VMAX": 256 * 51_200, "RAMPMODE": 5}.items():
        pair.write(name, word)
    begin = pair.driver.ground_truth(0).shaft_fullsteps
    pair.write("XTARGET", 51_200)
    pair.wait(0.8)
    tstep = pair.driver.read(MODELS["tmc2130"].table.get("TSTEP", 0).address)
    assert tstep == pytest.approx(16e6 / 51_200, rel=0.05)
    pair.wait(1.5)
    assert pair.settled()[0] == 51_200
    assert pair.driver.ground_truth(0).shaft_fullsteps - begin == pytest.approx(200, abs=0.5)


def test_back_and_forth_in_one_wait() -> None:
    """A whole shuttle between two looks: what went back is not taken for more forward."""
    pair = Pair()
    for name, word in {"AMAX": 4_000_000, "DMAX": 4_000_000, "VMAX": 256 * 50_000, "RAMPMODE": 5}.items():
        pair.write(name, word)
    pair.wait(1e-3)
    pair.driver.state()  # the field is where CHOPCONF has put it from its next tick on
    pair.write("XTARGET", 2000)
    begin = pair.driver._chip.drive.read("MSCNT")
    pair.wait(0.5)
    pair.write("XTARGET", -500)
    pair.wait(5.0)
    assert pair.settled() == (-500, -500, -500)
    assert pair.driver._chip.drive.read("MSCNT") == (begin - 500) % 1024


def test_a_controller_that_loses_power_takes_no_step_back() -> None:
    pair = Pair()
    for name, word in {
        "AMAX": 800_000,
        "DMAX": 800_000,
        "VMAX": 256 * 50_000,
        "RAMPMODE": 5,
        "XTARGET": 30_000,
    }.items():
        pair.write(name, word)
    pair.wait(0.3)
    pair.controller.patch(Tmc4361Patch.model_validate({"power_cycle": True}))
    sent, taken, counted = pair.settled()
    assert sent == taken == counted > 0
    pair.wait(1.0)
    assert pair.settled() == (sent, taken, counted)


def test_vactual_of_the_driver_itself_goes_before_steps() -> None:
    pair = Pair("tmc2209")
    vactual = MODELS["tmc2209"].table.get("VACTUAL", 0).address
    pair.driver.write(vactual, 1000)
    for name, word in {"AMAX": 800_000, "DMAX": 800_000, "VMAX": 256 * 10_000, "RAMPMODE": 5, "XTARGET": 1000}.items():
        pair.write(name, word)
    pair.wait(1.0)
    assert pair.driver.state().pins.steps == 0
    pair.driver.write(vactual, 0)
    pair.write("XTARGET", 1500)
    pair.wait(1.0)
    assert pair.driver.state().pins.steps == 500


def test_cut_off_it_stands() -> None:
    pair = Pair()
    for name, word in {"AMAX": 800_000, "DMAX": 800_000, "VMAX": 256 * 10_000, "RAMPMODE": 5, "XTARGET": 10**6}.items():
        pair.write(name, word)
    pair.wait(0.5)
    pair.wiring.sync([Present("1", pair.driver)])
    at = pair.driver.state().pins.steps
    assert at > 0
    pair.wait(1.0)
    assert pair.driver.state().pins.steps == at
    pair.driver.patch(TmcDriverPatch.model_validate({"pins": {"step_hz": 100.0}}))
    before = pair.driver.ground_truth(0).shaft_fullsteps
    pair.wait(1.0)
    assert pair.driver.ground_truth(0).shaft_fullsteps != before


@pytest.mark.parametrize("model", ["tmc429", "tmc4210"])
def test_axes_of_the_tmc428_family_move_a_driver_each(model: str) -> None:
    source, clock = random.Random(model), VirtualClock()
    axes = MODELS[model].axes
    wires = [{"pin": f"STEP{n + 1}", "net": f"axis-{n}"} for n in range(axes)]
    controller: EmulatedDevice = emulator(model, clock, wires=wires)
    drivers = [
        emulator("tmc2209", clock, motor="rigid", clock_hz=16e6, wires=[{"pin": "STEP1", "net": f"axis-{n}"}])
        for n in range(axes)
    ]
    wiring = wire(controller, *drivers)
    assert [net.open for net in wiring.nets] == [None] * axes
    for driver in drivers:
        switch_on(driver)

    def put(address: int, data: int) -> None:
        controller.exchange((address << 25 | data & 0xFFFFFF).to_bytes(4, "big"))

    put(0x34, 1 << 5)  # en_sd
    for n in range(axes):
        for register, data in ((0x3, 1500), (0x6, 400), (0x9, 128 << 8 | 6), (0xC, 4 << 12 | 6 << 8)):
            put(n << 4 | register, data)
        put(n << 4 | 0xA, 0)
    for _ in range(8):
        for n in range(axes):
            put(n << 4, source.randint(-3000, 3000))
        clock.set(clock.now() + source.uniform(0.05, 0.6))
        if source.random() < 0.5:
            source.choice(drivers).state()
    clock.set(clock.now() + TICK_S * 2)
    sent = [step.steps_sent for step in controller.state().step_dirs]
    assert min(sent) > 1000
    assert controller.wired is not None
    for n, driver in enumerate(drivers):
        taken = driver.state().pins.steps
        assert taken == controller.wired.sent(f"STEP{n + 1}") == moved(driver)


def test_nets_that_cannot_be_say_why() -> None:
    clock = VirtualClock()
    net = {"wires": [{"pin": "STEP1", "net": "x"}]}
    start = {"wires": [{"pin": "START", "net": "x"}]}

    def why(*emulators: Any) -> str | None:
        return wire(*emulators).nets[0].open

    assert why(emulator("tmc2209", clock, **net), emulator("tmc2130", clock, **net)) == (
        "steps come from one output, and it has 0"
    )
    assert why(emulator("tmc4361", clock, **net), emulator("tmc4361", clock, **net)) == (
        "steps come from one output, and it has 2"
    )
    assert why(emulator("tmc4361", clock, **start), emulator("tmc2209", clock, **net)) == (
        "START and steps are not wired together"
    )
    assert why(emulator("tmc4210", clock, wires=[{"pin": "STEP2", "net": "x"}]), emulator("tmc2209", clock, **net)) == (
        "0 has no pin STEP2"
    )


def test_a_signal_is_taken_in_place_of_the_switch_and_given_back() -> None:
    clock = VirtualClock()
    net = {"wires": [{"pin": "DIAG", "net": "d"}]}
    driver = emulator("tmc2130", clock, **net)
    stop = emulator("tmc4361", clock, wires=[{"pin": "STOPL", "net": "d"}])
    reference = emulator("tmc428", clock, wires=[{"pin": "REF2", "net": "d"}])
    wiring = wire(driver, stop, reference)
    assert [(pin.pin, pin.role) for pin in wiring.nets[0].pins] == [
        ("DIAG", "signal"),
        ("STOPL", "sense"),
        ("REF2", "sense"),
    ]

    def levels() -> list[bool]:
        return [stop.state().switches.left.active, reference.state().axes[1].switches.left.active]

    assert levels() == [True, True], "open drain, and not active"
    gconf = MODELS["tmc2130"].table.get("GCONF")
    driver.write(gconf.address, 0x3000)
    assert levels() == [False, False], "push-pull, and not active"
    stop.patch(Tmc4361Patch.model_validate({"switches": {"left": True}}))
    assert levels() == [True, False], "what the bench forces goes before"
    stop.patch(Tmc4361Patch.model_validate({"switches": {"left": "auto"}}))
    driver.write(gconf.address, 0)
    assert levels() == [True, True]
    assert [state.switches.left.forced for state in reference.state().axes] == [None] * 3
    wiring.sync([])
    assert levels() == [False, False]


def test_signals_have_one_source_and_go_with_nothing_else() -> None:
    clock = VirtualClock()

    def why(*wired: tuple[str, str]) -> str | None:
        made = [emulator(model, clock, wires=[{"pin": pin, "net": "x"}]) for model, pin in wired]
        return wire(*made).nets[0].open

    assert why(("tmc2209", "DIAG"), ("tmc2130", "DIAG")) == "a signal comes from one output, and it has 2"
    assert why(("tmc4361", "STOPL"), ("tmc428", "REF1")) == "a signal comes from one output, and it has 0"
    assert why(("tmc2209", "DIAG"), ("tmc4361", "START")) == "START and signals are not wired together"
    assert why(("tmc2209", "STEP1"), ("tmc4361", "STOPR")) == "steps and signals are not wired together"
