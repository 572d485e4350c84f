"""PyTrinamic's class of the TMC2209, unmodified, and emulated chips on a single wire; and our own end of that wire."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pytrinamic.connections import UartIcInterface
from pytrinamic.evalboards import TMC2209_eval

from app.clock import WallClock
from app.emulators.line.faults import LinePatch
from app.emulators.line.line import Line
from app.emulators.line.uart import uart_line
from app.emulators.tmcdrivers import EmulatedDriver, TmcDriverOptions
from app.errors import LinkError
from app.links.datagram_uart import UartForm
from app.links.discovery import probe_chips
from app.links.queue import LinkQueue
from app.links.register_access import UartAccess
from app.links.uart_line import uart_port
from tests.peers.served_line import served
from tests.peers.test_pytrinamic import wait_for
from tests.peers.test_pytrinamic_uart import OverUart

PATIENCE_S = 20.0
GCONF, IFCNT, IHOLD_IRUN, VACTUAL, SGTHRS = 0x00, 0x02, 0x10, 0x22, 0x40


class OverDriverUart(OverUart):
    """`write_drv` and `read_drv`, which this class of PyTrinamic asks for."""

    def read_drv(self, address: int, module_id: int = 1, signed: bool = False) -> int:
        return self.read_mc(address, module_id, signed)

    def write_drv(self, address: int, value: int, module_id: int = 1) -> None:
        self.write_mc(address, value, module_id)


def drivers(*nodes: int, echo: bool = False) -> tuple[Line, list[EmulatedDriver]]:
    chips = [
        EmulatedDriver("tmc2209", WallClock(), TmcDriverOptions.model_validate({"node": node, "motor": "rigid"}))
        for node in nodes
    ]
    return uart_line(chips, WallClock(), nodes=nodes, echo=echo), chips


@pytest.fixture(params=[False, True], ids=["two wires", "one wire"])
def evaluation(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Any]:
    line, (chip,) = drivers(0, echo=request.param)
    with served(line, tmp_path / "uart"), UartIcInterface(str(tmp_path / "uart"), 115_200, 20) as port:
        made = TMC2209_eval(OverDriverUart(port, 0, echo=request.param))
        made.chip = chip
        yield made


def test_it_is_initialised_set_read_back_and_moved(evaluation: Any) -> None:
    """All that the class says of registers: each can be read; currents and chopper are set; VACTUAL turns the motor."""
    ic = evaluation.ics[0]
    for name, address in vars(ic.REG).items():
        if name.isupper():
            evaluation.read_register(address)
    assert evaluation.read_register(ic.REG.IOIN) >> 24 == 0x21
    before = evaluation.read_register(ic.REG.IFCNT)
    evaluation.write_register(ic.REG.GCONF, ic.FIELD.PDN_DISABLE[1] | ic.FIELD.MSTEP_REG_SELECT[1])
    evaluation.write_register(ic.REG.IHOLD_IRUN, 31 << 8 | 8)
    evaluation.write_register(ic.REG.CHOPCONF, 0x1000_0053)
    evaluation.write_register(ic.REG.PWMCONF, 0xC10D_0024)
    assert evaluation.read_register(ic.REG.IFCNT) == before + 4
    assert evaluation.read_register(ic.REG.CHOPCONF) == 0x1000_0053
    evaluation.write_register(ic.REG.VACTUAL, 71_583)
    wait_for(lambda: evaluation.chip.ground_truth(0).shaft_fullsteps > 50)
    assert 0 < evaluation.read_register(ic.REG.TSTEP) < 0xFFFFF
    assert evaluation.read_register(ic.REG.DRV_STATUS) >> 16 & 31 == 31
    evaluation.write_register(ic.REG.VACTUAL, 0)
    wait_for(lambda: evaluation.read_register(ic.REG.TSTEP) == 0xFFFFF)


def test_a_wrong_crc_is_neither_obeyed_nor_answered(tmp_path: Path) -> None:
    line, _ = drivers(0)
    with served(line, tmp_path / "uart"), UartIcInterface(str(tmp_path / "uart"), 115_200, 0.1) as port:
        assert port.send_datagram(bytes.fromhex("05 00 a2 00 00 10 00 00"), 0) == b""
        assert port.send_datagram(bytes.fromhex("05 00 06 00"), 8) == b""
        port.serial.timeout = PATIENCE_S
        assert OverUart(port).read_mc(IFCNT) == 0


async def test_four_on_one_wire_each_at_its_pins_and_found_there(tmp_path: Path) -> None:
    line, chips = drivers(0, 1, 2, 3, echo=True)
    with served(line, tmp_path / "uart"):
        found = await probe_chips(str(tmp_path / "uart"), [115_200])
        assert [(one.chip, one.node, one.number) for one in found] == [("TMC2209", node, 0x21) for node in range(4)]
        for node in range(4):
            port = uart_port(str(tmp_path / "uart"), UartForm(node), timeout_s=PATIENCE_S)
            access = UartAccess(form=port.form)
            frames = access.write_frames([(SGTHRS, 10 + node)])
            access.check_all(frames, await LinkQueue(port).exchange_many(frames))
            await port.aclose()
        assert [chip._chip.held(SGTHRS) for chip in chips] == [10, 11, 12, 13]


async def test_over_a_bad_wire_nothing_wrong_is_believed(tmp_path: Path) -> None:
    """Bits flip: each write is counted or an error, and each reading true or an error."""
    line, (chip,) = drivers(0, echo=True)
    with served(line, tmp_path / "uart"):
        port = uart_port(str(tmp_path / "uart"), UartForm(0), timeout_s=0.3)
        queue, access = LinkQueue(port), UartAccess()
        await queue.exchange(access.read_frames([GCONF])[0])
        line.patch(LinePatch.model_validate({"faults": {"bit_error_rate": 0.01}}))
        failed = 0
        for number in range(40):
            try:
                frames = access.write_frames([(SGTHRS, number)])
                access.check_all(frames, await queue.exchange_many(frames))
            except LinkError:
                failed += 1
            else:
                assert chip._chip.held(SGTHRS) == number
            try:
                (word,) = access.words(await queue.exchange_many(access.read_frames([GCONF])))
            except LinkError:
                failed += 1
            else:
                assert word == 0x101
        assert 0 < failed < 80
        await port.aclose()
