"""What happens is on every page with the next frame after the server has told it; prints how late each part was."""

from __future__ import annotations

import itertools
import re
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, expect
from server_process import ServerProcess

from tests.e2e.chips import Chip, a_chip, select
from tests.e2e.conftest import DESKTOP, PHONE, Errors
from tests.e2e.motor import wait_for
from tests.e2e.test_conditions import Told

FRAMES = 2
"""Within so many beats of the screen a page has painted what it was told: it holds however busy the machine is."""
WATCH = """
window.told = [];
window.shown = [];
window.beats = 0;
const beat = () => { window.beats += 1; requestAnimationFrame(beat); };
requestAnimationFrame(beat);
const Socket = window.WebSocket;
window.WebSocket = class extends Socket {
  constructor(...given) {
    super(...given);
    if (!String(given[0]).endsWith('/conditions')) return;
    this.addEventListener('message', ({ data }) => {
      const at = Date.now() / 1000;
      const message = JSON.parse(data);
      for (const { device, axis, condition } of message.axes ?? [message]) {
        if (condition && device === 'rig' && axis === 0) window.told.push([condition.kind, at, window.beats]);
      }
    });
  }
};
new MutationObserver(() => {
  const kind = document.querySelector('[data-testid=condition-bar] [data-kind]')?.dataset.kind;
  if (kind === undefined || kind === window.shown.at(-1)?.[0]) return;
  const shown = [kind, null, window.beats];
  window.shown.push(shown);
  // painted: with the frame that follows
  requestAnimationFrame(() => {
    const port = new MessageChannel();
    port.port1.onmessage = () => { shown[1] = Date.now() / 1000; };
    port.port2.postMessage(0);
  });
}).observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ['data-kind'] });
"""


class Rig(Chip):
    """An emulated device that was started up."""

    counts = 0
    """Of its encoder a turn; 0: it has none that it is told of."""

    def around(self, **change: Any) -> None:
        """Change what is around the first axis, as the emulator of that model takes it."""
        model = self.api.get(f"/devices/{self.device}").json()["model"]
        if model.startswith("tmc5"):
            change = {"axes": [{"axis": 0, **change}]}
        elif model in ("tmc428", "tmc4210") and "switches" in change:
            change = {"switches": [{"axis": 0, **change["switches"]}]}
        self.emulator(**change)

    def rotate_away(self) -> None:
        self.call("rotate", velocity=-2_000, unit="pps")
        wait_for(lambda: self.axis()["velocity_pps"] < -1_000, "it turns")

    def ready_again(self) -> None:
        """As it was."""
        self.api.post(f"/devices/{self.device}/start-up", json={"counts_per_rev": self.counts}).raise_for_status()
        self.go_on()
        wait_for(self._arrived, "it is where it was sent")

    def go_on(self) -> None:
        """Believe the encoder, and move a little: so nobody wonders any more where it is."""
        if self.counts:
            self.call("position-from-encoder")
        self.call("move", target=64, relative=True)

    def _arrived(self) -> bool:
        told = self.told()
        if (
            told == "lost_steps" and not self.axis()["moving"]
        ):  # a rotor that gets its current back goes to the nearest pole
            self.go_on()
        return told == "on_target"

    def seen(self, told: Told, since_s: float) -> str:
        """What a test that waited in vain has to say."""
        device = self.api.get(f"/devices/{self.device}").json()
        stops = self.api.get(f"/devices/{self.device}/axes/0/stops").json()
        return "\n".join(
            [
                f"told since: {[kind for kind, at_s in told.kinds if at_s >= since_s]}, listens: {told.listens}",
                f"before: {[kind for kind, at_s in told.kinds if at_s < since_s][-5:]}",
                f"now: {device['state']}, {device['axes'][0]['condition']}",
                f"axis: {self.axis()}",
                f"stops: {stops[:3]}",
                f"emulator: {self.api.get(f'/devices/{self.device}/emulator').json()}",
            ]
        )

    def told(self) -> str:
        return str(self.api.get(f"/devices/{self.device}").json()["axes"][0]["condition"]["kind"])


@dataclass(frozen=True)
class Incident:
    """Something that happens to an axis: how it is brought about, and undone."""

    kind: str
    happen: Callable[[Rig], object]
    undo: Callable[[Rig], None]
    before: Callable[[Rig], None] = lambda rig: None


def plugged(rig: Rig) -> None:
    rig.emulator(faults={"unplugged": False})
    rig.api.post(f"/devices/{rig.device}/connect").raise_for_status()


def freed(rig: Rig) -> None:
    rig.around(blocked=False)
    rig.stop()


def let_go(rig: Rig) -> None:
    rig.around(switches={"left": "auto"})
    rig.stop()


SWITCH = Incident("held", lambda rig: rig.around(switches={"left": True}), let_go, Rig.rotate_away)
UNPLUGGED = Incident("not_connected", lambda rig: rig.emulator(faults={"unplugged": True}), plugged)
POWER = Incident("cannot_move", lambda rig: rig.emulator(power_cycle=True), lambda rig: None)
MODULE_POWER = Incident("unknown", lambda rig: rig.emulator(power_cycle=True), lambda rig: None)
BLOCKED = Incident("following_error", lambda rig: rig.around(blocked=True), freed, Rig.rotate_away)
RIGS: dict[str, tuple[Incident, ...]] = {
    "tmc4210": (SWITCH, POWER, UNPLUGGED),
    "tmc4361": (BLOCKED, SWITCH, POWER, UNPLUGGED),
    "tmc5160": (BLOCKED, SWITCH, POWER, UNPLUGGED),
    "pd42-1241": (SWITCH, MODULE_POWER, UNPLUGGED),
}


@pytest.mark.parametrize("model", RIGS)
def test_every_page_shows_what_happens_with_the_next_frame(
    new_context: Callable[..., BrowserContext], api: httpx.Client, server: ServerProcess, errors: Errors, model: str
) -> None:
    errors.expect("status of (404|409|502|504)")  # readings that are under way when the device goes
    errors.expect("status of 422 .*/velocity-profile/check")  # what a chip cannot play that has just lost its setting
    incidents = itertools.cycle(RIGS[model])
    with a_chip(api, "rig", model) as chip:
        rig = Rig(api, chip.device)
        rig.counts = 40_000 if BLOCKED in RIGS[model] else 0
        rig.ready_again()
        context = new_context()
        context.add_init_script(WATCH)
        select(context, rig)
        page = context.new_page()
        page.goto("/")
        expect(page.get_by_test_id("condition-bar")).to_contain_text("On target")
        links = page.get_by_role("navigation", name="Pages").locator("a:not([target])")
        names = [link.inner_text() for link in links.all()]
        assert len(names) > 8
        told = Told(server.url, rig.device)
        try:
            for name in names:
                links.filter(has_text=re.compile(f"^{re.escape(name)}$")).click()
                expect(page).to_have_title(f"{name} · stepscope")
                expect(page.get_by_label("Loading the page")).to_have_count(0)
                look(page, told, rig, next(incidents), f"{model:10} {name:14}")
        finally:
            told.close()
    assert not errors.unexpected()


def look(page: Page, told: Told, rig: Rig, incident: Incident, where: str) -> None:
    """Let it happen, see it on the page, and put it right."""
    incident.before(rig)
    page.evaluate("window.told = []; window.shown = []")
    began_s = time.time()
    incident.happen(rig)
    try:
        wait_for(lambda: told.first(incident.kind, began_s) is not None, f"the server judges it {incident.kind}")
    except AssertionError as error:
        error.add_note(rig.seen(told, began_s))
        raise
    told_s = told.first(incident.kind, began_s)
    assert told_s is not None
    page.wait_for_function("kind => window.shown.some(([seen, at]) => seen === kind && at)", arg=incident.kind)
    heard_s, heard = first(page.evaluate("window.told"), incident.kind)
    shown_s, shown = first(page.evaluate("window.shown"), incident.kind)
    sys.stdout.write(
        f"\n{where} {incident.kind:16} told {told_s - began_s:.2f}, "
        f"heard by the page {heard_s - began_s:.2f}, painted {shown_s - began_s:.2f} s"
    )
    assert shown - heard <= FRAMES, where
    incident.undo(rig)
    rig.ready_again()


def first(seen: list[tuple[str, float, int]], kind: str) -> tuple[float, int]:
    """When, and in which beat, it was first so."""
    return next((at_s, beat) for each, at_s, beat in seen if each == kind)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("incident", RIGS["tmc5160"], ids=lambda incident: incident.kind)
def test_nobody_is_shut_out_of_the_bench_with_a_bad_condition(
    new_context: Callable[..., BrowserContext],
    api: httpx.Client,
    errors: Errors,
    check_axe: Callable[[Page], None],
    incident: Incident,
    scheme: Literal["light", "dark"],
) -> None:
    errors.expect("status of (404|409|502|504)")
    with a_chip(api, "rig", "tmc5160") as chip:
        rig = Rig(api, chip.device)
        rig.counts = 40_000
        rig.ready_again()
        context = new_context(color_scheme=scheme)
        select(context, rig)
        page = context.new_page()
        page.goto("/")
        expect(page.get_by_test_id("condition-bar")).to_contain_text("On target")
        incident.before(rig)
        incident.happen(rig)
        expect(page.get_by_test_id("condition-card").locator(f"[data-kind={incident.kind}]")).to_be_visible()
        for size in (DESKTOP, PHONE):
            page.set_viewport_size(size)
            check_axe(page)
        page.set_viewport_size(DESKTOP)
        page.get_by_test_id("condition-bar").click()
        expect(page.get_by_test_id("condition-detail")).to_be_visible()
        check_axe(page)
    assert not errors.unexpected()
