"""The guided first run of each family, by a script in a real browser against emulators, and faults it has to name.

A run begins with a chip as it comes out of its box, and ends with a moved motor and a kept profile. Clicks are counted
as a hand would make them; nobody reads meanwhile, so that the seconds are those of program and motor alone.
"""

from __future__ import annotations

import re
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from chromium import chromium_flags, find_chromium
from playwright.sync_api import Browser, Locator, Page, expect, sync_playwright
from server_process import ServerProcess

from tests.bench.table import Row
from tests.e2e.chips import Chip, a_chip, select
from tests.e2e.motor import wait_for
from tests.e2e.session import a_client, begin_with_the_bench, take_the_bench

WITHIN_S = 180.0
PATIENCE_MS = 20_000
A_PRESS_MS = 30_000
"""The page itself waits 20 s for a switch."""
MODELS = (
    *("tmc428", "tmc429", "tmc4210", "tmc4361", "tmc5160", "tmc5072", "tmc5240"),
    *("pd42-1241", "tmcm-1161", "tmc2209", "tmc2130", "tmc2240", "tmc2660"),
)
QUICK = ("tmc4210", "tmc5160", "pd42-1241", "tmc2130")
MOTOR = "ldo-42sth48-1684ac"
LINES = 10_000
"""Of the encoder that an emulated chip has at its shaft."""
OF_A_STAGE = {"tmc428", "tmc429", "tmc4210"}
OF_AN_AXIS = {"tmc5031", "tmc5062", "tmc5072", "tmc5130", "tmc5160", "tmc5240"}


class Guided:
    """A page First run, worked through as its words say."""

    def __init__(self, page: Page, chip: Chip, model: str) -> None:
        self.page, self.chip, self.model = page, chip, model
        self.step: Locator = page.get_by_test_id("first-run-step")
        self.clicks = 0
        catalog = chip.api.get(f"/catalog/{model}").raise_for_status().json()
        self.can: set[str] = set(catalog["capabilities"])

    @property
    def stepped(self) -> bool:
        return "step_input" in self.can

    def click(self, name: str | re.Pattern[str]) -> None:
        """A button of the step."""
        self.step.get_by_role("button", name=name, exact=isinstance(name, str)).first.click(timeout=PATIENCE_MS)
        self.clicks += 1

    def fill(self, label: str, value: str) -> None:
        field = self.page.get_by_label(label)
        if field.count():
            field.fill(value)
            field.press("Tab")

    def at(self, title: str) -> None:
        expect(self.step.get_by_role("heading", level=2)).to_contain_text(title, timeout=PATIENCE_MS)

    def open(self) -> None:
        """The bench is not taken: the first change asks for it."""
        self.page.goto("/first-run")
        self.at("Wire")
        self.click("Try the wire")
        expect(self.page.get_by_test_id("link-trial")).to_contain_text("none lost", timeout=PATIENCE_MS)
        self.click("Go on")
        self.at("Motor")

    def motor(self) -> None:
        self.page.get_by_role("combobox", name="Motor", exact=True).fill("42sth48 1684")
        self.page.get_by_role("option", name=MOTOR, exact=True).click()
        self.clicks += 1
        self.fill("Sense resistor Ω", "0.11")
        self.fill("Current at full scale A", "2.5")
        self.click("This is the motor")

    def set_up(self) -> None:
        self.at("Current and ramp")
        self.click(re.compile("^Apply"))
        expect(self.page.get_by_test_id("start-up-state")).to_contain_text("can move now", timeout=PATIENCE_MS)
        self.click("Go on")

    def limits(self) -> None:
        self.at("Limits")
        self.click("Set these limits")
        self.at("Direction")

    def turned(self, press: str | None = "One turn forward") -> None:
        """A turn, and rest; what is stepped from outside gets its steps."""
        before = self.position()
        if press is not None and (not self.stepped or "own_velocity" in self.can):
            self.click(press)
        elif self.stepped:
            self.patch(pins={"step_hz": 2000.0})
        wait_for(lambda: self.position() != before, "it turns", PATIENCE_MS / 1000)
        if self.stepped and "own_velocity" not in self.can:
            self.patch(pins={"step_hz": 0.0})
        wait_for(lambda: not self.chip.axis()["moving"], "it rests", PATIENCE_MS / 1000)

    def position(self) -> float:
        axis = self.chip.axis()
        truth = axis["ground_truth"]
        return float(truth["shaft_position"] if self.stepped and truth else axis["position"])

    def encoder(self, lines: int = LINES) -> None:
        self.at("Encoder")
        if "encoder" not in self.can:
            self.click("Go on")
            return
        if "parameters" in self.can:
            self.turned()
            self.turned("One turn back")
            self.click("Go on")
            return
        self.look(lines)
        self.click("Go on")

    def look(self, lines: int) -> None:
        """The study of the encoder, told so many lines."""
        expect(self.page.get_by_label("Lines a turn")).to_be_visible()  # that step comes late
        self.fill("Lines a turn", str(lines))
        self.click(re.compile("^Apply"))
        expect(self.step.get_by_test_id("start-up-state")).to_contain_text("can move now", timeout=PATIENCE_MS)
        self.click("Look (moves)")
        wait_for(lambda: self.study()["state"] not in ("waiting", "running"), "the study ends", 120.0)

    def study(self) -> dict[str, Any]:
        """Its newest, with what it has found."""
        studies = self.chip.api.get("/studies").raise_for_status().json()["studies"]
        mine = [study for study in studies if study["device"] == self.chip.device]
        if not mine:
            return {"state": "waiting"}
        found: dict[str, Any] = self.chip.api.get(f"/studies/{mine[0]['id']}").raise_for_status().json()
        return found

    def switches(self) -> None:
        self.at("Switches")
        if self.stepped:
            self.click("Go on")
            return
        for side in ("left", "right"):
            assert self.pressed(side, side) == "right one", side
        self.page.get_by_test_id("set-zero").click()
        self.clicks += 1
        wait_for(lambda: self.chip.axis()["position"] == 0, "zero is here")
        self.click("Go on")

    def pressed(self, said: str, really: str | None) -> str | None:
        """What the page says of a switch that is pressed, and said to be `said`."""
        answer = self.page.get_by_test_id("switch-answer")
        self.click(f"I press the {said} one")
        expect(answer).to_have_attribute("data-kind", "waiting")
        if really is not None:
            self.force(really, True)
        expect(answer).not_to_have_attribute("data-kind", "waiting", timeout=A_PRESS_MS)
        told = answer.get_attribute("data-kind")
        if really is not None:
            self.force(really, "auto")
        return told

    def force(self, side: str, level: bool | str) -> None:
        if self.model in OF_A_STAGE:
            self.patch(switches=[{"axis": 0, side: level}])
        elif self.model in OF_AN_AXIS:
            self.patch(axes=[{"axis": 0, "switches": {side: level}}])
        else:
            self.patch(switches={side: level})

    def unplug_motor(self) -> None:
        change = {"motor": {"connected": False}}
        self.patch(**({"axes": [{"axis": 0, **change}]} if self.model in OF_AN_AXIS else change))

    def patch(self, **change: Any) -> None:
        self.chip.emulator(**change)

    def move(self) -> None:
        self.at("First move")
        self.turned("Move one turn")
        expect(self.page.get_by_role("img", name=re.compile("over time"))).to_be_visible(timeout=PATIENCE_MS)
        self.click("Go on")

    def keep(self) -> None:
        self.at("Keep it")
        self.click("Keep the profile")
        expect(self.page.get_by_role("status").filter(has_text="Kept, with")).to_be_visible(timeout=PATIENCE_MS)


def measure(quick: bool) -> Sequence[Row]:
    """One line a model, then one a fault; `quick` leaves most models out."""
    with (
        tempfile.TemporaryDirectory() as folder,
        ServerProcess(Path(folder), "--no-demo") as server,
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=chromium_flags())
        rows = [_attempt(server, browser, model) for model in (QUICK if quick else MODELS)]
        rows += [_fault(server, browser, model, fault) for model, fault in FAULTS]
        browser.close()
    return rows


@contextmanager
def guided(server: ServerProcess, browser: Browser, model: str, **emulator: Any) -> Iterator[Guided]:
    """A page of a new device that nobody has set up; `emulator` is how it is made."""
    with a_client(server.url, 60.0) as api:
        take_the_bench(api)
        context = browser.new_context(base_url=server.url, viewport={"width": 1440, "height": 900})
        begin_with_the_bench(context)
        try:
            with _device(api, model, emulator) as chip:
                page = context.new_page()
                select(page, chip)
                run = Guided(page, chip, model)
                run.open()
                yield run
                page.close()
        finally:
            context.close()


@contextmanager
def _device(api: Any, model: str, emulator: dict[str, Any]) -> Iterator[Chip]:
    if not emulator:
        with a_chip(api, f"first run of a {model}", model) as chip:
            yield chip
        return
    body = {"name": f"faulty {model}", "model": model, "link": {"kind": "emulator", **emulator}}
    device = api.post("/devices", json=body).raise_for_status().json()["id"]
    try:
        wait_for(lambda: api.get(f"/devices/{device}").json()["state"] == "connected", "it is connected")
        yield Chip(api, device)
    finally:
        api.post("/stop")
        api.delete(f"/devices/{device}").raise_for_status()


def _attempt(server: ServerProcess, browser: Browser, model: str) -> Row:
    with guided(server, browser, model) as run:
        began_s = time.perf_counter()
        try:
            run.motor()
            run.set_up()
            run.limits()
            run.turned()
            run.click("It turned the right way")
            run.encoder()
            run.switches()
            run.move()
            run.keep()
        except Exception as error:
            return _failed(f"first run of a {model}", error)
        took_s = time.perf_counter() - began_s
    return Row(
        what=f"first run of a {model}",
        measured=f"{took_s:.0f} s, {run.clicks} clicks",
        peer=f"limit {WITHIN_S:g} s",
        ratio=WITHIN_S / took_s,
        required=">= 1",
        ok=took_s <= WITHIN_S,
    )


def _failed(what: str, error: Exception) -> Row:
    said = " ".join(str(error).split())[:300]
    return Row(what, "failed", "", 0.0, "done", False, notes=(f"{type(error).__name__}: {said}",))


# --- faults -------------------------------------------------------------------------------------------


def _until_direction(run: Guided) -> None:
    run.motor()
    run.set_up()
    run.limits()


def _to(run: Guided, title: str) -> None:
    run.page.get_by_role("list", name="Steps").get_by_role("button", name=title).click()
    run.at(title)


def reversed_direction(run: Guided) -> str:
    """The shaft bit turns the motor the other way: the page finds the setting, and its other value turns it back."""
    _until_direction(run)
    run.turned()
    run.click("It turned the other way")
    run.click("Reverse it")
    expect(run.step.get_by_role("button", name="Reverse it")).not_to_have_attribute("data-loading", "true")
    told = run.step.locator("code").inner_text()
    before = run.chip.axis()["ground_truth"]["shaft_position"]
    run.turned()
    after = run.chip.axis()["ground_truth"]["shaft_position"]
    if run.model not in OF_A_STAGE:  # whose motor is told of by the steps alone
        assert after < before, f"the shaft went from {before} to {after} after it was reversed"
    return told


def not_connected(run: Guided) -> str:
    """The motor's plug is out."""
    _until_direction(run)
    run.unplug_motor()
    run.click("It did not turn")
    told = run.page.get_by_test_id("no-turn")
    expect(told).to_contain_text("not connected", timeout=PATIENCE_MS)
    return " ".join(told.inner_text().split())


def _encoder_finding(lines: int, name: str, words: str) -> Callable[[Guided], str]:
    def look(run: Guided) -> str:
        _until_direction(run)
        _to(run, "Encoder")
        run.look(lines)
        findings = {each["name"]: each for each in run.study()["findings"]}
        told = str(findings.get(name, {}).get("text", "nothing"))
        assert words in told, f"{name}: {told}"
        expect(run.step).to_contain_text(words)
        return told

    return look


def swapped_switches(run: Guided) -> str:
    """The left one is pressed, and the right input answers."""
    _until_direction(run)
    _to(run, "Switches and zero")
    assert run.pressed("left", "right") == "other"
    expect(run.step).to_contain_text(re.compile("Swap them|swap their two plugs"))
    return "named, with " + ("a setting" if run.step.get_by_text("Swap them").count() else "the plugs to swap")


def no_switch(run: Guided) -> str:
    """Nobody presses, or nothing is connected."""
    _until_direction(run)
    _to(run, "Switches and zero")
    assert run.pressed("left", None) == "none"
    return "none after 20 s"


Fault = tuple[str, dict[str, Any], Callable[[Guided], str]]
DIRECTION: Fault = ("reversed direction", {}, reversed_direction)
UNPLUGGED: Fault = ("motor not connected", {}, not_connected)
SWAPPED: Fault = ("swapped limit switches", {}, swapped_switches)
NO_SWITCH: Fault = ("no switch", {}, no_switch)
WRONG_LINES: Fault = ("encoder with other lines", {}, _encoder_finding(2500, "encoder", "of the way"))
REVERSED_ENCODER: Fault = (
    *("reversed encoder", {"encoder": {"reversed": True}}),
    _encoder_finding(LINES, "polarity", "against the motor"),
)
NO_ENCODER: Fault = (
    *("no encoder at its inputs", {"encoder": {"kind": "ssi"}}),
    _encoder_finding(LINES, "encoder", "stands still"),
)
FAULTS: Sequence[tuple[str, Fault]] = (
    *((model, DIRECTION) for model in ("tmc4210", "tmc4361", "tmc5160", "pd42-1241", "tmc2209")),
    *((model, UNPLUGGED) for model in ("tmc4361", "tmc5160", "pd42-1241", "tmc2209", "tmc2130")),
    *((model, fault) for fault in (WRONG_LINES, REVERSED_ENCODER) for model in ("tmc4361", "tmc5160")),
    ("tmc4361", NO_ENCODER),
    *((model, SWAPPED) for model in ("tmc428", "tmc4210", "tmc4361", "tmc5160", "pd42-1241")),
    ("tmc5160", NO_SWITCH),
)


def _fault(server: ServerProcess, browser: Browser, model: str, fault: Fault) -> Row:
    name, emulator, look = fault
    what = f"first run of a {model}, {name}"
    with guided(server, browser, model, **emulator) as run:
        try:
            told = look(run)
        except Exception as error:
            return _failed(what, error)
    return Row(what, "named", "", 1.0, "named", True, notes=(told,))
