"""Motors of one's own in a browser: kept on Tune and in the first run, taken, edited, deleted and put back."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest
from playwright.sync_api import Locator, Page, expect

from tests.e2e.chips import Chip, a_chip, select
from tests.e2e.conftest import PHONE

STUDY_MS = 200_000
SPINDLE = "Spindle NEMA 17"
FIGURES = {
    "Rated current A": "1.68",
    "Full steps a turn": "400",
    "Resistance of a coil Ω": "1.65",
    "Inductance of a coil mH": "4.35",
    "Holding torque N m": "0.44",
    "Inertia of the rotor g cm²": "68",
}

NO_DISK = {"type": "/problems/store-unavailable", "title": "Not kept", "detail": "no space left on the disk"}


@pytest.fixture(scope="module")
def axis(api: httpx.Client) -> Iterator[Chip]:
    with a_chip(api, "with a motor of its own") as chip:
        yield chip


@pytest.fixture(autouse=True)
def no_motors(api: httpx.Client) -> Iterator[None]:
    yield
    for motor in own_motors(api):
        api.delete(f"/motors/{motor['name']}").raise_for_status()


def own_motors(api: httpx.Client) -> list[dict[str, Any]]:
    answer: dict[str, Any] = api.get("/motors", params={"own": True}).raise_for_status().json()
    return list(answer["motors"])


def fill(where: Page | Locator, fields: dict[str, str]) -> None:
    for label, value in fields.items():
        where.get_by_label(label, exact=True).fill(value)


def test_a_motor_is_kept_on_tune_taken_edited_and_deleted(
    page: Page, axis: Chip, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    select(page, axis)
    page.goto("/tune")
    page.get_by_role("radio", name="Calm by its chopper").check()
    page.get_by_role("button", name="My motors…").click()
    drawer = page.get_by_role("dialog", name="My motors")
    expect(drawer).to_contain_text("None of your own yet")
    expect(drawer.get_by_role("button", name="Add a motor")).to_be_focused()
    check_axe(page)

    page.keyboard.press("Enter")
    expect(drawer.get_by_label("Name", exact=True)).to_be_focused()
    page.keyboard.press("Enter")
    expect(drawer).to_contain_text("A name is needed")
    expect(drawer).to_contain_text("The rated current is needed")
    page.keyboard.insert_text(SPINDLE)
    fill(drawer, FIGURES)
    check_axe(page)
    page.keyboard.press("Enter")
    row = drawer.get_by_role("listitem").filter(has_text=SPINDLE)
    expect(row).to_contain_text("68")
    assert own_motors(api) == [
        {
            "name": SPINDLE,
            "own": True,
            "source": "kept on this server",
            "rated_current_a": 1.68,
            "full_steps_per_rev": 400,
            "resistance_ohm": 1.65,
            "inductance_h": 0.00435,
            "holding_torque_nm": 0.44,
            "rotor_inertia_kgm2": 6.8e-6,
        }
    ]
    check_axe(page)

    drawer.get_by_role("button", name=f"Use {SPINDLE}").click()
    expect(drawer).to_have_count(0)
    expect(page.get_by_role("combobox", name="Motor")).to_have_value(SPINDLE)
    expect(page.get_by_test_id("motor")).to_contain_text("kept on this server")
    expect(page.get_by_label("Resistance of one coil Ω")).to_have_value("1.65")
    expect(page.get_by_label("Inductance of one coil mH")).to_have_value("4.35")
    expect(page.get_by_label("Run current as it is set now, RMS of one coil A")).to_have_value("1.68")
    page.get_by_role("radio", name="Faster").check()
    page.get_by_role("combobox", name="Motor").fill(SPINDLE)
    expect(page.get_by_label("Holding torque of the motor N m")).to_have_value("0.44")
    expect(page.get_by_label("Rated current of the motor A")).to_have_value("1.68")

    page.get_by_role("button", name="My motors…").click()
    drawer.get_by_role("button", name=f"Edit {SPINDLE}").click()
    form = drawer.get_by_role("form", name=SPINDLE)
    expect(form.get_by_label("Inertia of the rotor g cm²")).to_have_value("68")
    fill(form, {"Name": "Spindle", "Rated current A": "much"})
    expect(form.get_by_role("button", name="Keep it")).to_be_enabled()
    form.get_by_label("Holding torque N m").fill("")
    expect(form.get_by_role("button", name="Keep it")).to_be_disabled()
    expect(form).to_contain_text("Not a number")
    fill(form, {"Rated current A": "1.5"})
    page.keyboard.press("Enter")
    expect(drawer.get_by_role("listitem")).to_have_count(1)
    (edited,) = own_motors(api)
    assert (edited["name"], edited["rated_current_a"], edited["holding_torque_nm"]) == ("Spindle", 1.5, None)
    assert (edited["inductance_h"], edited["rotor_inertia_kgm2"]) == (0.00435, 6.8e-6)
    drawer.get_by_role("button", name="Use Spindle").click()
    expect(page.get_by_test_id("motor")).to_contain_text("Spindle does not tell the figure")

    page.set_viewport_size(PHONE)
    page.get_by_role("button", name="My motors…").click()
    expect(drawer.get_by_role("listitem")).to_have_count(1)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert drawer.evaluate("node => node.scrollWidth <= node.clientWidth")
    drawer.get_by_role("button", name="Delete Spindle").click()
    expect(drawer.get_by_role("button", name="Undo")).to_be_focused()
    assert own_motors(api) == []
    check_axe(page)
    page.keyboard.press("Enter")
    expect(drawer.get_by_role("listitem")).to_have_count(1)
    assert own_motors(api) == [edited]
    drawer.get_by_role("button", name="Delete Spindle").click()
    expect(drawer).to_contain_text("Spindle is deleted.")
    page.keyboard.press("Escape")
    expect(drawer).to_have_count(0)
    assert own_motors(api) == []
    page.goto("/connections")  # before the chip is gone


def test_motors_that_cannot_be_read_or_kept_say_so(page: Page, axis: Chip, api: httpx.Client, errors: Any) -> None:
    errors.expect("Failed to load resource")
    select(page, axis)
    page.goto("/tune")
    page.get_by_role("radio", name="Calm by its chopper").check()
    page.route("**/api/v1/motors?own=true*", lambda route: route.fulfill(status=500, json=NO_DISK))
    page.get_by_role("button", name="My motors…").click()
    drawer = page.get_by_role("dialog", name="My motors")
    expect(drawer.get_by_role("alert")).to_contain_text("Reading your motors")
    page.unroute("**/api/v1/motors?own=true*")
    drawer.get_by_role("button", name="Try again").click()
    drawer.get_by_role("button", name="Add a motor").click()
    fill(drawer, {"Name": SPINDLE, "Rated current A": "1.68"})
    page.route("**/api/v1/motors/*", lambda route: route.fulfill(status=503, json=NO_DISK))
    drawer.get_by_role("button", name="Keep it").click()
    expect(drawer.get_by_role("alert")).to_contain_text("Keeping the motor")
    page.unroute("**/api/v1/motors/*")
    drawer.get_by_role("button", name="Keep it").click()
    expect(drawer.get_by_role("listitem")).to_contain_text(SPINDLE)
    (kept,) = own_motors(api)
    assert (kept["rated_current_a"], kept["full_steps_per_rev"], kept["resistance_ohm"]) == (1.68, 200, None)

    drawer.get_by_role("button", name="Add a motor").click()
    fill(drawer, {"Name": SPINDLE, "Rated current A": "1"})
    drawer.get_by_role("button", name="Keep it").click()
    expect(drawer).to_contain_text("One of your motors has this name")
    drawer.get_by_role("button", name="Cancel").click()
    assert own_motors(api) == [kept]
    page.goto("/connections")  # before the chip is gone


def test_the_first_run_keeps_all_that_is_given_of_a_motor(
    page: Page, axis: Chip, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    select(page, axis)
    page.goto("/first-run")
    page.get_by_role("list", name="Steps").get_by_role("button", name="Motor").click()
    step = page.get_by_test_id("first-run-step")
    keep = step.get_by_role("button", name="Keep it as my own motor")
    # Figures of one motor are not kept unseen with the name of another.
    name = page.get_by_role("combobox", name="Motor", exact=True)
    name.fill("ldo-42sth48-1684ac")
    expect(step.get_by_label("Rated current A")).to_have_value("1.68")
    expect(keep).to_have_count(0)
    step.get_by_text("More of its data sheet").click()
    expect(step.get_by_label("Resistance of a coil Ω")).to_have_value("1.65")
    name.fill(SPINDLE)
    expect(step.get_by_label("Resistance of a coil Ω")).to_have_value("")
    name.fill("ldo-42sth48-1684ac")
    expect(step.get_by_label("Resistance of a coil Ω")).to_have_value("1.65")
    name.fill(SPINDLE)
    expect(step.get_by_label("Resistance of a coil Ω")).to_have_value("")
    fill(step, {"Rated current A": "1.2", "Inductance of a coil mH": "2.9", "Inertia of the rotor g cm²": "54"})
    check_axe(page)
    keep.click()
    expect(keep).to_have_count(0)
    (kept,) = own_motors(api)
    assert (kept["name"], kept["rated_current_a"], kept["full_steps_per_rev"]) == (SPINDLE, 1.2, 200)
    assert (kept["inductance_h"], kept["rotor_inertia_kgm2"]) == (0.0029, 5.4e-6)
    assert (kept["resistance_ohm"], kept["holding_torque_nm"]) == (None, None)

    fill(step, {"Rated current A": "1.3"})
    page.keyboard.press("Tab")
    step.get_by_role("button", name="Keep what I changed of my motor").click()
    expect(step.get_by_role("button", name="Keep what I changed")).to_have_count(0)
    assert own_motors(api) == [kept | {"rated_current_a": 1.3}]
    name.fill("")
    page.keyboard.press("Tab")  # its options lie over what is below
    step.get_by_role("button", name="My motors…").click()
    page.get_by_role("button", name=f"Use {SPINDLE}").click()
    expect(name).to_have_value(SPINDLE)
    expect(step.get_by_label("Inertia of the rotor g cm²")).to_have_value("54")
    page.set_viewport_size(PHONE)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.goto("/connections")  # before the chip is gone


@pytest.mark.timeout(300)  # a study of 20 s, and its fit
def test_the_coil_that_a_study_has_measured_is_kept(
    page: Page, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    motor = {"rotor_teeth": 50, "holding_torque_nm": 0.45, "rated_current_a": 1.5, "rotor_inertia_kgm2": 2e-5}
    motor |= {"friction_nm": 0.02, "viscous_nms": 0.0025}
    with a_chip(api, "measured motor", motor=motor, full_scale_a=2.12) as chip:
        start = {"velocity_pps": 51_200, "acceleration_pps2": 256_000, "counts_per_rev": 40_000, "stops": False}
        api.post(f"/devices/{chip.device}/start-up", json=start).raise_for_status()
        chip.write("IHOLD_IRUN", IHOLD=16, IRUN=31, IHOLDDELAY=1)
        chip.emulator(time_scale=4.0)
        study = {"kind": "identification", "velocity_rps": 0.5, "hops": 8, "supply_v": 24.0, "run_current_a": 1.5}
        begun = api.post("/studies", json={"device": chip.device, "study": study}).raise_for_status().json()["id"]
        select(page, chip)
        page.goto("/tune")
        keep = page.get_by_role("button", name="Keep as my own motor")
        expect(keep).to_be_visible(timeout=STUDY_MS)
        found = api.get(f"/studies/{begun}").raise_for_status().json()["identified"]
        keep.click()
        drawer = page.get_by_role("dialog", name="My motors")
        fill(drawer, {"Name": SPINDLE, "Rated current A": "1.5"})
        check_axe(page)
        drawer.get_by_role("button", name="Keep it").click()
        expect(drawer.get_by_role("listitem")).to_contain_text(SPINDLE)
        (kept,) = own_motors(api)
        assert kept["resistance_ohm"] == float(f"{found['resistance_ohm']['value']:.4g}")
        assert kept["inductance_h"] == float(f"{found['inductance_h']['value']:.4g}")
        assert (kept["holding_torque_nm"], kept["rotor_inertia_kgm2"]) == (None, None)

        # one that is kept already, as its data sheet has it, takes up what was measured
        sheet = {"rated_current_a": 1.5, "resistance_ohm": 1.65, "holding_torque_nm": 0.44}
        api.put(f"/motors/{SPINDLE}", json=sheet).raise_for_status()
        page.reload()
        page.get_by_role("button", name="Change one of my motors").click()
        drawer.get_by_role("button", name=f"Change {SPINDLE}").click()
        changes = drawer.get_by_role("form", name=f"Change {SPINDLE}")
        resistance = changes.get_by_role("checkbox", name="Resistance of a coil")
        inductance = changes.get_by_role("checkbox", name="Inductance of a coil")
        torque = changes.get_by_role("checkbox", name="Holding torque")
        expect(resistance).to_be_focused()
        for sure in (resistance, inductance):
            expect(sure).to_be_checked()
        expect(torque).not_to_be_checked()
        measured = found["resistance_ohm"]["value"]
        expect(changes).to_contain_text(re.compile(rf"1\.650.Ω, becomes {measured:.3f}.Ω"))
        expect(changes).to_contain_text("not known, becomes")
        check_axe(page)
        drawer.get_by_role("button", name="Cancel").click()
        assert own_motors(api) == [kept | sheet | {"inductance_h": None}]
        drawer.get_by_role("button", name=f"Change {SPINDLE}").click()
        inductance.uncheck()
        torque.check()
        drawer.get_by_role("button", name="Change it").click()
        expect(drawer.get_by_role("status")).to_have_text(f"{SPINDLE} is changed.")
        (changed,) = own_motors(api)
        assert (changed["resistance_ohm"], changed["inductance_h"]) == (kept["resistance_ohm"], None)
        assert changed["holding_torque_nm"] == float(f"{found['torque_nm']['value']:.4g}")
        page.set_viewport_size(PHONE)
        drawer.get_by_role("button", name=f"Change {SPINDLE}").click()
        expect(changes.get_by_role("checkbox")).to_have_count(1)
        assert drawer.evaluate("node => node.scrollWidth <= node.clientWidth")
        page.goto("/connections")  # before the chip is gone
        # other tests look at the list of recordings
        recording = api.get(f"/studies/{begun}").raise_for_status().json()["recording"]
        api.delete(f"/recordings/{recording}").raise_for_status()
