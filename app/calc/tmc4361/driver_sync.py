"""chopSync and dcStep of a TMC4361 in Hz, seconds and speeds: what its registers come to, and what does not fit.

Sources: API (fOSC = fCLK / CHOPSYNC_DIV, 96..818; DC_TIME, DC_SG, DC_BLKTIME and DC_LSPTM in clocks; what a TMC26x has
to be set to), STEPPYR. That DC_LSPTM is the longest that a full step waits is our reading of its name there.
"""

from __future__ import annotations

from dataclasses import dataclass

CHOPSYNC_LEAST, CHOPSYNC_MOST = 96, 818
"""CHOPSYNC_DIV (API)."""
AUDIBLE_HZ = 20e3
TMC23X, TMC24X = 8, 9
TMC26X_SD, TMC2130_SD = 11, 12
"""spi_output_format."""
CHOPSYNC_PIN = 2
"""stdby_clk_pin_assignment."""
DC_SG_CLOCKS = 16


@dataclass(frozen=True)
class ChopSync:
    """The chopper's clock [Hz], at standstill where that differs, and the divider nearest to a wanted clock."""

    hz: float
    rest_hz: float
    nearest_div: int
    warnings: tuple[str, ...]


def chopsync(
    div: int, clock_hz: float, *, output_format: int, pin: int, doubled: bool, wanted_hz: float | None = None
) -> ChopSync:
    """What CHOPSYNC_DIV gives. Raises ValueError for a divider of 0."""
    if div < 1:
        raise ValueError(f"CHOPSYNC_DIV is 1 at least ({CHOPSYNC_LEAST} to {CHOPSYNC_MOST} work), got {div}")
    hz = clock_hz / div
    doubles = doubled and output_format == TMC24X
    wanted = hz if wanted_hz is None else wanted_hz
    found = []
    if not CHOPSYNC_LEAST <= div <= CHOPSYNC_MOST:
        found.append(f"CHOPSYNC_DIV works from {CHOPSYNC_LEAST} to {CHOPSYNC_MOST}")
    if hz < AUDIBLE_HZ:
        found.append(f"{hz / 1e3:.3g} kHz can be heard")
    if output_format not in (TMC23X, TMC24X):
        found.append("chopSync is for a TMC23x or TMC24x at the SPI output: spi_output_format is another one")
    elif pin != CHOPSYNC_PIN:
        found.append("STDBY_CLK does not give the chopper's clock: set stdby_clk_pin_assignment to 2")
    return ChopSync(
        hz=hz,
        rest_hz=2 * hz if doubles else hz,
        nearest_div=min(max(round(clock_hz / wanted), CHOPSYNC_LEAST), CHOPSYNC_MOST),
        warnings=tuple(found),
    )


@dataclass(frozen=True)
class DcStep:
    """What dcStep's registers come to.

    full_steps_per_s : at DC_VEL; full_step_s : time of one there [s]; least_full_steps_per_s : with DC_LSPTM
    rpm, least_rpm : the same as speeds; on_time_s, lost_s, blank_s : DC_TIME, DC_SG, DC_BLKTIME [s]
    """

    full_steps_per_s: float
    full_step_s: float | None
    least_full_steps_per_s: float | None
    rpm: float
    least_rpm: float | None
    on_time_s: float
    lost_s: float
    blank_s: float
    warnings: tuple[str, ...]


def dcstep(
    clock_hz: float,
    *,
    mode: int,
    dc_vel_pps: int,
    microsteps: int,
    full_steps_per_rev: int,
    dc_time: int,
    dc_sg: int,
    blank: int,
    slowest: int,
    output_format: int,
    v_max_pps: float = 0.0,
) -> DcStep:
    """`slowest` is DC_LSPTM, `blank` DC_BLKTIME; v_max_pps 0: not known. Raises ValueError without microsteps."""
    if microsteps < 1 or full_steps_per_rev < 1:
        raise ValueError("a full step has 1 microstep at least, and a turn 1 full step")
    rate = dc_vel_pps / microsteps
    step_s = 1 / rate if rate else None
    least = clock_hz / slowest if slowest else None
    per_minute = 60 / full_steps_per_rev
    times = (dc_time / clock_hz, dc_sg * DC_SG_CLOCKS / clock_hz, blank / clock_hz)
    found = []
    if mode:
        if not dc_vel_pps:
            found.append("DC_VEL is 0: dcStep never acts")
        if v_max_pps and dc_vel_pps >= v_max_pps:
            found.append("DC_VEL is not below VMAX: dcStep never acts")
        if least is not None and rate and least >= rate:
            found.append(
                f"DC_LSPTM makes a full step after {slowest / clock_hz * 1e3:.3g} ms at the latest, sooner than at"
                " DC_VEL: the motor cannot be waited for"
            )
        if not slowest:
            found.append("DC_LSPTM is 0: no full step is waited for")
        if not dc_time:
            found.append("DC_TIME is 0: no on time is short enough to be ready")
        if times[1] > times[0]:
            found.append("DC_SG is longer than DC_TIME: each full step counts as lost")
        if step_s is not None and times[2] >= step_s:
            found.append("DC_BLKTIME is longer than a full step at DC_VEL: nothing is compared")
        if mode == 3 and output_format not in (TMC26X_SD, 10):
            found.append("mode 3 finds STEP_READY of a TMC26x: spi_output_format is another driver's")
        if mode == 2 and output_format not in (TMC2130_SD, 13):
            found.append("mode 2 takes STEP_READY of a TMC2130: spi_output_format is another driver's")
    return DcStep(
        full_steps_per_s=rate,
        full_step_s=step_s,
        least_full_steps_per_s=least,
        rpm=rate * per_minute,
        least_rpm=None if least is None else least * per_minute,
        on_time_s=times[0],
        lost_s=times[1],
        blank_s=times[2],
        warnings=tuple(found),
    )
