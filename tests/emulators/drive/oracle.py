"""The drive again, plain and slow: Python numbers, every tick is a tick, the motor is worked out even when it stands.

Written from the laws in the kernel's docstring without its code. Registers are set as attributes, in the chip's units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from app.emulators.drive.options import DriveOptions

STEP = 1 << 25
POSITION, FORWARD, BACKWARD, HOLD = range(4)


def wrap(x: int) -> int:
    x &= 0xFFFFFFFF
    return x - (1 << 32) if x >= 1 << 31 else x


@dataclass
class PlainRamp:
    """Ramp generator without switches. Velocities here have nine fraction bits: `v` is VACTUAL * 512."""

    mode: int = POSITION
    x: int = 0
    target: int = 0
    vstart: int = 0
    a1: int = 0
    v1: int = 0
    amax: int = 0
    vmax: int = 0
    dmax: int = 1
    d1: int = 1
    vstop: int = 512
    wait_ticks: int = 0
    v: int = 0
    rest: int = 0
    waiting: int = 0

    def after_deceleration(self, u: int) -> int:
        if self.v1 and u <= self.v1:
            return u - self.d1
        if self.v1 and u - self.dmax < self.v1:
            # the tick's first part takes it to v1, what is left of the tick goes on with d1
            return self.v1 - self.d1 * (self.dmax - (u - self.v1)) // self.dmax
        return u - self.dmax

    def after_acceleration(self, u: int) -> int:
        if u < self.v1:
            if u + self.a1 <= self.v1:
                return u + self.a1
            return self.v1 + self.amax * (self.a1 - (self.v1 - u)) // self.a1
        return u + self.amax

    def braking_way(self, u: float) -> float:
        """Continuous braking distance from `u` to vstop [1/2^25 step]."""
        knee = max(self.v1, self.vstop)
        way = 0.0
        if u > knee:
            way += (u * u - knee * knee) / (2 * self.dmax)
        low = min(u, knee)
        if low > self.vstop:
            way += (low * low - self.vstop * self.vstop) / (2 * self.d1)
        return way

    def highest(self, left: int) -> int:
        """Solution of u + braking_way(u) = left, in doubles as the law says."""
        if left <= self.vstop:
            return max(left, 1)
        base, d, way = float(self.vstop), float(self.dmax), float(left)
        if self.v1 > self.vstop:
            lower = (float(self.v1) * self.v1 - base * base) / (2.0 * self.d1)
            if way > self.v1 + lower:
                way, base = way - lower, float(self.v1)
            else:
                d = float(self.d1)
        return max(math.floor(math.sqrt(d * d + base * base + 2.0 * d * way) - d), 1)

    def halt(self) -> None:
        if self.v:
            self.waiting = self.wait_ticks
        self.v = self.rest = 0

    def go(self, direction: int, u: int) -> int:
        if u == 0:
            self.halt()
            return 0
        self.v = direction * u
        whole, self.rest = divmod(self.rest + u, STEP)
        self.x = wrap(self.x + direction * whole)
        return direction * whole

    def stopped_at(self, u: int) -> int:
        return 0 if u <= 0 or u < self.vstop else u

    def tick(self) -> int:
        """Steps made."""
        if self.v == 0 and self.waiting:
            self.waiting -= 1
            return 0
        return self.position_tick() if self.mode == POSITION else self.velocity_tick()

    def velocity_tick(self) -> int:
        if self.mode == HOLD:
            return self.go(1 if self.v > 0 else -1, abs(self.v))
        wanted = 1 if self.mode == FORWARD else -1
        if self.v == 0:
            if self.vmax == 0:
                return 0
            return self.go(wanted, min(min(self.vstart, self.vmax) + self.amax, self.vmax))
        u, direction = abs(self.v), 1 if self.v > 0 else -1
        if direction != wanted or self.vmax == 0:
            return self.go(direction, self.stopped_at(u - self.amax))
        if u < self.vmax:
            return self.go(direction, min(u + self.amax, self.vmax))
        return self.go(direction, max(u - self.amax, self.vmax))

    def position_tick(self) -> int:
        way = wrap(self.target - self.x)
        starting = self.v == 0
        if starting and (way == 0 or self.vmax == 0):
            return 0
        direction = (1 if way > 0 else -1) if starting else (1 if self.v > 0 else -1)
        u = min(self.vstart, self.vmax) if starting else abs(self.v)
        left = direction * way * STEP - self.rest
        slower = self.after_deceleration(u)
        if left <= 0 or self.vmax == 0:
            return self.go(direction, self.stopped_at(slower))
        new = min(self.after_acceleration(u), self.vmax, self.highest(left))
        if not starting:
            new = max(new, slower)
        if new >= left and new <= self.vstop + max(self.dmax, self.d1):
            self.x, self.v, self.rest, self.waiting = self.target, 0, 0, self.wait_ticks
            return way
        return self.go(direction, new)


@dataclass
class PlainMotor:
    """Coils, rotor and friction; one call is one tick of 256 clocks, in as many physics steps as the options say."""

    options: DriveOptions
    theta: float = 0.0
    omega: float = 0.0
    currents: list[float] = field(default_factory=lambda: [0.0, 0.0])
    load_nm: float = 0.0

    def tick(self, references: tuple[float, float], *, volts: bool = False) -> None:
        """volts: the references are the coils' mean voltages, as with StealthChop, and nothing regulates."""
        options, motor = self.options, self.options.motor
        dt = 256 / options.clock_hz / options.steps_a_tick
        j, kt = options.inertia_kgm2, motor.torque_constant
        kept = math.exp(-motor.resistance_ohm * dt / motor.inductance_h)
        gain = (1 - kept) / motor.resistance_ohm
        for _ in range(options.steps_a_tick):
            e = motor.rotor_teeth * self.theta
            third, apart = math.radians(motor.fourth_harmonic_deg), math.radians(motor.quadrature_error_deg)
            flux = (
                kt * (1 + motor.phase_unbalance / 2) * (math.cos(e) + third * math.cos(3 * e)),
                -kt * (1 - motor.phase_unbalance / 2) * (math.sin(e + apart) - third * math.sin(3 * e)),
            )
            emf = (self.omega * flux[0], self.omega * flux[1])
            for phase in range(2):
                i, wanted = self.currents[phase], references[phase]
                new = i - math.expm1(-dt / options.regulator_s) * (wanted - i)
                if abs(wanted - new) < 1e-9:
                    new = wanted
                if volts:
                    new = kept * i + gain * (wanted - emf[phase])
                low = kept * i + gain * (-options.supply_v - emf[phase])
                high = kept * i + gain * (options.supply_v - emf[phase])
                self.currents[phase] = min(max(new, low), high)
            torque = self.currents[0] * flux[0] + self.currents[1] * flux[1]
            torque -= motor.detent_torque_nm * math.sin(4 * e) + self.load_nm
            speed = (self.omega + torque * dt / j) / (1 + motor.viscous_nms * dt / j)
            friction = motor.friction_nm * (motor.stiction_ratio if self.omega == 0 else 1)
            slowed = friction * dt / j / (1 + motor.viscous_nms * dt / j)
            self.omega = math.copysign(max(abs(speed) - slowed, 0.0), speed)
            self.theta += self.omega * dt
