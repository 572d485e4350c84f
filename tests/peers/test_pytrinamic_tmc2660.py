"""PyTrinamic's class of the TMC2660, unmodified: over SPI of its own, and as the cover datagrams of a TMC428."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from pytrinamic.evalboards import TMC2660_eval

from app.clock import VirtualClock
from app.emulators.tmcdrivers.options import TmcDriverOptions, TmcDriverPatch
from app.emulators.tmcdrivers.tagged import EmulatedTagged
from tests.emulators.test_chain_drives import Rig

ANSWERS, WRITTEN, DRVCONF = 3, 8, 15
SELECT, SELECTED = 3 << 4, 4


class OverDatagrams:
    """What the class asks of a connection, as the maker's firmware does it (TMC-API, `tmc/ic/TMC2660`): registers that
    are written are kept, and an answer is asked for by DRVCONF, twice."""

    def __init__(self, exchange: Callable[[int], int]) -> None:
        self._exchange = exchange
        self._kept: dict[int, int] = {}

    def write_drv(self, address: int, value: int, _module: int) -> None:
        assert address & WRITTEN
        self._kept[address] = value & 0xF_FFFF
        self._exchange((address & 7) << 17 | value & (0x3_FFFF if address == WRITTEN else 0x1_FFFF))

    def read_drv(self, address: int, _module: int, _signed: bool) -> int:
        if address >= ANSWERS:
            return self._kept.get(address, 0)
        asking = 7 << 17 | self._kept.get(DRVCONF, 0) & ~SELECT & 0x1_FFFF | address << SELECTED
        self._exchange(asking)
        answer = self._exchange(asking)
        self.write_drv(DRVCONF, self._kept.get(DRVCONF, 0), 1)
        return answer


class Bench:
    """A driver, and what turns its motor and lets time pass."""

    def __init__(self, behind: bool) -> None:
        self.behind = behind
        if behind:
            self.rig = Rig(["tmc2660"])
            self.evaluation = TMC2660_eval(OverDatagrams(lambda word: self.rig.cover(0, word)))
        else:
            self.chip = EmulatedTagged(VirtualClock(), TmcDriverOptions.model_validate({"clock_hz": 16e6}))
            self.time_s = 0.0
            self.evaluation = TMC2660_eval(OverDatagrams(self._exchange))

    def _exchange(self, word: int) -> int:
        return int.from_bytes(self.chip.exchange(word.to_bytes(3, "big"), self.time_s), "big") >> 4

    def move(self, microsteps: int) -> None:
        if self.behind:
            self.rig.move(0, microsteps)
            self.rig.wait(3.0)
        else:
            self.chip.patch(TmcDriverPatch.model_validate({"pins": {"step_hz": 1600.0}}), self.time_s)
            self.time_s += microsteps / 1600.0
            self.chip.patch(TmcDriverPatch.model_validate({"pins": {"step_hz": 0.0}}), self.time_s)
            self.time_s += 0.2

    @property
    def shaft_fullsteps(self) -> float:
        if self.behind:
            return self.rig.position(0) - 3750
        return float(self.chip.ground_truth(0, self.time_s).shaft_fullsteps)

    def heat(self, celsius: float) -> None:
        if self.behind:
            self.rig.patch(0, motor={"temperature_c": celsius})
        else:
            self.chip.patch(TmcDriverPatch.model_validate({"motor": {"temperature_c": celsius}}), self.time_s)


@pytest.fixture(params=[False, True], ids=["alone", "behind a TMC428"])
def bench(request: pytest.FixtureRequest) -> Bench:
    return Bench(request.param)


def field(evaluation: Any, name: str, register: int) -> int:
    """A field as its table has it; names that several registers have are told apart by the register."""
    address, mask, shift = getattr(evaluation.ics[0].FIELD, name)
    assert address == register
    return int((evaluation.read_register(register) & mask) >> shift)


def test_it_is_initialised_given_currents_read_back_and_moved(bench: Bench) -> None:
    evaluation = bench.evaluation
    ic = evaluation.ics[0]
    sdoff = 1 << 7 if bench.behind else 0
    for register, word in (
        (ic.REG.DRVCONF, 0x10 | sdoff),
        *(() if bench.behind else ((ic.REG.DRVCTRL, 0x204),)),
        (ic.REG.SMARTEN, 0),
        (ic.REG.SGCSCONF, 1 << 16 | 5 << 8 | 20),
        (ic.REG.CHOPCONF, 0x1_01B5),
    ):
        evaluation.write_register(register, word)
        assert evaluation.read_register(register) == word
    assert field(evaluation, "CS", ic.REG.SGCSCONF) == 20
    assert field(evaluation, "TOFF", ic.REG.CHOPCONF) == 5
    bench.move(1600)
    assert bench.shaft_fullsteps == pytest.approx(100, abs=1.5)
    assert field(evaluation, "SE", ic.REG.DRVSTATUS_SG_SE) == 20
    assert evaluation.read_register(ic.REG.DRVSTATUS_SG) & 0x7E == 0
    bench.heat(120.0)
    assert field(evaluation, "OTPW", ic.REG.DRVSTATUS_SG_SE) == 1
    assert field(evaluation, "OT", ic.REG.DRVSTATUS_SG_SE) == 0


def test_every_answer_that_it_names_can_be_asked_for(bench: Bench) -> None:
    evaluation = bench.evaluation
    for name, address in vars(evaluation.ics[0].REG).items():
        if name.isupper():
            assert 0 <= evaluation.read_register(address) < 1 << 20
