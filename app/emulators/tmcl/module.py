"""An emulated TMCL module behind a wire: seconds, frames and faults around its firmware."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path

from ...clock import Clock
from ...errors import WrongState
from ...links.tmcl import FRAME_BYTES
from ..core.base import EmulatorBase
from ..core.ground_truth import GroundTruth, ProgramGroundTruth
from ..drive import Drive
from ..drive.documents import ground_truth
from ..line.can_message import CanMessage
from . import plant
from .eeprom import Eeprom
from .faults import UNDERVOLTAGE_V, Faults
from .firmware import Firmware
from .global_parameters import ADDRESS, BAUD, CAN_RECEIVE, CAN_SEND
from .models import PLAYED
from .options import TmclOptions, TmclPatch
from .refused import Refused
from .state import TmclState


class EmulatedModule(EmulatorBase[TmclPatch, TmclState]):
    """Frames of nine bytes in and out, at its own clock's time; safe to use from several threads.

    The module never runs by itself: whoever asks makes it catch up first. Behind a serial line `receive` and
    `unsolicited` are its wire, and the line does to the bytes what `faults` says; without one `exchange` is.
    """

    faults: Faults

    def __init__(
        self, model: str, clock: Clock, options: TmclOptions | None = None, eeprom: Path | None = None
    ) -> None:
        """A module that has just been switched on and lives by `clock`; `eeprom` is the file of its memory."""
        played = PLAYED[model]
        self._model = model
        self.options = options or TmclOptions()
        super().__init__(clock, self.options.time_scale, Faults())
        delivered = {
            ADDRESS: self.options.address,
            BAUD: self.options.baud_code,
            CAN_RECEIVE: self.options.can_receive_id,
            CAN_SEND: self.options.can_send_id,
        }
        self._drive = Drive(self.options.drive(played.full_scale_a))
        self._firmware = Firmware(
            played,
            self._drive,
            Eeprom(eeprom),
            delivered,
            self.options.command_us / 1e6,
            self.options.unknown_parameters,
            self.options.later_commands,
        )
        self._clock_hz = self._drive.options.clock_hz
        self._supply_v = self.options.supply_v
        self._noise = random.Random(self.options.seed)

    @property
    def model(self) -> str:
        """The name in the catalog."""
        return self._model

    @property
    def reply_pause_s(self) -> float:
        """How long an answer waits before it is sent [s]: telegram pause time, global parameter 75."""
        return self._firmware.pause_s

    # --- frames ----------------------------------------------------------------------------------

    def receive(self, frame: bytes, at_s: float | None = None) -> bytes | None:
        """Obey one frame at chip time `at_s` [s], by default now; never before the latest time used.

        None where there is no answer: another address, suppressed answers, commands 137 and 255. Faults on the
        wire do not show here. Raises ValueError for a frame of another length.
        """
        if len(frame) != FRAME_BYTES:
            raise ValueError(f"a TMCL frame has {FRAME_BYTES} bytes, not {len(frame)}")
        with self._lock:
            self._run_until(at_s)
            return self._firmware.receive(frame)

    @property
    def can_bit_rate(self) -> int | None:
        """Of the CAN interface since power-on [bit/s]; None for a model that has none."""
        return self._firmware.globals.can_rate_in_force

    def receive_message(self, message: CanMessage, at_s: float | None = None) -> CanMessage | None:
        """Obey one message of a CAN bus at chip time `at_s` [s], by default now; None where there is no answer.

        Raises WrongState for a model without CAN.
        """
        if self.can_bit_rate is None:
            raise WrongState(f"a {self._model} has no CAN interface", "use its serial one")
        with self._lock:
            self._run_until(at_s)
            return self._firmware.receive_message(message)

    def as_message(self, frame: bytes) -> CanMessage:
        """A frame of its own (position reached) as it is said on the bus."""
        return self._firmware.as_message(frame)

    def unsolicited(self, at_s: float | None = None) -> list[tuple[float, bytes]]:
        """Position reached events that came up by `at_s` [s] and were not fetched yet: (chip time [s], frame)."""
        with self._lock:
            self._run_until(at_s)
            events = self._firmware.events
            if not events:
                return []
            told = [(clocks / self._clock_hz, frame) for clocks, frame in events]
            events.clear()
            return told

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        """`receive` for a port in the same process, faults included: there the frame is the whole wire.

        Raises ValueError for a frame of another length, ConnectionError while unplugged, and TimeoutError where no
        answer comes, because none is due or because of a fault. A late answer counts as none: the frame is obeyed.
        """
        faults = self.faults
        if faults.unplugged:
            raise ConnectionError(f"emulated {self._model} is unplugged")
        reply = self.receive(frame, at_s)
        if reply is None:
            raise TimeoutError(f"emulated {self._model} does not answer this")
        if faults.silence or faults.late_reply_s:
            raise TimeoutError(f"emulated {self._model} is silent")
        if faults.bit_error_rate or faults.half_frame_rate:
            return faults.spoil(reply, self._noise)
        return reply

    # --- plant ----------------------------------------------------------------------------------

    def _check(self, change: TmclPatch) -> None:
        plant.check(self._drive, change)

    def _change(self, change: TmclPatch) -> None:
        if change.factory_default:
            self._erase()
        if change.factory_default or change.power_cycle:
            self._firmware.power_on()
        plant.change(self._drive, change)
        self._change_inputs(change)
        self.faults.change(change.faults)
        if change.supply_v is not None:
            self._supply_v = change.supply_v
        self._drive.plant.supply_v = UNDERVOLTAGE_V if self.faults.undervoltage else self._supply_v
        if change.step_dir is not None:
            self._firmware.axis.feed_pulses(change.step_dir.pulses, change.step_dir.rate_hz)

    def _ground_truth(self, axis: int) -> GroundTruth:
        application, interpreter = self._firmware.application, self._firmware.interpreter
        program = ProgramGroundTruth(
            tuple(application.flags), tuple(application.stack), interpreter.waits, interpreter.serves
        )
        return replace(ground_truth(self._drive.plant_state, self._drive.plant), program=program)

    # --- within ----------------------------------------------------------------------------------

    def _run(self, until_s: float) -> None:
        if until_s > self._latest_s:
            self._latest_s = until_s
            self._firmware.run(int(until_s * self._clock_hz + 0.5))

    @property
    def _quiet(self) -> bool:
        # a heartbeat that runs out only stops what stands
        return self._drive.quiet and not self._firmware.interpreter.active

    def _erase(self) -> None:
        try:
            self._firmware.globals.factory_default()
        except Refused as error:
            path = self._firmware.eeprom.path
            raise WrongState(f"the EEPROM's file {path} cannot be written", "see to the disk and its rights") from error

    def _change_inputs(self, change: TmclPatch) -> None:
        ports, inputs = self._firmware.ports, change.inputs
        for number, level in ((1, inputs.in1), (2, inputs.in2)):
            if level is not None:
                ports.driven[number] = None if level == "open" else level
        if inputs.analog is not None:
            ports.analog = inputs.analog

    def _describe(self) -> TmclState:
        faults = self.faults.describe()
        return plant.describe(self._model, self._drive, self._firmware, faults, self._times)
