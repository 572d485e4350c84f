"""Which pins of this server's emulators are wired together: made of the nets that their options name.

A net is the same name at pins of several emulators. START pins go with START pins, one step output with any number of
step inputs, and DIAG of one driver with inputs for stop switches. What cannot be wired is left open, and says why.
Wires may come and go while the emulators live on.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from ..errors import UnknownThing, UsageError
from .core.base import EmulatorBase
from .core.coupling import SIGNAL_S, Coupling, Pin, Sampler, groups
from .core.pins import PinWire, WiredChip

Role = Literal["level", "output", "input", "signal", "sense"]
_KINDS: dict[Role, str] = {
    "level": "START",
    "output": "steps",
    "input": "steps",
    "signal": "signals",
    "sense": "signals",
}
"""What goes over a wire, of which no two go over one."""


@dataclass(frozen=True, slots=True)
class Present:
    """An emulator that is there. `key` is what people call it: the id of its device."""

    key: str
    emulator: object
    sampler: Sampler | None = None


@dataclass(frozen=True, slots=True)
class NetPin:
    """A pin on a net."""

    key: str
    pin: str
    role: Role


@dataclass(frozen=True, slots=True)
class WirablePin(NetPin):
    """A pin that can be wired, and the nets it is on."""

    nets: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class NetState:
    """A net by its name. `open` says why it connects nothing; None where it does.

    equal_clocks : whether an edge is seen at the very clock; else it is rounded to a clock of whoever sees it.
    """

    net: str
    pins: tuple[NetPin, ...]
    open: str | None
    equal_clocks: bool
    seen_within_s: float
    """How far apart an edge is seen at the most [s]."""

    @property
    def kind(self) -> str:
        """What goes over it."""
        return _KINDS[self.pins[0].role]


@dataclass(frozen=True, slots=True)
class _Wired:
    key: str
    emulator: EmulatorBase[Any, Any]
    chip: WiredChip
    sampler: Sampler | None


class EmulatorWiring:
    """All wires between the emulators of one server. Used by one thread, which is the one that talks to them."""

    def __init__(self) -> None:
        self._couplings: dict[Hashable, Coupling] = {}
        self._nets: tuple[NetState, ...] = ()
        self._there: list[_Wired] = []

    @property
    def pins(self) -> tuple[WirablePin, ...]:
        """Every pin that can be wired, by emulator."""
        return tuple(
            WirablePin(one.key, pin, _role(one.chip, pin), tuple(w.net for w in one.emulator.wires if w.pin == pin))
            for one in self._there
            for pin in _pins(one.chip)
        )

    @property
    def nets(self) -> tuple[NetState, ...]:
        """By name."""
        return self._nets

    def sync(self, present: Sequence[Present]) -> None:
        """These are all emulators now. Couplings whose members and nets are as before go on undisturbed."""
        there = [
            _Wired(each.key, each.emulator, chip, each.sampler)
            for each in present
            if isinstance(each.emulator, EmulatorBase) and (chip := each.emulator.wired) is not None
        ]
        self._there = there
        by_net: dict[str, list[tuple[int, str]]] = {}
        for number, one in enumerate(there):
            for wire in one.emulator.wires:
                by_net.setdefault(wire.net, []).append((number, wire.pin))
        states = {net: _judge(net, pins, there) for net, pins in by_net.items()}
        good = {net: pins for net, pins in by_net.items() if states[net].open is None}
        wanted: dict[Hashable, tuple[list[int], list[str]]] = {}
        for group in groups([[number for number, _ in pins] for pins in good.values()]):
            members = sorted(group)
            nets = sorted(net for net, pins in good.items() if pins[0][0] in group)
            key = (tuple(id(there[n].emulator) for n in members), tuple((net, tuple(good[net])) for net in nets))
            wanted[key] = members, nets
        for old in [key for key in self._couplings if key not in wanted]:
            self._couplings.pop(old).end()
        for made_of, (members, nets) in wanted.items():
            if made_of not in self._couplings:
                pins = {net: [Pin(members.index(number), pin) for number, pin in good[net]] for net in nets}
                self._couplings[made_of] = Coupling(
                    [(there[n].emulator, there[n].chip, there[n].sampler) for n in members],
                    [(net, pins[net]) for net in nets if states[net].kind == "START"],
                    [_from_one(states[net], pins[net]) for net in nets if states[net].kind == "steps"],
                    [_from_one(states[net], pins[net]) for net in nets if states[net].kind == "signals"],
                )
        self._nets = tuple(states[net] for net in sorted(states))

    def assign(self, net: str, pins: Sequence[tuple[str, str]]) -> dict[str, Sequence[PinWire]]:
        """Have exactly these pins, each a key and its name, on a net; none removes it. `sync` makes the wires of it.

        By key the wires of each emulator that has others now. Raises UnknownThing, and UsageError for pins that cannot
        be wired; then nothing has changed.
        """
        wanted = [self._found(net, *pin) for pin in pins]
        if wanted and (why := _judge(net, wanted, self._there).open) is not None:
            raise UsageError(f"these pins make no net: {why}")
        if not wanted and all(state.net != net for state in self._nets):
            raise UnknownThing("net", net, [state.net for state in self._nets])
        changed: dict[str, Sequence[PinWire]] = {}
        for number, one in enumerate(self._there):
            wires = [wire for wire in one.emulator.wires if wire.net != net]
            wires += [PinWire.model_validate({"pin": pin, "net": net}) for member, pin in wanted if member == number]
            if wires != list(one.emulator.wires):
                one.emulator.wires = changed[one.key] = wires
        return changed

    def _found(self, net: str, key: str, pin: str) -> tuple[int, str]:
        numbers = [number for number, one in enumerate(self._there) if one.key == key]
        if not numbers:
            raise UnknownThing("emulated device with pins", key, [one.key for one in self._there])
        one = self._there[numbers[0]]
        if pin not in _pins(one.chip):
            raise UnknownThing(f"pin of {key}", pin, list(_pins(one.chip)))
        for wire in one.emulator.wires:
            if wire.pin == pin and wire.net != net:
                raise UsageError(f"{key} {pin} is on net {wire.net}; remove it there first")
        return numbers[0], pin


def _pins(chip: WiredChip) -> tuple[str, ...]:
    return (*chip.levels, *chip.outputs, *chip.inputs, *chip.signals, *chip.senses)


def _role(chip: WiredChip, pin: str) -> Role:
    of_role: tuple[tuple[Role, tuple[str, ...]], ...] = (
        ("level", chip.levels),
        ("output", chip.outputs),
        ("signal", chip.signals),
        ("sense", chip.senses),
    )
    return next((role for role, pins in of_role if pin in pins), "input")


def _from_one(state: NetState, pins: Sequence[Pin]) -> tuple[Pin, list[Pin]]:
    """The output of a net of steps or of a signal, and its inputs."""
    by_role = list(zip(state.pins, pins, strict=True))
    output = next(pin for told, pin in by_role if told.role in ("output", "signal"))
    return output, [pin for told, pin in by_role if told.role in ("input", "sense")]


def _judge(net: str, pins: Sequence[tuple[int, str]], there: Sequence[_Wired]) -> NetState:
    roles: list[Role] = []
    missing = ""
    for number, pin in pins:
        chip = there[number].chip
        roles.append(_role(chip, pin))
        if pin not in _pins(chip):
            missing = f"{there[number].key} has no pin {pin}"
    members = [number for number, _ in pins]
    kinds = [kind for kind in dict.fromkeys(_KINDS.values()) if kind in {_KINDS[role] for role in roles}]
    why: str | None = None
    if missing:
        why = missing
    elif len(set(members)) < len(members):
        why = "it has two pins of one device"
    elif len(members) < 2:
        why = "no other pin is on it"
    elif len(kinds) > 1:
        why = f"{' and '.join(kinds)} are not wired together"
    elif kinds == ["steps"] and roles.count("output") != 1:
        why = f"steps come from one output, and it has {roles.count('output')}"
    elif kinds == ["signals"] and roles.count("signal") != 1:
        why = f"a signal comes from one output, and it has {roles.count('signal')}"
    shown = tuple(NetPin(there[number].key, pin, role) for (number, pin), role in zip(pins, roles, strict=True))
    chips = [there[number].chip for number in members]
    looked_at_s = SIGNAL_S if kinds == ["signals"] else 0.0
    equal = len({chip.clock_hz for chip in chips}) == 1 and not looked_at_s
    within_s = 0.0 if equal else looked_at_s + max((chip.tick_clocks + 1) / chip.clock_hz for chip in chips)
    return NetState(net, shown, why, equal, within_s)
