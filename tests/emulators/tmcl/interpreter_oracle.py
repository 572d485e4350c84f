"""A second interpreter of TMCL programs, plain and slow: one slot of 0.1 ms after the other, a command a slot.

It shares no code with the emulator. The motor stands still and nobody touches a switch: only timers interrupt.
"""

from __future__ import annotations

from dataclasses import dataclass, field

SLOTS_A_MS = 10
Row = tuple[int, int, int, int]


def _signed(number: int) -> int:
    number %= 1 << 32
    return number - (1 << 32) if number >= 1 << 31 else number


@dataclass
class Oracle:
    """The state of a module while `program` runs from address 0."""

    program: list[Row]
    later: bool = False
    """Whether the firmware knows the commands of later ones."""
    pc: int = 0
    accumulator: int = 0
    x: int = 0
    flags: set[str] = field(default_factory=lambda: {"ZERO"})
    stack: list[int] = field(default_factory=list)
    variables: dict[int, int] = field(default_factory=dict)
    coordinates: dict[int, int] = field(default_factory=dict)
    outputs: list[int] = field(default_factory=lambda: [0, 0])
    error: int = 0
    running: bool = True
    enabled: set[int] = field(default_factory=set)
    vectors: dict[int, int] = field(default_factory=dict)
    pending: set[int] = field(default_factory=set)
    periods: dict[int, int] = field(default_factory=dict)
    since: dict[int, int] = field(default_factory=dict)
    """Slots since each timer was set or last ran out."""
    saved: tuple[int, int, int, set[str], int | None] | None = None
    wait: int | None = None
    """Slots left."""
    waited: bool = False

    def run(self, slots: int) -> None:
        for _ in range(slots):
            self._slot()

    def _slot(self) -> None:
        if not self.running:
            return
        if 255 in self.enabled and self.saved is None:
            for number in sorted(self.pending):
                if number in self.enabled:
                    self.pending.remove(number)
                    self.saved = (self.pc, self.accumulator, self.x, set(self.flags), self.wait)
                    self.wait = None
                    self.pc = self.vectors[number]
                    break
        if self.wait == 0:
            self.wait = None
            self.pc += 1
        elif self.wait is None:
            self._command()
        # Time goes on: a wait that is interrupted has its end where it was.
        if self.wait is not None:
            self.wait = max(0, self.wait - 1)
        if self.saved is not None and self.saved[4] is not None:
            self.saved = (*self.saved[:4], max(0, self.saved[4] - 1))
        for number, period in self.periods.items():
            if period:
                self.since[number] += 1
                if self.since[number] == period * SLOTS_A_MS:
                    self.since[number] = 0
                    if number in self.enabled and number in self.vectors:
                        self.pending.add(number)

    def _refuse(self, status: int) -> None:
        self.error = status
        self.pc += 1

    def _load(self, value: int) -> None:
        self.accumulator = _signed(value)
        self.flags = self.flags - {"ZERO"} | ({"ZERO"} if self.accumulator == 0 else set())

    def _arithmetic(self, operation: int, operand: int) -> int | None:
        """What the accumulator becomes; None for a division by zero."""
        a = self.accumulator
        if operation == 0:
            return a + operand
        if operation == 1:
            return a - operand
        if operation == 2:
            return a * operand
        if operation in (3, 4):
            if operand == 0:
                return None
            remainder = abs(a) % abs(operand) * (-1 if a < 0 else 1)
            return remainder if operation == 4 else (a - remainder) // operand
        return {5: a & operand, 6: a | operand, 7: a ^ operand}[operation]

    def _command(self) -> None:
        opcode, type_, motor, value = self.program[self.pc] if self.pc < len(self.program) else (0, 0, 0, 0)
        following = self.pc + 1
        if opcode == 28:
            self.running = False
            return None
        if opcode == 19:
            if type_ > 9:
                return self._refuse(3)
            result = ~self.accumulator if type_ == 8 else value if type_ == 9 else self._arithmetic(type_, value)
            if result is None:
                return self._refuse(4)
            self._load(result)
        elif opcode == 33:
            if type_ > 10:
                return self._refuse(3)
            if type_ == 9:
                self.x = self.accumulator
            elif type_ == 10:
                a, self.x = self.x, self.accumulator
                self._load(a)
            else:
                result = ~self.x if type_ == 8 else self._arithmetic(type_, self.x)
                if result is None:
                    return self._refuse(4)
                self._load(result)
        elif opcode == 20:
            self.flags -= {"EQUAL", "LOWER", "GREATER"}
            self.flags.add("EQUAL" if self.accumulator == value else "LOWER" if self.accumulator < value else "GREATER")
        elif opcode == 21:
            conditions = [
                {"ZERO"}, None, {"EQUAL"}, None, {"GREATER"}, {"GREATER", "EQUAL"}, {"LOWER"}, {"LOWER", "EQUAL"},
                {"ETO"}, {"EAL"}, {"EDV"}, {"EPO"},
            ]  # fmt: skip
            if type_ >= len(conditions):
                return self._refuse(3)
            wanted = conditions[type_]
            if wanted is None:
                holds = ("ZERO" if type_ == 1 else "EQUAL") not in self.flags
            else:
                holds = bool(wanted & self.flags)
            if holds:
                if not 0 <= value < 2048:
                    return self._refuse(4)
                following = value
        elif opcode in (22, 23):
            if opcode == 23 and len(self.stack) == 8:
                pass
            elif not 0 <= value < 2048:
                return self._refuse(4)
            else:
                if opcode == 23:
                    self.stack.append(following)
                following = value
        elif opcode == 24:
            following = self.stack.pop() if self.stack else following
        elif opcode == 36:
            names = ["ETO", "EAL", "EDV", "EPO"]
            if type_ > 4:
                return self._refuse(3)
            self.flags -= set(names) if type_ == 0 else {names[type_ - 1]}
        elif opcode in (9, 10, 35) and motor == 2:
            if opcode == 10:
                self._load(self.variables.get(type_, 0))
            else:
                self.variables[type_] = value if opcode == 9 else self.accumulator
        elif opcode == 9 and motor == 3 and type_ < 3:
            self.periods[type_], self.since[type_] = value, 0
        elif opcode == 14 and motor == 2:
            if type_ > 1:
                return self._refuse(3)
            if value not in (0, 1):
                return self._refuse(4)
            self.outputs[type_] = value
        elif opcode == 15 and motor == 2:
            if type_ > 1:
                return self._refuse(3)
            self._load(self.outputs[type_])
        elif opcode in (30, 31, 39) and motor == 0:
            if type_ > 20:
                return self._refuse(3)
            if opcode == 31:
                self._load(self.coordinates.get(type_, 0))
            else:
                self.coordinates[type_] = value if opcode == 30 else self.accumulator
        elif opcode in (25, 26, 37):
            if type_ not in (0, 1, 2, 3, 15, 21, 27, 28, 39, 40, 41, 42) and (opcode == 37 or type_ != 255):
                return self._refuse(3)
            if opcode == 26:
                self.enabled.discard(type_)
                self.pending.discard(type_)
            elif opcode == 25:
                self.enabled.add(type_)
                self.pending.discard(type_)
            elif not 0 <= value < 2048:
                return self._refuse(4)
            else:
                self.vectors[type_] = value
        elif opcode == 38:
            if self.saved is not None:
                following, self.accumulator, self.x, self.flags, self.wait = self.saved
                self.saved = None
        elif opcode == 27:
            if type_ > 4:
                return self._refuse(3)
            if type_ and motor:
                return self._refuse(4)
            ticks = self.accumulator if value == -1 else value
            if type_ == 0 and ticks > 0:
                self.wait = ticks * 10 * SLOTS_A_MS
                return None
            if type_ in (2, 3):  # nobody presses a switch
                raise AssertionError("not for this oracle")
        elif self.later and (40 <= opcode <= 45 or opcode in (48, 49, 55, 56, 57, 80)):
            return self._later(opcode, type_, motor, value)
        else:
            self.error, self.running = 2, False
            return None
        self.pc = following
        return None

    # --- commands of later firmware (TMCM-1290) ----------------------------------------------------

    def _get(self, place: int | str) -> int:
        return self.accumulator if place == "A" else self.x if place == "X" else self.variables.get(int(place), 0)

    def _set(self, place: int | str, value: int) -> None:
        value = _signed(value)
        if place == "A":
            self.accumulator = value
        elif place == "X":
            self.x = value
        else:
            self.variables[int(place)] = value
        self.flags = self.flags - {"ZERO"} | ({"ZERO"} if value == 0 else set())

    def _later(self, opcode: int, type_: int, motor: int, value: int) -> None:
        following = self.pc + 1
        if opcode in (48, 49, 80):
            if opcode == 80:
                if type_ > 11:
                    return self._refuse(3)
                names = ("ZERO", "ZERO", "EQUAL", "EQUAL", "GREATER", "GREATER EQUAL", "LOWER", "LOWER EQUAL",
                         "ETO", "EAL", "EDV", "EPO")  # fmt: skip
                holds = any(name in self.flags for name in names[type_].split()) != (type_ in (1, 3))
                if not holds or len(self.stack) == 8:
                    self.pc = following
                    return None
            if value not in range(2048):
                return self._refuse(4)
            if opcode == 48:
                self.accumulator = self.x = 0
                self.flags, self.stack = {"ZERO"}, []
            elif opcode == 49:
                count = _signed(self.variables.get(type_, 0) - 1)
                self.variables[type_] = count
                value = value if count else following
            else:
                self.stack.append(following)
            self.pc = value
            return None
        if opcode >= 55:
            if self.x in range(256):
                if opcode == 56:
                    self._load(self.variables.get(self.x, 0))
                else:
                    self.variables[self.x] = value if opcode == 55 else self.accumulator
            self.pc = following
            return None
        if type_ > 11 or (opcode == 45 and type_ == 10):
            return self._refuse(3)
        if opcode == 40 and value not in range(256):
            return self._refuse(4)
        first: int | str = "A" if opcode == 42 else "X" if opcode == 44 else motor
        second: int | str = value if opcode == 40 else "A" if opcode == 41 else "X" if opcode == 43 else motor
        left, right = self._get(first), value if opcode == 45 else self._get(second)
        if type_ == 11:
            self.flags -= {"EQUAL", "LOWER", "GREATER"}
            self.flags.add("EQUAL" if left == right else "LOWER" if left < right else "GREATER")
        elif type_ == 10:
            self._set(second, left)
            self._set(first, right)
        elif type_ >= 8:
            self._set(first, right if type_ == 9 else ~left if opcode == 45 else ~right)
        elif type_ in (3, 4) and right == 0:
            return self._refuse(4)
        else:
            kept, self.accumulator = self.accumulator, left
            result = self._arithmetic(type_, right)
            self.accumulator = kept
            assert result is not None
            self._set(first, result)
        self.pc = following
        return None
