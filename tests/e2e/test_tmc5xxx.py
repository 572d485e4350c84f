"""Bench, registers, microsteps and connections of a TMC5xxx in a browser: two axes, a UART, what cannot be read."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Locator, Page, expect

from app.calc.microsteps.mslut_waves import Formula, wanted_wave
from tests.e2e.chips import Chip, a_chip, select, set_up
from tests.e2e.motor import wait_for
from tests.e2e.test_pages import LOOKS

PATIENCE_MS = 30_000


@pytest.fixture(scope="module")
def second(api: httpx.Client) -> Iterator[Chip]:
    """The second axis of an emulated TMC5072 whose both motors can turn."""
    with a_chip(api, "two motors", "tmc5072", axis=1) as chip:
        set_up(chip)
        set_up(Chip(api, chip.device, 0))
        yield chip


@pytest.fixture
def show(second: Chip, page: Page) -> Callable[[str], Page]:
    """Open a page that shows the second axis."""
    select(page, second)

    def go(path: str) -> Page:
        page.goto(path)
        return page

    return go


def row(page: Page, axis: int | None, name: str) -> Locator:
    return page.locator(f"tr[data-row='{'-' if axis is None else axis}/{name}']")


# --- bench ------------------------------------------------------------------------------------------


def test_each_motor_has_its_own_load_and_block(show: Callable[[str], Page], second: Chip) -> None:
    bench = show("/")
    bench.get_by_test_id("emulator-open").click()
    panel = bench.get_by_test_id("emulator")
    expect(panel.get_by_role("radio", name="Motor of axis 1")).to_be_checked()
    panel.get_by_test_id("blocked").click()
    wait_for(lambda: [axis["blocked"] for axis in second.emulator()["axes"]] == [False, True], "the second is blocked")
    panel.get_by_text("Motor of axis 0").click()
    expect(panel.get_by_test_id("blocked")).not_to_be_checked()
    expect(bench.get_by_test_id("axis-two-motors-0")).to_have_attribute("aria-pressed", "true")
    panel.get_by_label("Friction").fill("0.02")
    panel.get_by_label("Friction").press("Enter")
    wait_for(lambda: [axis["friction"] for axis in second.emulator()["axes"]] == [0.02, 0.0], "the first rubs")
    second.emulator(axes=[{"axis": 0, "friction": 0.0}, {"axis": 1, "blocked": False}])


def test_an_end_of_a_move_and_a_fault_get_their_rows(show: Callable[[str], Page], second: Chip) -> None:
    bench = show("/")
    expect(bench.get_by_test_id("events")).to_be_visible(timeout=PATIENCE_MS)
    second.call("move", target=2000, relative=True, unit="microsteps")
    expect(bench.locator("[data-event=event_pos_reached]")).to_be_visible(timeout=PATIENCE_MS)
    expect(bench.get_by_test_id("stage")).to_be_visible()
    lamps = bench.get_by_test_id("motion-card").get_by_role("img", name=re.compile("switch"))
    expect(lamps).to_have_count(2)  # there is no home switch


def test_a_jog_starts_from_what_vmax_was_written(show: Callable[[str], Page], second: Chip) -> None:
    bench = show("/")
    wanted = 100_000 * 16e6 / 2**24 / 4
    expect(bench.get_by_test_id("motion-card").get_by_label("Speed")).to_have_value(
        re.compile(rf"^{wanted:.0f}"), timeout=PATIENCE_MS
    )


def test_zero_is_set_for_one_motor_alone(show: Callable[[str], Page], second: Chip, api: httpx.Client) -> None:
    first = Chip(api, second.device, 0)
    for chip in (first, second):
        chip.call("move", target=3000, unit="microsteps")
        wait_for(lambda chip=chip: chip.axis()["position"] == 3000, "it is there")  # type: ignore[misc]
    bench = show("/")
    bench.get_by_role("tab", name="Zero").click()
    expect(bench.get_by_role("radio", name="Reference")).to_have_count(0)
    bench.get_by_test_id("set-zero").click()
    wait_for(lambda: second.axis()["position"] == 0, "the count is zero")
    assert first.axis()["position"] == 3000
    assert not second.axis()["moving"]


# --- registers --------------------------------------------------------------------------------------


def test_what_cannot_be_read_shows_what_was_written(show: Callable[[str], Page], second: Chip) -> None:
    page = show("/registers")
    vmax = row(page, 1, "VMAX")
    expect(vmax).to_contain_text("0x0186a0")
    expect(vmax.locator("[title^='As last written']")).to_be_visible()
    expect(vmax).to_contain_text(re.compile(r"95[.\s\u202f]?\d* ?\u202f?k?pps"))
    vmax.get_by_role("button", name=re.compile("^Edit VMAX")).click()
    entry = page.get_by_label("New value of VMAX")
    entry.fill("50000")
    entry.press("Enter")
    page.get_by_role("button", name="Apply").click()
    wait_for(lambda: second.register("VMAX")["value"] == 50_000, "it was written")
    expect(vmax).to_contain_text("0x00c350")
    second.write("VMAX", 100_000)


def test_both_axes_are_listed_and_each_is_written(show: Callable[[str], Page], second: Chip, api: httpx.Client) -> None:
    page = show("/registers")
    expect(row(page, 0, "AMAX")).to_have_count(0)
    page.get_by_role("switch", name="All axes").click()
    expect(row(page, 0, "AMAX")).to_be_visible()
    expect(row(page, 1, "AMAX")).to_be_visible()
    Chip(api, second.device, 0).write("AMAX", 4321)
    expect(row(page, 0, "AMAX")).to_contain_text("0x10e1")
    expect(row(page, 1, "AMAX")).to_contain_text("0x2710")


def test_flags_that_a_look_clears_are_read_when_somebody_asks(show: Callable[[str], Page], second: Chip) -> None:
    page = show("/registers")
    flags = row(page, 1, "RAMP_STAT")
    expect(flags).to_contain_text("not polled")
    flags.click()
    second.call("move", target=500, relative=True, unit="microsteps")
    wait_for(lambda: not second.axis()["moving"], "the move is over")
    page.get_by_role("button", name="Read it once, and clear it").click()
    said = page.get_by_role("status").filter(has_text="it was")
    # the driver has looked before, for the timeline: what it took away is still told
    expect(said).to_contain_text("event_pos_reached")
    page.get_by_role("button", name="Read it once, and clear it").click()
    expect(said).not_to_contain_text("event_pos_reached")


# --- microsteps -------------------------------------------------------------------------------------


def test_a_wave_goes_to_the_chip_and_the_motor_shows_it(show: Callable[[str], Page], second: Chip) -> None:
    page = show("/microsteps")
    expect(page.get_by_text("the power-on wave is taken to be there")).to_be_visible(timeout=PATIENCE_MS)
    # a menu goes with its button, which what is calculated yet would push away
    expect(page.get_by_role("region", name="Before and after").get_by_role("table")).to_be_visible(timeout=PATIENCE_MS)
    page.get_by_role("button", name="Presets").click()
    page.get_by_role("menuitem", name="Linearity correction 100 (firmware)").click()
    send = page.get_by_role("button", name="Send to chip")
    expect(send).to_be_enabled()
    send.click()
    expect(page.get_by_text("Ten registers written")).to_be_visible()
    held = second.api.get(f"/devices/{second.device}/microstep-table").raise_for_status().json()
    assert held["values"] == list(wanted_wave(Formula(exponent=1.1, grid="whole_step")).wave.values)
    page.get_by_role("button", name="Shuttle").click()
    shown = page.get_by_text(re.compile(r"The motor has shown (\d{2,}) of 1024 positions, all as the table has them"))
    expect(shown).to_be_visible(timeout=PATIENCE_MS)
    page.get_by_role("button", name="Stop", exact=True).click()
    wait_for(lambda: not second.axis()["moving"], "it stands")


# --- connections ------------------------------------------------------------------------------------


@pytest.fixture
def uart(tmp_path: Path) -> Iterator[Path]:
    """Two emulated TMC5160 on one single wire in another process, nodes 1 and 2; the wire hands back what is sent."""
    path = tmp_path / "uart"
    program = str(Path(sys.executable).with_name("stepscope"))
    command = [program, "emulate", "tmc5160", "--pty", str(path), "--node", "1", "--node", "2", "--echo"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE)
    assert process.stdout is not None
    assert str(path).encode() in process.stdout.readline(), "it says where it listens when it does"
    yield path
    process.send_signal(signal.SIGINT)
    process.wait(30)
    process.stdout.close()


def test_a_chip_on_a_single_wire_is_added_by_its_node(page: Page, api: httpx.Client, uart: Path) -> None:
    page.goto("/connections")
    page.get_by_role("button", name="Add a device").click()
    page.get_by_label("Name", exact=True).fill("wired")
    page.get_by_role("combobox", name="Model").click()
    page.get_by_role("option", name="TMC5160").click()
    form = page.get_by_role("form", name="Add a device")
    form.get_by_text("UART", exact=True).click()
    form.get_by_label("Port of the UART").fill(str(uart))
    form.get_by_label("Node address").fill("300")
    expect(form.get_by_text("0 to 254")).to_be_visible()
    form.get_by_label("Node address").fill("2")
    form.get_by_role("button", name="Test the link").click()
    expect(form).to_contain_text("It answers", timeout=PATIENCE_MS)
    form.get_by_role("button", name="Add and connect").click()
    entry = page.get_by_role("region", name="wired")
    try:
        expect(entry).to_have_attribute("data-state", "connected", timeout=PATIENCE_MS)
        expect(entry).to_contain_text("node 2")
        link = api.get("/devices/wired").raise_for_status().json()["link"]
        assert link == {"kind": "uart", "port": str(uart), "node": 2}
        # an edit keeps what was said, and says what is new
        entry.get_by_role("button", name="Edit").click()
        form = page.get_by_role("form", name="Edit wired")
        expect(form.get_by_label("Node address")).to_have_value("2")
        form.get_by_label("Answer within").fill("0.5")
        form.get_by_role("button", name="Save").click()
        expect(form).to_have_count(0)
        link = api.get("/devices/wired").raise_for_status().json()["link"]
        assert link == {"kind": "uart", "port": str(uart), "node": 2, "timeout_s": 0.5}
    finally:
        api.delete("/devices/wired")


def test_an_edit_keeps_the_motor_that_the_form_does_not_show(page: Page, api: httpx.Client) -> None:
    motor = {"holding_torque_nm": 0.9}
    with a_chip(api, "strong", "tmc5130") as chip:
        api.patch(
            f"/devices/{chip.device}", json={"link": {"kind": "emulator", "motor": motor, "seed": 9}}
        ).raise_for_status()
        page.goto("/connections")
        page.get_by_role("region", name="strong").get_by_role("button", name="Edit").click()
        form = page.get_by_role("form", name="Edit strong")
        form.get_by_role("button", name="Emulator: motor, load, stage").click()
        expect(form.get_by_label("Holding torque")).to_have_value("0.9")
        form.get_by_label("Time runs at").fill("2")
        form.get_by_role("button", name="Save").click()
        expect(form).to_have_count(0)
        link = api.get(f"/devices/{chip.device}").raise_for_status().json()["link"]
        assert link["motor"] == motor
        assert link["time_scale"] == 2


# --- everybody --------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", ["/", "/registers", "/microsteps"])
def test_accessible_in_every_size_and_scheme(
    show: Callable[[str], Page], check_axe: Callable[[Page], None], path: str
) -> None:
    page = show(path)
    if path == "/":
        page.get_by_test_id("emulator-open").click()
        expect(page.get_by_test_id("rotor-dial")).to_be_visible(timeout=PATIENCE_MS)
    for size, scheme in LOOKS:
        page.set_viewport_size(size)
        page.emulate_media(color_scheme=scheme)
        expect(page.get_by_test_id("stop-all")).to_be_in_viewport(ratio=1)
        check_axe(page)
        sideways = page.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
        assert sideways <= 0
