"""Calibration of a closed loop: the chip learns how the encoder stands to the field.

As Trinamic's firmware does it: stop, regulation off, in hold mode to the middle of a full step, where the
rotor stands as the field does; there the chip takes the offset into CL_OFFSET (ENC_IN_CONF.cl_calibration_en),
and regulation goes on. Full current meanwhile: closed loop scaling is off.

Before that the encoder is looked at, which the firmware does not: one that counts the other way, or not at all, makes
a closed loop run away, and with regulation off it can be seen by a single full step.
"""

from __future__ import annotations

from ...calc.positions.encoder_resolution import constant_of, measured_encoder
from ...clock import Clock
from ...devices.core.device import Device
from ...devices.core.results import RegisterReading
from ...devices.tmc4361.moves import Moves
from ...devices.tmc4361.position import Position
from ...errors import OutOfRange, WrongState
from ..closed_loop import REGULATIONS, Calibration, CalibrationState, EncoderFound, Regulation
from ..procedure import POLL_S, Failed

PHASES = ("prepare", "regulation off", "look at the encoder", "to a full step", "take the offset", "switch on")
FULL_STEP = 256
"""Microsteps of a full step: closed loop needs MSTEP_PER_FS = 0."""
MIDDLE = 128
"""MSCNT modulo a full step where both coils have the same current: a full step position."""
MEASURED_WAY = 16 * FULL_STEP
"""How far the motor goes to measure an encoder that a full step has shown to be another one."""
LEAST_COUNTS = 4
"""Fewer over that way are no encoder that turns with the motor."""
TRIES = 8
REACH_S = 5.0
"""How long a way of some full steps may take at the most, device time [s]."""
VELOCITIES_PPS = (1.0, 1e6)
SETTLE_S = (0.01, 10.0)


class ClosedLoopCalibration(Calibration):
    """Calibrates `axis` of a TMC4361; at the end the axis stands on a full step with closed loop on, if wanted."""

    def __init__(
        self,
        device: Device,
        axis: int,
        clock: Clock,
        velocity_pps: float = 10_000.0,
        settle_s: float = 0.1,
        *,
        switch_on: bool = True,
    ) -> None:
        super().__init__(device, axis, clock)
        for name, value, (low, high) in (
            ("velocity_pps", velocity_pps, VELOCITIES_PPS),
            ("settle_s", settle_s, SETTLE_S),
        ):
            if not low <= value <= high:
                raise OutOfRange(name, value, low, high)
        moves, position = device.part(Moves), device.part(Position)
        assert moves is not None  # no other device is calibrated by this
        assert position is not None
        self._moves = moves
        self._position = position
        self._velocity_pps = velocity_pps
        self._settle_s = settle_s
        self._switch_on = switch_on
        self._phase = PHASES[0]
        self._encoder: EncoderFound | None = None
        self._offset: int | None = None
        self._offset_before: int | None = None
        self._regulation: Regulation | None = None
        self._scaled = False
        """Whether closed_loop_scale_en was on before."""
        self._disturbed = False
        """Whether the regulation is not what it was."""

    @property
    def state(self) -> CalibrationState:
        progress = 1.0 if self._how == "done" else PHASES.index(self._phase) / len(PHASES)
        return CalibrationState(
            self._how,
            self._phase,
            progress,
            self._offset,
            self._offset_before,
            self._regulation,
            self.message,
            self._encoder,
        )

    async def _run(self) -> None:
        await self._prepare()
        self._phase = PHASES[1]
        self._disturbed = True
        await self._regulate(0)
        self._phase = PHASES[2]
        await self._check_encoder()
        self._phase = PHASES[3]
        await self._to_full_step()
        self._phase = PHASES[4]
        await self._take_offset()
        self._phase = PHASES[5]
        if self._switch_on:
            await self._regulate(1)
            await self._pass(self._settle_s)
            state = await self.device.monitor.axis_state(self.axis)
            if state.deviation is not None and abs(state.deviation) > FULL_STEP:
                await self._regulate(0)
                raise Failed(
                    f"with closed loop on the encoder stands {state.deviation:.0f} microsteps beside: it is off again"
                )
        self._disturbed = False
        self.message = f"CL_OFFSET {self._offset}"

    async def _prepare(self) -> None:
        step = (await self._read("STEP_CONF")).fields
        if step["mstep_per_fs"] != 0:
            raise WrongState(
                "closed loop needs 256 microsteps per full step", "write STEP_CONF.mstep_per_fs 0, then calibrate again"
            )
        await self.device.stop(self.axis)
        await self._wait_for_rest()
        self._offset_before = (await self._read("CL_OFFSET")).value
        if (await self._read("CURRENT_CONF")).fields["closed_loop_scale_en"]:
            await self.device.registers.write("CURRENT_CONF", self.axis, fields={"closed_loop_scale_en": 0})
            self._scaled = True

    async def _check_encoder(self) -> None:
        for way in (FULL_STEP, -FULL_STEP):  # the rotor may have stood anywhere: now it follows the field
            await self._go(way)
            await self._pass(self._settle_s)
        turned = await self._encoder_over(FULL_STEP)
        if FULL_STEP // 2 < turned < 2 * FULL_STEP:
            return
        self._encoder = await self._measure_encoder()
        found = self._encoder
        if found is not None and "ENC_IN_RES" not in found.writes and "ENC_IN_CONF" in found.writes:
            raise Failed(f"the encoder counts the other way ({turned} microsteps): set ENC_IN_CONF.invert_enc_dir")
        told = f"the encoder went {turned} microsteps while the motor went {FULL_STEP}"
        if found is None:
            raise Failed(f"{told}: is it connected, is ENC_IN_RES the counts of a turn, and is the current on?")
        raise Failed(
            f"{told}: by {MEASURED_WAY // FULL_STEP} full steps it has {found.counts_per_turn:.0f} "
            f"\N{PLUS-MINUS SIGN}{found.uncertainty:.0f} counts a turn; ENC_CONST is for {found.set_counts:.0f}"
        )

    async def _encoder_over(self, way: int) -> int:
        """Return how far ENC_POS goes while the motor goes `way` [microsteps]; the motor comes back."""
        before = (await self._read("ENC_POS")).value
        await self._go(way)
        await self._pass(self._settle_s)
        turned = (await self._read("ENC_POS")).value - before
        await self._go(-way)
        await self._pass(self._settle_s)
        return turned

    async def _measure_encoder(self) -> EncoderFound | None:
        """What encoder it is by a longer way; None where none turns with the motor."""
        conf = (await self._read("ENC_IN_CONF")).fields
        constant = constant_of((await self._read("ENC_CONST")).value, decimal=bool(conf["enc_sel_decimal"]))
        turn = FULL_STEP * (await self._read("STEP_CONF")).fields["fs_per_rev"]
        if constant == 0 or turn == 0:
            return None
        counts = await self._encoder_over(MEASURED_WAY) / constant
        if abs(counts) < LEAST_COUNTS:
            return None
        measured = measured_encoder(counts, MEASURED_WAY, turn)
        now = turn / constant
        right = abs(abs(measured.counts_per_turn) - now) <= measured.uncertainty
        writes: dict[str, dict[str, int]] = {}
        if measured.usual is not None and not right:
            writes["ENC_IN_RES"] = {"ENC_IN_RES": measured.usual, "MANUAL_ENC_CONST": 0}
        if measured.counts_per_turn < 0 and (right or writes):
            writes["ENC_IN_CONF"] = {"invert_enc_dir": 1 - int(conf["invert_enc_dir"])}
        return EncoderFound(measured.counts_per_turn, measured.uncertainty, measured.usual, now, writes)

    async def _to_full_step(self) -> None:
        for _ in range(TRIES):
            away = MIDDLE - (await self._read("MSCNT")).value % FULL_STEP
            if away == 0:
                return
            await self._go(away)
        raise Failed(f"MSCNT does not come to a full step in {TRIES} moves")

    async def _take_offset(self) -> None:
        await self._pass(self._settle_s)  # the rotor swings for a while after the last step
        await self._agree()
        await self.device.registers.write("ENC_IN_CONF", self.axis, fields={"cl_calibration_en": 1})
        await self._pass(self._settle_s)
        self._offset = (await self._read("CL_OFFSET")).value
        await self.device.registers.write("ENC_IN_CONF", self.axis, fields={"cl_calibration_en": 0})

    async def _agree(self) -> None:
        """One place for position and encoder, or the loop would drive the difference away as soon as it is closed.

        An incremental encoder is told where it is; an absolute one knows better than the ramp generator.
        """
        if (await self._read("GENERAL_CONF")).fields["serial_enc_in_mode"]:
            encoder = (await self._read("ENC_POS")).value
            await self._position.set_position(self.axis, encoder, with_encoder=False)
        else:
            await self.device.registers.write("ENC_POS", self.axis, value=(await self._read("XACTUAL")).value)

    async def _regulate(self, modus: int) -> None:
        fields: dict[str, int | str] = {"regulation_modus": modus, "cl_calibration_en": 0}
        written = await self.device.registers.write("ENC_IN_CONF", self.axis, fields=fields)
        self._regulation = REGULATIONS[written.fields["regulation_modus"]]

    async def _go(self, distance: int) -> None:
        target = (
            await self._moves.move_in_steps(self.axis, distance, relative=True, velocity_pps=self._velocity_pps)
        ).target_position
        deadline_s = self.device.device_time_s() + REACH_S
        while (await self._read("XACTUAL")).value != target:
            if self.device.device_time_s() > deadline_s:
                raise Failed(f"the motor did not get {distance} microsteps further within {REACH_S:g} s")
            await self.clock.sleep(POLL_S)

    async def _wait_for_rest(self) -> None:
        deadline_s = self.device.device_time_s() + REACH_S
        while (await self.device.monitor.axis_state(self.axis)).moving:
            if self.device.device_time_s() > deadline_s:
                raise Failed(f"the motor did not come to rest within {REACH_S:g} s")
            await self.clock.sleep(POLL_S)

    async def _pass(self, seconds: float) -> None:
        """Return when so much device time has passed."""
        until_s = self.device.device_time_s() + seconds
        while self.device.device_time_s() < until_s:
            await self.clock.sleep(POLL_S)

    async def _read(self, name: str) -> RegisterReading:
        return await self.device.registers.read(name, self.axis)

    async def _give_back(self) -> None:
        if self._disturbed:  # half a calibration is none
            await self._regulate(0)
        if self._scaled:
            await self.device.registers.write("CURRENT_CONF", self.axis, fields={"closed_loop_scale_en": 1})
        if not self._taken_over:
            await self._moves.stand_ready(self.axis)
