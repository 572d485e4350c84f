"""The drive: registers in and out, time forward."""

from __future__ import annotations

from app.emulators.drive.encoder import EncoderChannel
from app.emulators.drive.events import Event, EventKind
from app.emulators.drive.options import DriveOptions
from app.emulators.drive.world import Switches, Truth, World


class Drive:
    """A TMC5160, the bridges behind it, and all that they move.

    Time is counted in clocks of `options.clock_hz` (16 MHz). Ramp generator, motor, switches and encoders are worked
    out in ticks every `TICK_CLOCKS` = 256 clocks (16 us), counted from power-on: a register shows the last tick, and a
    write holds from the next one. So it makes no difference in how many pieces time is advanced.

    Nothing here is thread-safe; the kernel releases the GIL.
    """

    options: DriveOptions
    clocks: int
    """Chip time [clocks]. Goes on over `power_cycle`."""
    watch: EventKind
    """Which events end an `advance` early; none at first."""
    world: World
    internal: EncoderChannel
    external: EncoderChannel
    stall_stop_velocity: int | None
    """VACTUAL from which on SW_MODE.sg_stop acts [ramp units]. None, as in the chip: where TSTEP <= TCOOLTHRS."""

    def __init__(self, options: DriveOptions | None = None) -> None: ...

    def write(self, register: str, value: int) -> None:
        """Write a register by its TMC5160 name. Bits beyond its width are dropped, as on the bus.

        Writable: GCONF GSTAT(1 clears) GLOBALSCALER IHOLD_IRUN TPOWERDOWN TPWMTHRS TCOOLTHRS THIGH RAMPMODE XACTUAL
        VSTART A1 V1 AMAX VMAX DMAX D1 VSTOP TZEROWAIT XTARGET VDCMIN SW_MODE RAMP_STAT(1 clears) ENCMODE X_ENC
        ENC_CONST ENC_STATUS(1 clears) ENC_DEVIATION MSLUT[0]..MSLUT[7] MSLUTSEL MSLUTSTART CHOPCONF COOLCONF DCCTRL
        PWMCONF. Signed registers take either form of a negative number. The encoder registers are `external`'s;
        ENC_DEVIATION only warns there.

        Raises KeyError for a name that the chip does not have, PermissionError for one that can only be read.
        """

    def read(self, register: str) -> int:
        """A register by its TMC5160 name: signed where the chip counts signed. Reading has no side effects.

        Besides what can be written (write-only ones read back here): VACTUAL TSTEP XLATCH ENC_LATCH MSCNT MSCURACT
        DRV_STATUS PWM_SCALE PWM_AUTO LOST_STEPS. Raises KeyError for a name that the chip does not have.
        """

    def advance(self, until_clocks: int) -> Event | None:
        """Go on to `until_clocks`, or to the first tick in which an event of `watch` happens.

        None: `clocks` is `until_clocks`. An event: `clocks` is the tick it happened in; call again to go on.
        Raises ValueError for a time gone by.
        """

    def power_cycle(self) -> None:
        """The chip loses supply and comes back: registers and counters at reset, GSTAT.reset set, field at MSCNT 0.

        Rotor, load, stage and magnet stay where they are, so does `world`, and `clocks` goes on.
        """

    @property
    def switches(self) -> Switches:
        """The switches as they are on the stage or forced: polarity and swap of SW_MODE do not enter."""

    @property
    def truth(self) -> Truth:
        """How motor and shaft really are."""


def warm_up() -> None:
    """Compile the kernel or load it from numba's cache, so that the first `advance` need not."""
