"""A load behind a belt or a screw: two masses with a spring, its damping, and play."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from app.emulators.drive import Drive, DriveOptions, EventKind, MotorOptions
from app.emulators.drive import kernel as k

from .rig import ONE_TURN_A_SECOND, TICK_S, energised, until, wait, write

ROTOR, LOAD = 58e-7, 2e-5
SMOOTH = {"detent_torque_nm": 0.0, "friction_nm": 0.0, "viscous_nms": 0.0}
PEAK_A = 4.2 * 12 / 32


def coupled(
    stiffness: float, motor: dict[str, float] | None = None, load: dict[str, Any] | None = None, **coupling: float
) -> dict[str, Any]:
    """Options of a drive with its load behind a coupling."""
    return {
        "motor": MotorOptions(**(SMOOTH if motor is None else motor)),
        "load": {"inertia_kgm2": LOAD, "coupling": {"stiffness_nm_rad": stiffness, **coupling}, **(load or {})},
    }


def energy(drive: Drive) -> float:
    """Of both masses and the spring between them, where no current flows [J]."""
    f, options = drive._f, drive.options
    assert options.load.coupling is not None
    apart = abs(float(f[k.THETA] - f[k.LOAD_THETA])) - float(f[k.SPRING_PLAY])
    return (
        options.motor.rotor_inertia_kgm2 * float(f[k.OMEGA]) ** 2
        + options.load.inertia_kgm2 * float(f[k.LOAD_OMEGA]) ** 2
        + options.load.coupling.stiffness_nm_rad * max(apart, 0.0) ** 2
    ) / 2


@pytest.mark.parametrize("stiffness", [3.0, 16.0, 60.0])
def test_both_resonances_are_those_of_two_masses(stiffness: float) -> None:
    """The field's spring on the rotor, the coupling between rotor and load."""
    drive = energised(**coupled(stiffness))
    # the back-EMF damps the rotor as long as the supply can drive it: little against half a second
    field = 50 * drive.options.motor.torque_constant * PEAK_A
    stiff = np.array([[(field + stiffness) / ROTOR, -stiffness / ROTOR], [-stiffness / LOAD, stiffness / LOAD]])
    wanted = np.sqrt(np.sort(np.linalg.eigvals(stiff).real)) / (2 * math.pi)
    drive._f[k.THETA] += 0.002
    drive._f[k.LOAD_THETA] -= 0.002
    k.refresh(drive._s, drive._f)
    places = []
    for _ in range(round(0.5 / TICK_S)):
        drive.advance(drive.clocks + 256)
        places.append(float(drive._f[k.THETA]))
    swing = np.array(places) - np.mean(places)
    spectrum = np.abs(np.fft.rfft(swing * np.hanning(len(swing)), 8 * len(swing)))
    hz = np.fft.rfftfreq(8 * len(swing), TICK_S)
    for one in wanted:
        near = (hz > 0.85 * one) & (hz < 1.15 * one)
        assert hz[near][np.argmax(spectrum[near])] == pytest.approx(one, rel=0.01)
        assert spectrum[near].max() > 20 * np.median(spectrum[hz < 2000])


def test_a_free_spring_keeps_its_energy_and_its_damping_takes_it() -> None:
    kept = []
    for damping in (0.0, 1e-3):
        drive = Drive(DriveOptions(**coupled(16.0, damping_nms=damping)))  # without TOFF no current flows
        drive._f[k.LOAD_THETA] += 0.02
        k.refresh(drive._s, drive._f)
        energies = [energy(drive)]
        for _ in range(20_000):
            drive.advance(drive.clocks + 256)
            energies.append(energy(drive))
        kept.append(min(energies[-1000:]) / energies[0])
        assert max(energies) < 1.05 * energies[0]
    assert kept[0] > 0.95
    assert kept[1] < 0.01


def test_with_play_the_energy_does_not_grow_and_the_masses_stay_within_it() -> None:
    play = 0.5
    drive = Drive(DriveOptions(**coupled(60.0, backlash_fullsteps=play, damping_nms=1e-4)))
    drive._f[k.LOAD_OMEGA] = 20.0
    k.refresh(drive._s, drive._f)
    before = energy(drive)
    furthest = 0.0
    for _ in range(40_000):
        drive.advance(drive.clocks + 256)
        now = drive.plant_state
        furthest = max(furthest, abs(now.rotor_fullsteps - now.load_fullsteps))
        assert energy(drive) < 1.03 * before
    assert play / 2 < furthest < play / 2 + 1.0
    together = (LOAD * 20.0) ** 2 / (ROTOR + LOAD) / 2
    assert energy(drive) == pytest.approx(together, rel=0.01), "what is left is both turning as one"
    both = ROTOR * float(drive._f[k.OMEGA]) + LOAD * float(drive._f[k.LOAD_OMEGA])
    assert both == pytest.approx(LOAD * 20.0, rel=1e-6), "momentum is neither made nor lost"


def test_a_load_is_behind_by_half_the_play_on_either_way_and_swings_no_further_than_it() -> None:
    play = 2.0
    drive = energised(**coupled(16.0, motor={}, load={"friction_nm": 0.02}, backlash_fullsteps=play, damping_nms=1e-3))
    behind = []
    for target in (51_200, 0):
        drive.write("XTARGET", target)
        until(drive, EventKind.POSITION_REACHED)
        wait(drive, 0.5)
        now = drive.plant_state
        behind.append(now.rotor_fullsteps - now.load_fullsteps)
        assert drive.plant_state.lost_fullsteps == 0
        resting = [drive.plant_state.load_fullsteps]
        for _ in range(2000):
            drive.advance(drive.clocks + 256)
            resting.append(drive.plant_state.load_fullsteps)
        assert max(resting) - min(resting) < 0.01
    # it slides on within the play as the motor stops
    assert all(abs(one) < play / 2 + 0.3 for one in behind)
    write(drive, {"RAMPMODE": 1, "VMAX": ONE_TURN_A_SECOND // 4})
    wait(drive, 1.5)
    way_up = drive.plant_state.rotor_fullsteps - drive.plant_state.load_fullsteps
    write(drive, {"RAMPMODE": 2})
    wait(drive, 3.0)
    way_down = drive.plant_state.rotor_fullsteps - drive.plant_state.load_fullsteps
    give = math.degrees(0.02 / 16.0) / 1.8
    assert way_up == pytest.approx(play / 2 + give, abs=0.05)
    assert way_down == pytest.approx(-play / 2 - give, abs=0.05)


def test_weight_and_friction_pull_at_the_load_and_stretch_the_coupling() -> None:
    drive = energised(**coupled(3.0, motor={}, load={"torque_nm": 0.1, "friction_nm": 0.01}, damping_nms=2e-3))
    wait(drive, 1.0)
    now = drive.plant_state
    stretched = math.radians((now.rotor_fullsteps - now.load_fullsteps) * 1.8) * 3.0
    assert 0.09 - 1e-3 <= stretched <= 0.112 + 1e-3
    assert drive.quiet, "a load that sticks comes to rest"


def test_switches_and_ends_are_the_loads() -> None:
    options = coupled(3.0, motor={}, load={"torque_nm": 0.2, "friction_nm": 0.01}, damping_nms=2e-3)
    drive = energised(**options, stage={"left_at_fullsteps": -2.0, "right_at_fullsteps": 500.0})
    wait(drive, 0.5)
    assert drive.switches.left, "the weight has pulled the load there"
    assert drive.plant_state.rotor_fullsteps > -1.0
    drive.plant.rotor_fullsteps = 100.0
    assert drive.plant_state.load_fullsteps == pytest.approx(100.0), "turned by hand, both turn"
    ends = {"left_at_fullsteps": -900.0, "right_at_fullsteps": 900.0, "right_end_fullsteps": 60.0}
    drive = energised(**coupled(60.0, motor={}, damping_nms=1e-3), stage=ends)
    write(drive, {"RAMPMODE": 1, "VMAX": ONE_TURN_A_SECOND})
    wait(drive, 1.0)
    assert drive.plant_state.load_fullsteps <= 60.5
    assert drive.plant_state.lost_fullsteps > 0


def test_a_very_stiff_coupling_is_as_none() -> None:
    places = []
    for coupling in (None, {"stiffness_nm_rad": 2000.0, "damping_nms": 5e-3}):
        drive = energised(load={"inertia_kgm2": LOAD, "coupling": coupling})
        drive.write("XTARGET", 51_200)
        wait(drive, 0.4)
        places.append(drive.plant_state.rotor_fullsteps)
    assert places[0] == pytest.approx(places[1], abs=0.02)
    assert abs(places[0]) > 10


def test_what_cannot_swing_or_be_computed_is_refused() -> None:
    with pytest.raises(ValueError, match="inertia_kgm2"):
        DriveOptions(load={"coupling": {"stiffness_nm_rad": 10.0}})
    with pytest.raises(ValueError, match="physics steps"):
        DriveOptions(load={"inertia_kgm2": 1e-6, "coupling": {"stiffness_nm_rad": 1e5}})
