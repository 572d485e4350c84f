"""A device for tests: registers by address, time by hand."""

from __future__ import annotations

from app.clock import VirtualClock
from app.emulators.tmc428.family import FAMILY
from app.emulators.tmc428.options import EmulatorOptions, EmulatorPatch, StageOptions
from app.emulators.tmc428.state import ChainState, DriverState, EmulatorState, StepDirState
from app.links.datagram32 import Reply, read, write
from app.registers.model import to_signed

TICK = 32
"""Clocks of a base tick."""

# Registers of motor 1 by their low address bits.
X_TARGET, X_ACTUAL, V_MIN, V_MAX, V_TARGET, V_ACTUAL, A_MAX, A_ACTUAL = range(8)
CURRENT, P, MODE, INTERRUPT, DIVIDERS, DX_REF, X_LATCHED = range(8, 15)
LOW_WORD, HIGH_WORD, COVER, COVER_DATAGRAM, POWER_DOWN, SWITCHES, GLOBAL = 0x30, 0x31, 0x32, 0x33, 0x38, 0x3E, 0x3F

RAMP, SOFT, VELOCITY, HOLD = range(4)
NO_STOPS = 0x300
CONTINUOUS, REFMUX, MOT1R = 1 << 16, 1 << 20, 1 << 21

TABLE_11_3 = """80000510 82000304 84000602 86000D10 88000B0C 8A002E0A 8C000510 8E000304 90000602 92000D10 94000B0C
96002E0A 98000507 9A000304 9C000602 9E000D0F A0000B0C A2002E0A"""
TABLE_12_2 = """C0000200 C2000503 C4000806 C6000B09 C8000E0C CA001110 CC001413 CE001716 D0001A18 D2001D1B D400201E
D6002221 D8002524 DA002726 DC002A29 DE002C2B E0002E2D E200302F E4003231 E6003433 E8003635 EA003837 EC003938 EE003B3A
F0003C3B F2003D3C F4003E3D F6003E3E F8003F3F FA003F3F FC003F3F FE003F3F"""
SINE = [
    0,
    2,
    3,
    5,
    6,
    8,
    9,
    11,
    12,
    14,
    16,
    17,
    19,
    20,
    22,
    23,
    24,
    26,
    27,
    29,
    30,
    32,
    33,
    34,
    36,
    37,
    38,
    39,
    41,
    42,
    43,
    44,
]
SINE += [45, 46, 47, 48, 49, 50, 51, 52, 53, 54, 55, 56, 56, 57, 58, 59, 59, 60, 60, 61, 61, 62, 62, 62] + [63] * 8


class Bench:
    """One emulated chip, its own clock, and short words for the wire."""

    def __init__(
        self,
        model: str = "tmc428",
        *,
        stages: list[StageOptions] | None = None,
        options: dict[str, object] | None = None,
    ) -> None:
        self.clock = VirtualClock()
        given = EmulatorOptions.model_validate({"stages": stages or [], **(options or {})})
        self.device = FAMILY.make(model, self.clock, given)
        self.clock_hz = given.clock_hz
        self.status = 0

    def frame(self, frame: bytes) -> Reply:
        reply = Reply.decode(self.device.exchange(frame))
        self.status = reply.status
        return reply

    def hex(self, datagrams: str) -> None:
        """Send datagrams as the sheet prints them."""
        for datagram in datagrams.split():
            self.frame(bytes.fromhex(datagram))

    def write(self, address: int, data: int) -> None:
        self.frame(write(address, data & 0xFFFFFF))

    def read(self, address: int) -> int:
        return self.frame(read(address)).data

    def signed(self, address: int, width: int = 24) -> int:
        return to_signed(self.read(address), width)

    @property
    def x(self) -> int:
        return self.signed(X_ACTUAL)

    @property
    def v(self) -> int:
        return self.signed(V_ACTUAL, 12)

    def clocks(self, clocks: float) -> None:
        self.clock.set(self.clock.now() + clocks / self.clock_hz)

    def ticks(self, ticks: float) -> None:
        """Let base ticks of 32 clocks pass."""
        self.clocks(ticks * TICK)

    def seconds(self, seconds: float) -> None:
        self.clock.set(self.clock.now() + seconds)

    def patch(self, **change: object) -> EmulatorState:
        return self.device.patch(EmulatorPatch.model_validate(change))

    def switch(self, axis: int = 0, **forced: bool | str) -> None:
        self.patch(switches=[{"axis": axis, **forced}])

    def chain(self) -> ChainState:
        state = self.device.state().driver_chain
        assert state is not None
        return state

    def driver(self, index: int = 0) -> DriverState:
        return self.chain().drivers[index]

    def step_dir(self) -> StepDirState:
        state = self.device.state().step_dir
        assert state is not None
        return state

    def place(self, axis: int = 0) -> float:
        """Where the carriage is [full steps]."""
        return self.device.state().axes[axis].position_fullsteps

    def ramp(self, axis: int = 0, mode: int = RAMP, flags: int = NO_STOPS, **changed: int) -> None:
        """Sensible motion registers for one axis; p fits a_max = 1024 at equal dividers, 5 % reduced."""
        registers = {V_MIN: 1, V_MAX: 2047, A_MAX: 1024, P: 115 << 8 | 2, DIVIDERS: 0x006}
        names = {"v_min": V_MIN, "v_max": V_MAX, "a_max": A_MAX, "p": P, "dividers": DIVIDERS}
        registers |= {names[name]: value for name, value in changed.items()}
        self.write(axis << 4 | MODE, mode | flags)
        for register, value in registers.items():
            self.write(axis << 4 | register, value)

    def three_drivers(self, parameters: int = 0x702) -> None:
        """The chain of Table 11-3 and the table of Table 12-2, as after a proper start."""
        self.hex(TABLE_11_3)
        self.hex(TABLE_12_2)
        self.write(GLOBAL, parameters)


FREE = StageOptions(left_at_fullsteps=-1e6, right_at_fullsteps=1e6, ref_from_fullsteps=9e5, ref_to_fullsteps=9e5)
"""A stage so long that its switches never matter."""


def free_bench(model: str = "tmc428", **options: object) -> Bench:
    return Bench(model, stages=[FREE] * 3, options=options)
