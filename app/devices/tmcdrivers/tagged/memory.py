"""What was written to such a driver since the link was made. Nothing of it can be read."""

from __future__ import annotations

from ....errors import BenchError
from ....links.spi_access import TaggedAccess
from ....registers.catalog import Model
from ....registers.model import Register
from ...core.register_link import RegisterLink
from ...core.results import DeviceState
from ...core.row_named import row_named

FINEST = 256
STANDS, STALL = "STST", "SG"


class TaggedRoles:
    """The rows by what they are for."""

    def __init__(self, model: Model) -> None:
        self.model = model

    def get(self, name: str) -> Register:
        return self.model.table.get(name, 0)

    place = row_named("DRVSTATUS_MSTEP")
    load = row_named("DRVSTATUS_SG")
    scale = row_named("DRVSTATUS_SG_SE")
    control = row_named("DRVCTRL")
    chopper = row_named("CHOPCONF")
    currents = row_named("SGCSCONF")
    configuration = row_named("DRVCONF")


class TaggedMemory:
    """Words by register, as written: a shadow, which ends with the link's first failure, for then it may be another
    driver, or this one after a loss of power."""

    def __init__(self, link: RegisterLink, rows: TaggedRoles) -> None:
        self.rows = rows
        self._link = link
        self._written: dict[int, int] = {}
        self.last_configuration: int | None = None
        """DRVCONF as it was written last, whatever came of the link since."""

    @property
    def answers(self) -> bool:
        """Whether a status can be asked for: every question writes DRVCONF, so what that holds has to be known."""
        access = self._link.access
        return not isinstance(access, TaggedAccess) or access.ready

    def sent(self, register: Register, word: int) -> None:
        """`word` went out."""
        if register.access.writable:
            self._written[register.address] = word & register.mask
            if register is self.rows.configuration:
                self.last_configuration = word & register.mask
            limiter = self._link.session.limiter
            if limiter is not None:
                limiter.saw(register.address, word, register.width)
            if register is self.rows.control or register is self.rows.configuration:
                self._link.session.axes[0].microsteps_per_full_step = self.microsteps

    def word(self, register: Register) -> int | None:
        """What was written there; None where nobody knows."""
        return self._written.get(register.address)

    def word_at(self, address: int) -> int | None:
        """The same by address, for soft limits."""
        return self._written.get(address)

    def field(self, register: Register, name: str) -> int | None:
        """A field of what was written; None where nobody knows."""
        word = self.word(register)
        return None if word is None else register.unpack(word)[name]

    @property
    def takes_currents(self) -> bool:
        """Whether DRVCTRL sets the coil currents, as far as is known."""
        return bool(self.field(self.rows.configuration, "SDOFF"))

    @property
    def microsteps(self) -> int | None:
        """Microsteps of a step at STEP; None where nobody knows, or nobody looks at STEP."""
        mres = self.field(self.rows.control, "mres")
        return None if mres is None or self.takes_currents else FINEST >> min(mres, 8)

    def heard_state(self, state: DeviceState, problem: BenchError | None) -> None:
        del problem
        if state == "failed":
            self._written.clear()
            self._link.session.axes[0].microsteps_per_full_step = None
            if self._link.session.limiter is not None:
                self._link.session.limiter.reset()
