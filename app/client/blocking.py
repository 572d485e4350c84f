"""The client for plain scripts. Each call waits for its answer. Made by `make types` of `asynchronous`."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from types import TracebackType
from typing import Any, Self, TypeVar

import httpx
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from . import audit, calls, history, profiles, scripts
from .arrival import POLL_PERIOD_S, Arrival
from .audit import AuditEntry
from .calls import Call
from .errors import ClientError, NoServer, SearchEnded
from .history import Place
from .http import TIMEOUT_S, answer_of, content_of, headers, options, server_url, socket_url, timeout, token_of, told
from .lease import Lease, OnVanish
from .profiles import SavedProfile
from .records import AxisState, Device, Json, LeaseState, MoveStarted, Reading, Recording, Samples, Standing, Written
from .scripts import Script
from .stream import SUBPROTOCOL, Collector, samples_of

T = TypeVar("T")


class Bench:
    """A running stepscope. `url` is http://HOST:PORT, by default STEPSCOPE_URL or this machine's port 8000.

    Names of devices are their ids (`Device.id`). Every method raises NoServer, NoAnswer or Refused. May be used from
    several threads, and as a context manager.
    """

    def __init__(
        self,
        url: str | None = None,
        *,
        token: str | None = None,
        timeout_s: float = TIMEOUT_S,
        transport: httpx.BaseTransport | None = None,
    ) -> None:
        """`token` is what a server asks for that listens to a network, by default STEPSCOPE_TOKEN."""
        self.url = server_url(url)
        self._headers = headers(token_of(token))
        self._http = httpx.Client(
            base_url=self.url, headers=self._headers, timeout=timeout(timeout_s), transport=transport
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the server. Motors are left alone."""
        self._http.close()

    # --- the bench ------------------------------------------------------------------------------

    def health(self) -> Json:
        """Whether the server is there, and its version."""
        return self._send(calls.health())

    def devices(self) -> list[Device]:
        """All connections."""
        return self._send(calls.devices())

    def device(self, name: str) -> Device:
        """One connection."""
        return self._send(calls.device(name))

    def add(self, name: str, model: str, link: Json | None = None, **more: Any) -> Device:
        """Connect something: `link` is `{"kind": ...}` with its options, an emulator by default."""
        return self._send(calls.add(name, model, link or {"kind": "emulator"}, more))

    def remove(self, name: str) -> None:
        """Disconnect and forget."""
        self._send(calls.remove(name))

    def conditions(self) -> list[Standing]:
        """How every axis of every device stands, as judged last; asks no device."""
        return self._send(calls.conditions())

    def remedy(self, remedy: Json) -> Any:
        """Make the call that a condition names as what helps; one with `moves` may set the motor in motion."""
        return self.call(remedy["method"], remedy["path"], remedy["body"])

    def catalog(self) -> list[Json]:
        """Every model that can be connected."""
        return self._send(calls.catalog())

    def calc(self, subject: str, **body: Any) -> Json:
        """A calculator: `calc("pmul-pdiv", chip="tmc428", a_max=..., ramp_div=..., pulse_div=...)`."""
        return self._send(calls.calc(subject, body))

    def call(self, method: str, path: str, body: Json | None = None) -> Any:
        """Any other call of the API, its JSON as it comes."""
        return self._send(calls.anything(method, path, body))

    # --- who has it -----------------------------------------------------------------------------

    def lease_state(self) -> LeaseState:
        """Who has the bench, and who asks for it."""
        return self._send(calls.lease())

    def lease(self, name: str, *, wait_s: float = 0.0, on_vanish: OnVanish | None = None) -> Lease:
        """Have the bench alone: `with bench.lease("tuning"):`. Without, each call borrows it while it is free.

        Raises BenchTaken at the `with` when another session has it; with `wait_s` only after asking for so long [s].
        Signs that the script lives go out in the background. `on_vanish` sets what happens to moving motors when they
        stay away: "nothing", "stop" or "hold". The end of the `with` leaves motors alone.
        """
        return Lease(self._send, self._http.headers, name, wait_s, on_vanish)

    def audit(
        self,
        text: str = "",
        *,
        device: str = "",
        who: str = "",
        action: str = "",
        since: datetime | None = None,
        limit: int = 200,
        before: int | None = None,
    ) -> list[AuditEntry]:
        """Who did what, the newest first: entries with all words of `text`, at most 2000; older ones with `before`.

        `before` is the id of the last entry that is known. A time without a zone is this machine's.
        """
        return self._send(audit.entries(text, device, who, action, since, limit, before))

    # --- registers ------------------------------------------------------------------------------

    def read(self, device: str, register: str, axis: int | None = None) -> Reading:
        """A register, parameter or field, from the device itself."""
        return self._send(calls.read(device, register, axis))

    def read_all(self, device: str, axis: int | None = None, groups: Sequence[str] = ()) -> list[Reading]:
        """Everything that reading does not change."""
        return self._send(calls.read_all(device, axis, groups))

    def write(
        self, device: str, register: str, value: int | Mapping[str, int | str], axis: int | None = None
    ) -> Written:
        """Write the whole value, or some fields by name, and answer with the read-back."""
        return self._send(calls.write(device, register, value, axis))

    # --- motion ---------------------------------------------------------------------------------

    def axis(self, device: str, axis: int = 0) -> AxisState:
        """Where it is and what it does."""
        return self._send(calls.axis_state(device, axis))

    def start_up(
        self, device: str, axes: Sequence[int] | None = None, *, dry_run: bool = False, **figures: Any
    ) -> Json:
        """Set axes up after power-on, none for all: currents, microsteps, switches, ramp; all of it, or nothing.

        `figures` are velocity_pps, acceleration_pps2, microsteps, run_current_a, run_scale, counts_per_rev and others,
        and `motor={"rated_current_a": 1.0, "sense_resistor_ohm": 0.11}`. Tells each write and what was chosen.
        """
        return self._send(calls.start_up(device, axes, dry_run=dry_run, more=figures), profiles.APPLY_TIMEOUT_S)

    def move(
        self,
        device: str,
        axis: int,
        target: float,
        *,
        relative: bool = False,
        unit: str = "microsteps",
        wait: bool = True,
        on_look: Callable[[float, AxisState], None] | None = None,
    ) -> MoveStarted:
        """Go to `target`, or by it. With `wait` it returns at the target.

        `on_look` is told at each look how much of the way is done (0..1), and the state. Raises MoveEnded where the
        axis comes to rest elsewhere. An exception or Ctrl-C while waiting stops nothing: `stop` does.
        """
        started = self._send(calls.move(device, axis, target, relative=relative, unit=unit))
        if wait:
            self.wait(device, started, on_look)
        return started

    def wait(
        self, device: str, started: MoveStarted, on_look: Callable[[float, AxisState], None] | None = None
    ) -> AxisState:
        """Until that move has arrived. Raises MoveEnded."""
        arrival = Arrival(started)
        while True:
            state = self.axis(device, started.axis)
            arrived = arrival.update(state)
            if on_look is not None:
                on_look(arrival.share(state), state)
            if arrived:
                return state
            time.sleep(POLL_PERIOD_S)

    def rotate(
        self, device: str, axis: int, velocity: float, *, unit: str = "pps", hold_s: float | None = None
    ) -> Json:
        """Turn on and on; with `hold_s` it stops by itself after that."""
        return self._send(calls.rotate(device, axis, velocity, unit, hold_s))

    def home_by_stall(
        self,
        device: str,
        axis: int = 0,
        side: str = "left",
        *,
        velocity: float | None = None,
        threshold: int | None = None,
        current_percent: float | None = None,
        back_off: int | None = None,
        hits: int = 3,
        wait: bool = True,
    ) -> Json:
        """Search the end of the stage by stall, and call it 0; with `wait` the answer is how that ended.

        velocity : search speed [pps]; None: a turn a second
        threshold : of StallGuard; None: one is found
        current_percent : run current meanwhile, of full scale; None: as it is set
        back_off : between two hits [microsteps]; None: what it takes to get up to speed

        Raises SearchEnded where it fails. An exception or Ctrl-C while waiting ends nothing: `stop` does.
        """
        stall = {
            "side": side,
            "velocity": velocity,
            "threshold": threshold,
            "current_percent": current_percent,
            "back_off": back_off,
            "hits": hits,
        }
        state = self._send(calls.search(device, axis, {"stall": stall}))
        while wait and state["state"] == "running":
            time.sleep(POLL_PERIOD_S)
            state = self._send(calls.search_state(device, axis))
        if state["state"] not in ("running", "done"):
            raise SearchEnded(state)
        return state

    def stop(self, device: str, axis: int = 0, mode: str = "ramp") -> Json:
        """Stop one axis, ahead of everything that waits for its link."""
        return self._send(calls.stop(device, axis, mode))

    def stop_all(self, mode: str = "ramp") -> list[Json]:
        """Stop every axis of every device."""
        return self._send(calls.stop_all(mode))

    # --- several devices ------------------------------------------------------------------------

    def wiring(self) -> Json:
        """The nets by which pins of emulated devices are wired together, and the pins that can be."""
        return self._send(calls.wiring())

    def wire_pins(self, net: str, *pins: tuple[str, str]) -> Json:
        """Have exactly these pins, each of a device's id and its name (`("left", "START")`), on a net."""
        return self._send(calls.wire_pins(net, pins))

    def unwire_pins(self, net: str) -> Json:
        """Take all pins off a net."""
        return self._send(calls.unwire_pins(net))

    def start_together(self, *moves: Json, use_wires: bool = True) -> Json:
        """Start axes of any devices together, each move `{"device", "axis", "target"}`; by START where it is wired.

        The answer has the skew of each [s] and how sure that is. Nothing moves where one of them cannot.
        """
        return self._send(calls.start_together(moves, use_wires))

    def plan_line(self, axes: Sequence[Json], points: Sequence[Sequence[int]], **more: Any) -> Json:
        """What the planners expect of a straight line of `axes` (`{"device", "axis"}` each) through `points`.

        more : `pace` (0 to 1), or `duration_s` of each leg
        """
        return self._send(calls.line("/plan", axes, points, more))

    def start_line(self, axes: Sequence[Json], points: Sequence[Sequence[int]], **more: Any) -> Json:
        """Go there, all arriving together; `line` tells how it goes. What `plan_line` takes."""
        return self._send(calls.line("", axes, points, more))

    def line(self) -> Json:
        """How the present straight line goes, or how the latest one went."""
        return self._send(calls.line_state("GET"))

    def line_path(self) -> Json:
        """Where the axes of that line were seen, on each leg, and how far from the line."""
        return self._send(calls.line_path())

    def stop_line(self) -> Json:
        """End it and stop its motors."""
        return self._send(calls.line_state("DELETE"))

    # --- measuring ------------------------------------------------------------------------------

    def watch(
        self,
        device: str,
        channels: Sequence[str],
        seconds: float,
        rate_hz: float = 100.0,
        on_rows: Callable[[float], None] | None = None,
    ) -> Samples:
        """So many seconds of telemetry as arrays. `on_rows` is told how much there is [s]."""
        collector = Collector(seconds)
        address = socket_url(self.url, calls.telemetry_path(device, channels, rate_hz, 0.0))
        try:
            with connect(
                address, subprotocols=[Subprotocol(SUBPROTOCOL)], additional_headers=self._headers, max_size=None
            ) as socket:
                for message in socket:
                    if collector.feed(message):
                        break
                    if on_rows is not None:
                        on_rows(collector.done_s)
        except ConnectionClosed as error:
            raise ClientError(f"the stream of {device} ended: {error}") from error
        except OSError as error:
            raise NoServer(f"no stepscope answers at {self.url}: {error}") from error
        return collector.samples()

    def record(
        self,
        device: str,
        channels: Sequence[str],
        rate_hz: float = 200.0,
        *,
        seconds: float | None = None,
        trigger: Json | None = None,
        name: str = "",
        note: str = "",
    ) -> Recording:
        """Begin to record in the server, whoever listens: until `stop_recording`, or for `seconds` from the trigger.

        `trigger` is {"kind": "now"}, {"kind": "move", "axis": 0, "pre_s": 0.5} or {"kind": "level", "channel": ...}.
        """
        more = {"duration_s": seconds, "trigger": trigger or {"kind": "now"}, "name": name, "note": note}
        return self._send(calls.record_start(device, channels, rate_hz, more))

    def stop_recording(self, recording: str) -> Recording:
        """End it; one that is over stays as it is."""
        return self._send(calls.record_stop(recording))

    def recordings(self, search: str = "") -> list[Recording]:
        """All of them, the latest first; with `search` those with these words in name, note, device or model."""
        found, before = self._send(calls.recordings(search))
        while before is not None:
            more, before = self._send(calls.recordings(search, before))
            found += more
        return found

    def recording(self, recording: str) -> Json:
        """Marks, figures and the configuration at the start."""
        return self._send(calls.recording(recording))

    def recording_info(self, recording: str) -> Recording:
        """Its line of the list: how far one is that runs."""
        return self._send(calls.recording_info(recording))

    def compare(self, recordings: Sequence[str], channels: Sequence[str] = (), align: str = "trigger") -> Json:
        """Recordings laid on each other at their "trigger", "start" or first "move": curves, differences to the first
        one, figures; of `channels`, or of all that two of them have."""
        return self._send(calls.compare(recordings, channels, align))

    def add_file(
        self,
        recording: str,
        name: str,
        content: bytes,
        *,
        offset_s: float | None = None,
        mark: int | None = None,
        like: str | None = None,
        channel: str | None = None,
    ) -> Json:
        """Lay a CSV file of an oscilloscope or another instrument beside a recording, as further channels.

        Its 0 lies on the recording's zero; at `offset_s` since that [s]; on the recording's `mark` of that number; or
        where its `channel` (None: its first) looks most `like` that channel of the recording.
        """
        added = self._send(calls.add_file(recording, name, content))
        align = {"offset_s": offset_s, "mark": mark, "like": like, "channel": channel}
        if all(each is None for each in align.values()):
            return added
        return self._send(calls.align_file(recording, added["number"], align))

    def align_file(self, recording: str, number: int, **align: Any) -> Json:
        """Put a file elsewhere on the recording's time: as `add_file`."""
        return self._send(calls.align_file(recording, number, align))

    def remove_file(self, recording: str, number: int) -> None:
        """Forget a file that lies beside a recording."""
        self._send(calls.remove_file(recording, number))

    def replay(self, recording: str, device: str | None = None) -> Json:
        """Begin to live through it once more on an emulator, with the motor and stage of `device` where one is named.

        `replay_progress` tells how it goes; its "recording" is the new one, as soon as that is there.
        """
        return self._send(calls.replay(recording, device))

    def replay_progress(self, recording: str) -> Json:
        """How the latest replay of a recording goes: its "state" is "running", "done" or "failed"."""
        return self._send(calls.replay_look(recording))

    def recorded(self, recording: str) -> Samples:
        """The rows of a recording as arrays."""
        head = self._send(calls.recording(recording))
        return samples_of(self.recording_file(recording, "parquet"), head["rate_hz"])

    def recording_file(self, recording: str, kind: str = "csv") -> bytes:
        """All rows as a file: "csv" or "parquet"."""
        return self._file(calls.recording_file(recording, kind))

    def study_report(self, study: str) -> bytes:
        """The report of a study as one HTML file."""
        return self._file(calls.study_report(study))

    def _file(self, path: str) -> bytes:
        try:
            response = self._http.get(path)
        except httpx.TransportError as error:
            raise told(error, self.url) from error
        return content_of(response)

    # --- profiles -------------------------------------------------------------------------------

    def profile(self, device: str) -> Json:
        """The device's whole configuration as a document, as it is now."""
        return self._send(profiles.capture(device))

    def apply_profile(self, device: str, document: Json, *, dry_run: bool = False, limits: bool = False) -> Json:
        """Bring the device to what `document` says, all of it or nothing; with `dry_run` only tell what would change.

        Soft limits only with `limits`. Raises Refused: its `facts` say what failed, and what is `left` where the way
        back failed too. The server goes on though nobody waits: `profile_progress`.
        """
        call = profiles.apply(device, document, dry_run=dry_run, limits=limits)
        return self._send(call, profiles.APPLY_TIMEOUT_S)

    def profile_progress(self, device: str) -> Json:
        """How far a profile is that is being applied, or what an earlier one has left unfinished."""
        return self._send(profiles.progress(device))

    def take_profile_back(self, device: str) -> Json:
        """Bring back what an unfinished profile has written."""
        return self._send(profiles.way_back(device), profiles.APPLY_TIMEOUT_S)

    def forget_profile(self, device: str) -> None:
        """Leave the device as an unfinished profile has left it."""
        self._send(profiles.forget(device))

    def profiles(self, search: str = "", model: str = "") -> list[SavedProfile]:
        """Kept profiles, the latest first; with `search` those with these words in name, note, model or device."""
        return self._send(profiles.kept(search, model))

    def saved_profile(self, profile: int) -> Json:
        """The document of a kept profile."""
        return self._send(profiles.get(profile))

    def save_profile(
        self,
        document: Json | None = None,
        *,
        device: str | None = None,
        name: str | None = None,
        note: str | None = None,
    ) -> SavedProfile:
        """Keep a document, or what `device` holds now."""
        return self._send(profiles.save(document, device, name, note))

    def edit_profile(self, profile: int, name: str | None = None, note: str | None = None) -> SavedProfile:
        """Another name or note."""
        return self._send(profiles.edit(profile, name, note))

    def delete_profile(self, profile: int) -> None:
        """Delete a kept profile for good."""
        self._send(profiles.delete(profile))

    def profile_script(self, profile: Json | int, language: str = "python") -> Script:
        """A profile, a document or the number of a kept one, as a program: "python", "curl", "c" or "tmcl".

        It was tried on an emulator. Raises Refused where the trial failed, with the differences.
        """
        return self._send(scripts.script(profile, language), scripts.SCRIPT_TIMEOUT_S)

    def compare_profiles(self, left: Json | int, right: Json | int) -> Json:
        """What differs between two profiles, each a document or the id of a kept one."""
        return self._send(profiles.compare(left, right))

    # --- history --------------------------------------------------------------------------------

    def history(self, device: str, limit: int = 100, before: int | None = None) -> Json:
        """What was done to a device, the newest first: `changes`, each with `entry`, `first`, `last` and `writes`."""
        return self._send(history.history(device, limit, before))

    def undo(
        self,
        device: str,
        *,
        since: datetime | None = None,
        before: int | None = None,
        without: int | None = None,
        registers: Sequence[Place] | None = None,
        seen: int | None = None,
        dry_run: bool = False,
    ) -> Json:
        """Put a device back to what it was: `since` a time, `before` an entry, or `without` one and its request.

        With `dry_run` only what would be put back is told: `registers`, each with `state` "ready", "ask" (written by
        somebody else since, or changed past the log: put back only where `registers` name it) or "cannot".
        """
        call = history.undo(device, since, before, without, registers, seen, dry_run=dry_run)
        return self._send(call, None if dry_run else profiles.APPLY_TIMEOUT_S)

    def _send(self, call: Call[T], timeout_s: float | None = None) -> T:
        try:
            response = self._http.request(**options(call, timeout_s))
        except httpx.TransportError as error:
            raise told(error, self.url) from error
        return answer_of(call, response)
