"""Until they are compiled, kernels run as the plain Python that they are written in: the same chip, bit by bit."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext

import pytest

from app import kernels
from app.clock import VirtualClock
from app.emulators.core.pace import AT_ONCE_S, IN_STORE_S, SLICE_WORK_S, Pace
from app.emulators.drive import Drive, DriveOptions, EncoderOptions
from app.emulators.tmc4361.chip import EmulatedTmc4361
from app.links.datagram40 import write

COLD = [kernel for kernel in kernels._kernels if kernel._plain]
"""Those of the emulators that are imported here."""


@contextmanager
def nothing_compiled() -> Iterator[None]:
    """As on a first start: no kernel has machine code, and none gets any."""
    with pytest.MonkeyPatch.context() as patch:
        for kernel in COLD:
            patch.setattr(kernel, "_ready", None)
            patch.setattr(kernel, "_made", pytest.fail)
        kernels.plain_meanwhile(on=True)
        try:
            yield
        finally:
            kernels.plain_meanwhile(on=False)


RUN: dict[str, int] = {"CHOPCONF": 0x1001_00C3, "IHOLD_IRUN": 0x0006_1F08, "AMAX": 40_000, "DMAX": 40_000, "D1": 40_000}
"""Motor on, interpolation to 256 microsteps, full current, and a ramp that is over after 20 ms."""
TO_A_TARGET = {**RUN, "VMAX": 150_000, "VSTOP": 10, "RAMPMODE": 0, "XTARGET": 1500}
QUIETLY = {**RUN, "PWMCONF": 0xC40C_1E1D, "GCONF": 4, "VMAX": 60_000, "RAMPMODE": 1}
WITH_COOLSTEP = {**RUN, "COOLCONF": 0x0103_7444, "TCOOLTHRS": 0xFFFFF, "VMAX": 200_000, "RAMPMODE": 2}
WITH_DCSTEP = {**RUN, "VDCMIN": 20_000, "DCCTRL": 0x0040_0258, "VMAX": 100_000, "RAMPMODE": 1}


def live(options: DriveOptions, written: dict[str, int], begins_in: AbstractContextManager[None]) -> list[bytes]:
    """A drive's 40 ms, with what happens outside of it meanwhile: its cells as they are then."""
    with begins_in:
        drive = Drive(options)
        for name, value in written.items():
            drive.write(name, value)
        drive.advance(160_000)
    for piece in range(3):
        drive.plant.load_torque_nm = 0.02 * piece
        drive.plant.force_left = piece == 2
        drive.advance(drive.clocks + 160_000 + 7 * piece)
    assert drive.plant_state.rotor_fullsteps != options.start_fullsteps
    return [cells.tobytes() for cells in drive.cells]


@pytest.mark.parametrize("written", [TO_A_TARGET, QUIETLY, WITH_COOLSTEP, WITH_DCSTEP])
@pytest.mark.parametrize(
    "options",
    [DriveOptions(), DriveOptions(rigid=True), DriveOptions(ripple=True, n_line=True, encoders=EncoderOptions())],
    ids=["as it comes", "rigid", "with ripple and an N line"],
)
def test_a_motor_in_plain_python_is_the_compiled_one(options: DriveOptions, written: dict[str, int]) -> None:
    compiled = live(options, written, nullcontext())
    with nothing_compiled():
        assert live(options, written, nullcontext()) == compiled


def test_the_compiled_code_comes_while_a_motor_turns() -> None:
    """From one call to the next: there is nothing to switch over."""
    compiled = live(DriveOptions(), TO_A_TARGET, nullcontext())
    assert live(DriveOptions(), TO_A_TARGET, nothing_compiled()) == compiled


def test_a_tmc4361_in_plain_python_is_the_compiled_one() -> None:
    def life() -> tuple[bytes, ...]:
        chip, at_s = EmulatedTmc4361(VirtualClock()), 1e-3
        for address, value in ((0x20, 5), (0x24, 50_000 << 8), (0x28, 4_000_000), (0x29, 4_000_000), (0x37, 60)):
            chip.exchange(write(address, value), at_s)
        assert chip.state(at_s + 0.01).truth.rotor_fullsteps != 0
        inside = chip._chip
        return tuple(cells.tobytes() for cells in (inside.r, inside.s, inside.f, inside.feedback.fb))

    compiled = life()
    with nothing_compiled():
        assert life() == compiled


def test_looks_at_a_tmc4361_in_plain_python_leave_half_of_the_time_to_others() -> None:
    """It takes several times its own time, also where each look asks for two milliseconds, as telemetry does."""
    clock = VirtualClock()
    chip = EmulatedTmc4361(clock)
    for address, value in ((0x28, 80_000), (0x29, 80_000), (0x20, 1), (0x24, 5000 << 8)):
        chip.exchange(write(address, value))
    with nothing_compiled():
        chip.pace = Pace(clock.now)
        works = []
        for _ in range(250):
            clock.set(clock.now() + 0.002)
            began_s = time.thread_time()
            chip.state()
            works.append(time.thread_time() - began_s)
    assert chip.clock.skipped_s > 0.0
    assert max(works) < AT_ONCE_S + 10 * SLICE_WORK_S
    assert sum(works) < IN_STORE_S + 0.5 * clock.now() + 20 * SLICE_WORK_S
