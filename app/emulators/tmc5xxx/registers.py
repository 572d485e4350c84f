"""The register file behind SPI and UART: what a write changes and what a read gives, of all five chips."""

from __future__ import annotations

from app.emulators.drive import Drive
from app.emulators.drive.registers import ALIASES, READ_ONLY, WRITABLE
from app.emulators.tmc5xxx.chips import CHIPS
from app.emulators.tmc5xxx.options import Tmc5xxxModel, Tmc5xxxOptions
from app.registers.model import Access, Register
from app.registers.tmc5xxx import TABLES

MASK = 0xFFFF_FFFF
X_COMPARE = 0x05
_STATUS = frozenset({"GSTAT", "RAMP_STAT", "ENC_STATUS"})
_LIVE = READ_ONLY | _STATUS | {"XACTUAL", "XTARGET", "X_ENC"}
_SHAFT = 1 << 4


class Chip:
    """One TMC5xxx with its motors, at clocks of its own. Not thread-safe."""

    def __init__(self, model: Tmc5xxxModel, options: Tmc5xxxOptions) -> None:
        self.kind = CHIPS[model]
        self.table = TABLES[model]
        self.drives = tuple(Drive(options.drive(self.kind.full_scale_a)) for _ in range(self.kind.axes))
        self.drv_enn = False
        self.node_pin = options.node_pin
        self.ifcnt = 0
        self._words: dict[int, int] = {}
        self.reset()

    def reset(self) -> None:
        """Registers and ramp generators as after power-on; the world stays, and time goes on."""
        self._words = {}
        self.ifcnt = 0
        for drive in self.drives:
            drive.power_cycle()
        for row in self.table:
            if row.access in (Access.RW, Access.RW_IF, Access.W) and not row.when:
                self._words[row.address] = row.reset or 0
                self._act(row, row.reset or 0)

    def advance(self, clock: int) -> None:
        """Catch up to `clock` clocks; never back."""
        for drive in self.drives:
            while drive.clocks < clock:
                drive.advance(clock)

    def held(self, address: int) -> int:
        """What was written there last."""
        return self._words.get(address, 0)

    @property
    def has_encoder(self) -> bool:
        """Whether the chip has an encoder interface."""
        return self.table.find("X_ENC", 0) is not None

    def encoder_connected(self, axis: int) -> bool:
        """Whether GCONF leaves the encoder its pins."""
        return self.has_encoder

    @property
    def x_compare(self) -> int:
        """X_COMPARE, signed."""
        return self.table.get("X_COMPARE", 0).decode(self.held(X_COMPARE))

    @property
    def position_compare(self) -> bool:
        """XACTUAL of motor 1 is X_COMPARE."""
        return self.drives[0].read("XACTUAL") == self.x_compare

    @property
    def shows_position_compare(self) -> bool:
        """Whether a pin shows that."""
        return self.kind.single

    @property
    def positions_passed(self) -> int:
        """How often XACTUAL has come upon X_COMPARE."""
        return 0

    @property
    def interrupt(self) -> bool:
        """Whether the interrupt output is active."""
        return False

    # --- the buses -------------------------------------------------------------------------------

    def read(self, address: int) -> int:
        """The word at `address`; 0 where nothing can be read. Status registers of the older chips are cleared."""
        row = self.table.at(address)
        if row is None or not row.access.readable:
            return 0
        if row.name not in _LIVE:
            return self._global(row)
        drive = self.drives[row.axis or 0]
        word = drive.read(row.name) & MASK & row.mask
        if row.read_clears:
            self._clear(row, word)
        return word

    def write(self, address: int, word: int) -> None:
        """Write `word`; bits that the register does not have are dropped, as are writes to what cannot be written."""
        row = self.table.at(address, write=True)
        if row is None or not row.access.writable:
            return
        word &= row.write_mask
        if row.access is Access.R_W1C:
            self._clear(row, word)
            return
        self._words[address] = word
        self._act(row, word)

    @property
    def spi_status(self) -> int:
        """The first byte of every SPI reply."""
        return 0

    def _global(self, row: Register) -> int:
        match row.name:
            case "IFCNT":
                return self.ifcnt
            case "IOIN" | "INPUT":
                return self.kind.version << 24
        return self._words.get(row.address, 0)

    def _clear(self, row: Register, ones: int) -> None:
        for drive in self._drives_of(row):
            drive.write(row.name, ones)

    def _act(self, row: Register, word: int) -> None:
        name = ALIASES.get(row.name, row.name)
        if name not in WRITABLE or name == "GCONF":
            return
        for drive in self._drives_of(row):
            drive.write(name, word)

    def _drives_of(self, row: Register) -> tuple[Drive, ...]:
        return self.drives if row.axis is None else (self.drives[row.axis],)
