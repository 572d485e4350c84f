"""What an identification found, as its record tells it: figures and findings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ...calc.motors.friction_backlash import Torn
from ...calc.motors.holding_torque import agreed, torque_by_back_emf
from ...calc.motors.ring_down import Fitted, RingDown
from ...calc.motors.slow_turns import SlowTurn
from ...calc.positions.encoder_resolution import USUAL_COUNTS
from ...number_text import plain
from ..document import Identification
from ..fitted import Estimate, estimate, fitted, ringing
from ..parts import Interval
from ..record import Finding
from .found import Identified
from .plan import Ground

LINE = 4
"""Counts of a line."""


@dataclass(frozen=True, slots=True)
class Measured:
    """What was fitted; None where it could not be, `why` then."""

    turn: SlowTurn
    torn: Torn | None
    rings: RingDown | None
    why: list[str]


def identified(found: Measured, ground: Ground, wanted: Identification) -> Identified:
    """As it is stored."""
    told = Identified(
        microsteps_per_turn=ground.turn,
        run_scale=ground.current.run_scale,
        hold_torque_nm=wanted.hold_torque_nm,
        supply_v=wanted.supply_v,
        eccentricity_deg=estimate(found.turn.eccentricity, 360 / ground.turn),
    )
    if found.torn is not None:
        told.backlash_microsteps = estimate(found.torn.backlash, 4 * ground.full_step / (2 * math.pi))
        told.friction_share = estimate(found.torn.friction)
    if ground.a_count is not None:
        per_turn = ground.turn / ground.a_count
        counts = found.turn.ratio.scaled(per_turn)
        told.encoder_counts_per_turn = estimate(counts)
        told.encoder_lines = _lines(counts)
    if found.rings is not None:
        _of_rings(told, found.rings, ground.turn / ground.full_step / 4)
    return told


def _of_rings(told: Identified, rings: RingDown, teeth: float) -> None:
    square = (2 * math.pi * rings.resonance_hz.value) ** 2
    share = 2 * rings.resonance_hz.half / rings.resonance_hz.value
    told.resonance_hz, told.damping_ratio = estimate(rings.resonance_hz), estimate(rings.damping)
    told.detent_share = estimate(rings.detent)
    told.inertia_per_torque_s2 = estimate(Fitted(teeth / square, share * teeth / square))
    told.ringing = ringing(rings)


def torque_of(wanted: Identification, back_emf: Fitted | None) -> tuple[Fitted | None, str]:
    """Holding torque with the run current [N m], None where nothing says it; and what there is to say about it.

    Where what was told and the back-EMF have nothing in common, nobody can tell which is wrong: it may be either.
    """
    torque, off, current = wanted.hold_torque_nm, wanted.torque_tolerance, wanted.run_current_a
    told = None if torque is None else Fitted(torque, torque * off)
    if back_emf is None or current is None:
        return told, ""
    measured = torque_by_back_emf(back_emf, current)
    if told is None:
        return measured, ""
    if not told.half:
        return told, ""  # so sure is whoever told it
    both = agreed(told, measured)
    if both is not None:
        return both, ""
    low = min(told.value - told.half, measured.value - measured.half)
    high = max(told.value + told.half, measured.value + measured.half)
    said = f"{plain(told.value, 3)} N m was told, and the back-EMF says {plain(measured.value, 3)} N m"
    why = f"holding torque as told: {said}: another motor, another current, or another supply than was told"
    return Fitted((low + high) / 2, (high - low) / 2), why


def in_torques(told: Identified, torque: Fitted) -> None:
    """Add inertia, friction and detent in their units to what is known of them as shares of that torque [N m]."""
    told.torque_nm = estimate(torque)
    told.inertia_kgm2 = _scaled(told.inertia_per_torque_s2, torque)
    told.viscous_nms = _scaled(_viscous_per_torque(told), torque)
    told.detent_torque_nm = _scaled(told.detent_share, torque)
    told.friction_nm = _scaled(told.friction_share, torque)


def _viscous_per_torque(told: Identified) -> Estimate | None:
    """Viscous friction over holding torque [s]: 2 D J w for each J w^2 / teeth."""
    damping, per_torque, resonance = told.damping_ratio, told.inertia_per_torque_s2, told.resonance_hz
    if damping is None or per_torque is None or resonance is None:
        return None
    inertia = fitted(per_torque)
    value = 2 * damping.value * inertia.value * 2 * math.pi * resonance.value
    share = fitted(damping).half / damping.value + inertia.half / inertia.value / 2
    return estimate(Fitted(value, value * share))


def _scaled(share: Estimate | None, torque: Fitted) -> Estimate | None:
    """A share of a torque that itself is known within its interval."""
    if share is None:
        return None
    low, high = share.interval.low * (torque.value - torque.half), share.interval.high * (torque.value + torque.half)
    return Estimate(value=share.value * torque.value, interval=Interval(low=low, high=high))


def _lines(counts: Fitted) -> int | None:
    """The usual number that fits, else the measured one where it is sure; None where it is not."""
    slack = max(2 * counts.half, LINE / 4)
    fitting = [usual for usual in USUAL_COUNTS if usual % LINE == 0 and abs(counts.value - usual) <= slack]
    if len(fitting) == 1:
        return fitting[0] // LINE
    return round(counts.value / LINE) if counts.half < LINE / 2 else None


FIGURES: Sequence[tuple[str, str, str, str]] = (
    ("resonance_hz", "resonance", "of small swings with the run current; it goes with the root of the current", "Hz"),
    ("damping_ratio", "damping", "viscous friction over the critical one", ""),
    (
        "inertia_per_torque_s2",
        "inertia over torque",
        "of rotor and load, for each N m of holding torque",
        "kg m2/(N m)",
    ),
    (
        "torque_nm",
        "holding torque",
        "with the run current, by what was told and by what the back-EMF says",
        "N m",
    ),
    ("inertia_kgm2", "inertia", "of rotor and load, by the holding torque", "kg m2"),
    ("friction_share", "friction", "Coulomb friction, as a share of the holding torque with the run current", ""),
    ("friction_nm", "friction torque", "the same, by the holding torque", "N m"),
    ("detent_share", "detent torque", "its amplitude, as a share of the holding torque with the run current", ""),
    ("detent_torque_nm", "detent torque, absolute", "the same, by the holding torque", "N m"),
    ("viscous_nms", "viscous friction", "by the holding torque", "N m s"),
    (
        "resistance_ohm",
        "resistance",
        "of one coil, by StealthChop's amplitude at rest (automatic tuning), for supply and current as they were told",
        "ohm",
    ),
    (
        "inductance_h",
        "inductance",
        "of one coil, by what more current takes more of the amplitude at one speed",
        "H",
    ),
    (
        "back_emf_v_s_rad",
        "back-EMF constant",
        "peak of one coil, by what of the amplitude at speed less current leaves; the torque an ampere, too",
        "V s/rad",
    ),
    (
        "backlash_microsteps",
        "backlash",
        "before the encoder: what is between both ways and does not grow with less current",
        "microsteps",
    ),
    ("encoder_counts_per_turn", "encoder counts", "of a turn, four a line", ""),
    ("eccentricity_deg", "eccentricity", "once a turn: of the encoder or its coupling", "deg of the shaft"),
)
"""Name in the record, name for people, what it is, unit."""
UNTOLD = {
    "inertia_kgm2": "with neither holding torque nor back-EMF only inertia over torque can be told",
    "encoder_counts_per_turn": "what a count is set to be is not known",
}


def findings(told: Identified, why: Sequence[str]) -> list[Finding]:
    """As people read it; `why` something could not be fitted."""
    said = []
    for name, title, text, unit in FIGURES:
        found: Estimate | None = getattr(told, name)
        if name == "torque_nm" and told.back_emf_v_s_rad is None:
            continue  # it was told, and nothing else is known
        if found is not None:
            said.append(Finding(name=title, text=text, value=found.value, unit=unit, interval=found.interval))
        elif name in UNTOLD:
            said.append(Finding(name=title, text=UNTOLD[name], sure="cannot be told"))
    if told.encoder_lines is not None:
        text = f"{told.encoder_lines} lines: the number that fits"
        said.append(Finding(name="encoder lines", text=text, value=float(told.encoder_lines)))
    elif told.encoder_counts_per_turn is not None:
        text = f"{plain(told.encoder_counts_per_turn.value, 6)} counts a turn fit no number of lines for sure"
        said.append(Finding(name="encoder lines", text=text, sure="cannot be told"))
    for one in why:
        name, _, text = one.partition(": ")
        said.append(Finding(name=name, text=text, sure="cannot be told"))
    return said
