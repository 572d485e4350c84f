"""PyTrinamic's class of the TMC2240, unmodified, and emulated chips on a single wire, each at its node."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pytrinamic.connections import UartIcInterface
from pytrinamic.evalboards import TMC2240_eval

from app.clock import WallClock
from app.emulators.line.uart import uart_line
from app.emulators.tmcdrivers import EmulatedDriver, TmcDriverOptions, TmcDriverPatch
from app.links.discovery import probe_chips
from tests.peers.served_line import served
from tests.peers.test_pytrinamic import wait_for
from tests.peers.test_pytrinamic_tmc2209 import OverDriverUart


def chip_of(node: int) -> EmulatedDriver:
    return EmulatedDriver("tmc2240", WallClock(), TmcDriverOptions.model_validate({"node": node, "motor": "rigid"}))


@pytest.fixture(params=[False, True], ids=["two wires", "one wire"])
def evaluation(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Any]:
    chip = chip_of(0)
    line = uart_line([chip], WallClock(), nodes=(0,), echo=request.param)
    with served(line, tmp_path / "uart"), UartIcInterface(str(tmp_path / "uart"), 115_200, 20) as port:
        made = TMC2240_eval(OverDriverUart(port, 0, echo=request.param))
        made.chip = chip
        yield made


def test_it_is_initialised_set_read_back_and_follows_steps(evaluation: Any) -> None:
    """All that the class says of registers: each can be read; currents and chopper are set and read back."""
    ic = evaluation.ics[0]
    for name, address in vars(ic.REG).items():
        if name.isupper():
            evaluation.read_register(address)
    assert evaluation.read_register(ic.REG.IOIN) >> 24 == 0x40
    before = evaluation.read_register(ic.REG.IFCNT)
    for register, word in ((ic.REG.DRV_CONF, 1), (ic.REG.IHOLD_IRUN, 31 << 8 | 8), (ic.REG.CHOPCONF, 0x1041_0153)):
        evaluation.write_register(register, word)
        assert evaluation.read_register(register) == word
    assert evaluation.read_register(ic.REG.IFCNT) == before + 3
    evaluation.chip.patch(TmcDriverPatch.model_validate({"pins": {"step_hz": 51_200.0}}))
    wait_for(lambda: evaluation.chip.ground_truth(0).shaft_fullsteps > 50)
    assert 0 < evaluation.read_register(ic.REG.TSTEP) < 0xFFFFF
    assert evaluation.read_register(ic.REG.DRV_STATUS) >> 16 & 31 == 31
    evaluation.chip.patch(TmcDriverPatch.model_validate({"pins": {"step_hz": 0.0}}))
    wait_for(lambda: evaluation.read_register(ic.REG.TSTEP) == 0xFFFFF)


async def test_a_search_finds_it_at_its_node_and_names_its_sister_of_the_same_version(tmp_path: Path) -> None:
    line = uart_line([chip_of(0), chip_of(2)], WallClock(), nodes=(0, 2), echo=True)
    with served(line, tmp_path / "uart"):
        found = await probe_chips(str(tmp_path / "uart"), [115_200])
    assert [(one.node, one.number) for one in found] == [(0, 0x40), (2, 0x40)]
    assert {one.chip for one in found} == {"TMC5240"}
    assert all("tmc2240" in one.candidates for one in found), "nothing tells which of both it is"
