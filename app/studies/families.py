"""Which registers make the ramp of each family, as far as studies can set it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

from ..devices.core.device import Device
from ..errors import WrongState
from ..registers.capabilities import Capability
from .chopper.setting import ChopperPlaces
from .closed_loop.setting import LoopPlaces
from .current_settings import CurrentPlaces
from .document import Shape
from .identification.places import IdentificationPlaces
from .least_current.cool_setting import CoolPlaces
from .ramp_settings import RampRegisters
from .resonance_map.places import RipplePlaces
from .scored_move.places import HandPlace
from .stallguard.setting import StallPlaces
from .stealthchop.setting import StealthPlaces
from .tmc5xxx.by_hand import BY_HAND as BY_HAND_5XXX
from .tmc5xxx.chopper import CHOPPER
from .tmc5xxx.coolstep import COOLSTEP
from .tmc5xxx.current import CURRENT
from .tmc5xxx.identification import AMPLITUDE, ENCODER, HOP
from .tmc5xxx.ramp import RAMP as SIX_POINT
from .tmc5xxx.ramp import SIX_POINTS
from .tmc5xxx.ripple import RIPPLE
from .tmc5xxx.stall import STALL
from .tmc5xxx.stealthchop import STEALTHCHOP
from .tmc5xxx.unsearched import UNSEARCHED
from .tmc428.ramp import RAMP as TICKED_RAMP
from .tmc4361.by_hand import BY_HAND as BY_HAND_4361
from .tmc4361.loop import POSITION_LOOP
from .tmc4361.ramp import BOWS
from .tmc4361.ramp import RAMP as S_RAMP
from .tmc4361.unsearched import UNSEARCHED as UNSEARCHED_4361
from .tmcl.by_hand import BY_HAND as MODULE_BY_HAND
from .tmcl.chopper import CHOPPER as MODULE_CHOPPER
from .tmcl.coolstep import COOLSTEP as MODULE_COOLSTEP
from .tmcl.current import CURRENT as MODULE_CURRENT
from .tmcl.ramp import HOP as MODULE_HOP
from .tmcl.ramp import RAMP as MODULE_RAMP
from .tmcl.ramp import SIX_POINTS as MODULE_SIX_POINTS
from .tmcl.stall import STALL as MODULE_STALL
from .tmcl.unsearched import UNSEARCHED as MODULE_UNSEARCHED

T = TypeVar("T")

RAMPS: Mapping[str, RampRegisters] = {
    "tmc428": TICKED_RAMP,
    "tmc5xxx": SIX_POINT,
    "tmc4361": S_RAMP,
    "tmcl": MODULE_RAMP,
}
SHAPES: Mapping[Shape, tuple[Capability, Mapping[str, RampRegisters]]] = {
    "six points": ("ramp.sixpoint", {"tmc5xxx": SIX_POINTS, "tmcl": MODULE_SIX_POINTS}),
    "bows": ("ramp.s", {"tmc4361": BOWS}),
}
"""Ramps whose shape is searched, of devices that can have them."""
IDENTIFICATIONS: Mapping[str, IdentificationPlaces] = {
    "tmc5xxx": IdentificationPlaces(HOP, ENCODER, AMPLITUDE),
    "tmcl": IdentificationPlaces(MODULE_HOP),
}
CURRENTS: Mapping[str, CurrentPlaces] = {"tmc5xxx": CURRENT, "tmcl": MODULE_CURRENT}
COOLSTEPS: Mapping[str, CoolPlaces] = {"tmc5xxx": COOLSTEP, "tmcl": MODULE_COOLSTEP}
CHOPPERS: Mapping[str, ChopperPlaces] = {"tmc5xxx": CHOPPER, "tmcl": MODULE_CHOPPER}
STEALTHCHOPS: Mapping[str, StealthPlaces] = {"tmc5xxx": STEALTHCHOP}
LOOPS: Mapping[str, LoopPlaces] = {"tmc4361": POSITION_LOOP}
RIPPLES: Mapping[str, RipplePlaces] = {"tmc5xxx": RIPPLE}
HANDS: Mapping[str, Sequence[HandPlace]] = {"tmc5xxx": BY_HAND_5XXX, "tmc4361": BY_HAND_4361, "tmcl": MODULE_BY_HAND}
STALLS: Mapping[str, Sequence[StallPlaces]] = {"tmc5xxx": STALL, "tmcl": MODULE_STALL}
UNSEARCHEDS: Mapping[str, frozenset[str]] = {
    "tmc5xxx": UNSEARCHED,
    "tmc4361": UNSEARCHED_4361,
    "tmcl": MODULE_UNSEARCHED,
}


def ramp_of(device: Device) -> RampRegisters:
    """The registers of its ramp. Raises WrongState for a family that no study sets."""
    return _known(RAMPS, device, "no study sets the ramp of a {} yet", "a chip with an encoder input can be tuned")


def shapes_of(device: Device) -> Mapping[Shape, RampRegisters]:
    """The registers of its ramp by the shapes that a study can search."""
    return {
        shape: ramps[device.family.family]
        for shape, (capability, ramps) in SHAPES.items()
        if device.family.can(capability) and device.family.family in ramps
    }


def stalls_of(device: Device) -> Sequence[StallPlaces]:
    """Where it keeps what each generation of its StallGuard works by. Raises WrongState for a family without any."""
    remedy = "find its threshold by hand on the page StallGuard"
    return _known(STALLS, device, "no study sets the StallGuard of a {} yet", remedy)


def identification_of(device: Device) -> IdentificationPlaces:
    """Where it keeps what an identification sets. Raises WrongState for a family whose axes no study identifies."""
    remedy = "a TMC5xxx or a TMCL module with an encoder can be looked at"
    return _known(IDENTIFICATIONS, device, "no study identifies what hangs on a {} yet", remedy)


def current_of(device: Device) -> CurrentPlaces:
    """Where it keeps the scales of its current. Raises WrongState for a family whose current no study sets."""
    return _known(CURRENTS, device, "no study sets the current of a {} yet", "set it by hand on its page of currents")


def loop_of(device: Device) -> LoopPlaces:
    """Where it keeps the gains of its position loop. Raises WrongState for a family without one that a study sets."""
    remedy = "a TMC4361 with an encoder has one (PID)"
    return _known(LOOPS, device, "no study sets a position loop of a {}", remedy)


def chopper_of(device: Device) -> ChopperPlaces:
    """Where it keeps its chopper. Raises WrongState for a family whose chopper no study sets."""
    remedy = "calculate it from the motor on the page Current and chopper"
    return _known(CHOPPERS, device, "no study sets the chopper of a {} yet", remedy)


def stealthchop_of(device: Device) -> StealthPlaces:
    """Where it keeps its StealthChop. Raises WrongState for a family whose StealthChop no study sets."""
    remedy = "calculate it from the motor on the page Current and chopper"
    return _known(STEALTHCHOPS, device, "no study sets the StealthChop of a {} yet", remedy)


def ripple_of(device: Device) -> RipplePlaces | None:
    """What it has of settings that move ripple, and that a study sets; None for a family without any."""
    return RIPPLES.get(device.family.family)


def coolstep_of(device: Device) -> CoolPlaces | None:
    """Where it keeps CoolStep; None for a family without one that a study sets."""
    return COOLSTEPS.get(device.family.family)


def by_hand_of(device: Device) -> Sequence[HandPlace]:
    """What of it is tuned by hand beside its ramp."""
    return HANDS.get(device.family.family, ())


def unsearched_of(device: Device) -> frozenset[str]:
    """Registers and fields that no search tries: they protect the power stage, or say what a step is."""
    return UNSEARCHEDS.get(device.family.family, frozenset())


def _known(places: Mapping[str, T], device: Device, none: str, remedy: str) -> T:
    """What its family has. Raises WrongState: `none` with the family's title in it, and what to do."""
    found = places.get(device.family.family)
    if found is None:
        raise WrongState(none.format(device.family.title), remedy)
    return found
