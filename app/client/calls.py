"""Every call of the API as a value: what to send, and what the answer means. No sockets: both clients send these."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar
from urllib.parse import quote

from .records import (
    AxisState,
    Condition,
    Device,
    Json,
    LeaseState,
    MoveStarted,
    Reading,
    Recording,
    Standing,
    Written,
    record,
)

T = TypeVar("T")
BASE = "/api/v1"


@dataclass(frozen=True, slots=True)
class Call(Generic[T]):
    """A request, and how its JSON answer becomes a T."""

    method: str
    path: str
    parse: Callable[[Any], T]
    body: Json | None = None
    query: Mapping[str, str | int | list[str]] = field(default_factory=dict)
    content: bytes | None = None


def anything(method: str, path: str, body: Json | None = None) -> Call[Any]:
    """A call that has no name here: its JSON as it comes. `path` with or without `/api/v1`."""
    whole = path if path.startswith(BASE) else f"{BASE}/{path.lstrip('/')}"
    return Call(method.upper(), whole, _as_it_is, body)


def devices() -> Call[list[Device]]:
    return Call("GET", f"{BASE}/devices", lambda answer: [_device(each) for each in answer])


def device(name: str) -> Call[Device]:
    return Call("GET", _of(name), _device)


def add(name: str, model: str, link: Json, more: Json) -> Call[Device]:
    return Call("POST", f"{BASE}/devices", _device, {"name": name, "model": model, "link": link, **more})


def remove(name: str) -> Call[None]:
    return Call("DELETE", _of(name), _nothing)


def read(name: str, register: str, axis: int | None) -> Call[Reading]:
    return Call("GET", f"{_of(name)}/registers/{quote(register, safe='')}", _reading, query=_axis(axis))


def read_all(name: str, axis: int | None, groups: Sequence[str]) -> Call[list[Reading]]:
    query: dict[str, str | int | list[str]] = {**_axis(axis), **({"group": list(groups)} if groups else {})}
    return Call("GET", f"{_of(name)}/registers", lambda answer: [_reading(each) for each in answer], query=query)


def write(name: str, register: str, value: int | Mapping[str, int | str], axis: int | None) -> Call[Written]:
    body = {"fields": dict(value)} if isinstance(value, Mapping) else {"value": value}
    path = f"{_of(name)}/registers/{quote(register, safe='')}"
    return Call("PUT", path, lambda answer: record(Written, answer), body, _axis(axis))


def axis_state(name: str, axis: int) -> Call[AxisState]:
    return Call("GET", _of_axis(name, axis), _axis_state)


def conditions() -> Call[list[Standing]]:
    return Call(
        "GET",
        f"{BASE}/devices",
        lambda answer: [_standing(device["id"], axis["index"], axis) for device in answer for axis in device["axes"]],
    )


def start_up(name: str, axes: Sequence[int] | None, *, dry_run: bool, more: Json) -> Call[Json]:
    body = {"axes": None if axes is None else list(axes), "dry_run": dry_run, **more}
    query = {"dry_run": "true"} if dry_run else {}  # there too: so it needs no lease
    return Call("POST", f"{_of(name)}/start-up", _as_it_is, body, query)


def move(name: str, axis: int, target: float, *, relative: bool, unit: str) -> Call[MoveStarted]:
    body = {"target": target, "relative": relative, "unit": unit}
    return Call("POST", f"{_of_axis(name, axis)}/move", _move_started, body)


def rotate(name: str, axis: int, velocity: float, unit: str, hold_s: float | None) -> Call[Json]:
    body = {"velocity": velocity, "unit": unit, "hold_s": hold_s}
    return Call("POST", f"{_of_axis(name, axis)}/rotate", _as_it_is, body)


def search(name: str, axis: int, wanted: Json) -> Call[Json]:
    return Call("POST", f"{_of_axis(name, axis)}/reference-search", _as_it_is, wanted)


def search_state(name: str, axis: int) -> Call[Json]:
    return Call("GET", f"{_of_axis(name, axis)}/reference-search", _as_it_is)


def stop(name: str, axis: int, mode: str) -> Call[Json]:
    return Call("POST", f"{_of_axis(name, axis)}/stop", _as_it_is, {"mode": mode})


def stop_all(mode: str) -> Call[list[Json]]:
    return Call("POST", f"{BASE}/stop", lambda answer: list(answer["results"]), {"mode": mode})


def calc(subject: str, body: Json) -> Call[Json]:
    return Call("POST", f"{BASE}/calc/{quote(subject, safe='')}", _as_it_is, body)


def record_start(device: str, channels: Sequence[str], rate_hz: float, more: Json) -> Call[Recording]:
    body = {"device": device, "channels": list(channels), "rate_hz": rate_hz, **more}
    return Call("POST", f"{BASE}/recordings", _recording, body)


def record_stop(recording: str) -> Call[Recording]:
    return Call("POST", f"{_recorded(recording)}/stop", _recording, {})


def recordings(search: str, before: str = "") -> Call[tuple[list[Recording], str | None]]:
    """A page of recordings, and what to ask for the next one with; None at the end."""

    def parse(answer: Any) -> tuple[list[Recording], str | None]:
        return [_recording(each) for each in answer["recordings"]], answer["next"]

    asked = {"search": search, "before": before, "limit": "1000"}
    return Call("GET", f"{BASE}/recordings", parse, query={name: text for name, text in asked.items() if text})


def recording(recording: str) -> Call[Json]:
    return Call("GET", _recorded(recording), _as_it_is)


def recording_info(recording: str) -> Call[Recording]:
    return Call("GET", f"{_recorded(recording)}/info", _recording)


def compare(recordings: Sequence[str], channels: Sequence[str], align: str) -> Call[Json]:
    body = {"recordings": list(recordings), "channels": list(channels) or None, "align": align}
    return Call("POST", f"{BASE}/recordings/compare", _as_it_is, body)


def add_file(recording: str, name: str, content: bytes) -> Call[Json]:
    return Call("POST", f"{_recorded(recording)}/added", _as_it_is, query={"name": name}, content=content)


def align_file(recording: str, number: int, align: Json) -> Call[Json]:
    return Call("PATCH", f"{_recorded(recording)}/added/{number}", _as_it_is, align)


def remove_file(recording: str, number: int) -> Call[None]:
    return Call("DELETE", f"{_recorded(recording)}/added/{number}", _nothing)


def replay(recording: str, device: str | None) -> Call[Json]:
    return Call("POST", f"{_recorded(recording)}/replay", _as_it_is, {} if device is None else {"device": device})


def wiring() -> Call[Json]:
    return Call("GET", f"{BASE}/wiring", _as_it_is)


def wire_pins(net: str, pins: Sequence[tuple[str, str]]) -> Call[Json]:
    body = {"pins": [{"device": device, "pin": pin} for device, pin in pins]}
    return Call("PUT", f"{BASE}/wiring/{quote(net, safe='')}", _as_it_is, body)


def unwire_pins(net: str) -> Call[Json]:
    return Call("DELETE", f"{BASE}/wiring/{quote(net, safe='')}", _as_it_is)


def start_together(moves: Sequence[Json], use_wires: bool) -> Call[Json]:
    return Call("POST", f"{BASE}/start-together", _as_it_is, {"moves": list(moves), "use_wires": use_wires})


def line(what: str, axes: Sequence[Json], points: Sequence[Sequence[int]], more: Json) -> Call[Json]:
    body = {"axes": list(axes), "points": [list(point) for point in points], **more}
    return Call("POST", f"{BASE}/straight-line{what}", _as_it_is, body)


def line_path() -> Call[Json]:
    return Call("GET", f"{BASE}/straight-line/path", _as_it_is)


def line_state(method: str) -> Call[Json]:
    return Call(method, f"{BASE}/straight-line", _as_it_is)


def replay_look(recording: str) -> Call[Json]:
    return Call("GET", f"{_recorded(recording)}/replay", _as_it_is)


def study_report(study: str) -> str:
    return f"{BASE}/studies/{quote(study, safe='')}/report"


def recording_file(recording: str, kind: str) -> str:
    """Path and query of all rows as a file."""
    return f"{_recorded(recording)}?format={quote(kind, safe='')}"


def lease() -> Call[LeaseState]:
    return Call("GET", f"{BASE}/lease", _lease)


def lease_take(name: str) -> Call[LeaseState]:
    return Call("POST", f"{BASE}/lease", _lease, {"name": name})


def lease_keep(on_vanish: str | None = None) -> Call[LeaseState]:
    return Call("PUT", f"{BASE}/lease", _lease, {} if on_vanish is None else {"on_vanish": on_vanish})


def lease_give_back() -> Call[LeaseState]:
    return Call("DELETE", f"{BASE}/lease", _lease)


def lease_ask(name: str) -> Call[LeaseState]:
    return Call("POST", f"{BASE}/lease/ask", _lease, {"name": name})


def catalog() -> Call[list[Json]]:
    return Call("GET", f"{BASE}/catalog", _as_it_is)


def health() -> Call[Json]:
    return Call("GET", f"{BASE}/health", _as_it_is)


def telemetry_path(name: str, channels: Sequence[str], rate_hz: float, history_s: float) -> str:
    """Path and query of the telemetry socket."""
    asked = quote(",".join(channels), safe=",.")
    return f"{_of(name)}/telemetry?channels={asked}&rate_hz={rate_hz!r}&history_s={history_s!r}"


def _of(name: str) -> str:
    return f"{BASE}/devices/{quote(name, safe='')}"


def _of_axis(name: str, axis: int) -> str:
    return f"{_of(name)}/axes/{axis}"


def _recorded(recording: str) -> str:
    return f"{BASE}/recordings/{quote(recording, safe='')}"


def _recording(answer: Json) -> Recording:
    return record(Recording, answer)


def _axis(axis: int | None) -> dict[str, str | int | list[str]]:
    return {} if axis is None else {"axis": axis}


def _device(answer: Json) -> Device:
    lists = {name: tuple(answer[name]) for name in ("notes", "axes", "channels")}
    return record(Device, {**answer, **lists})


def _lease(answer: Json) -> LeaseState:
    return record(LeaseState, {**answer, "asking": tuple(answer["asking"])})


def condition(answer: Json) -> Condition:
    """A condition as the API tells it."""
    lists = {name: tuple(answer[name]) for name in ("evidence", "remedies")}
    return record(Condition, {**answer, **lists})


def _axis_state(answer: Json) -> AxisState:
    return record(AxisState, {**answer, "condition": condition(answer["condition"])})


def _standing(device: str, axis: int, answer: Json) -> Standing:
    return Standing(device, axis, condition(answer["condition"]), answer["referenced"], answer["ground_truth"])


def _reading(answer: Json) -> Reading:
    return record(Reading, answer)


def _move_started(answer: Json) -> MoveStarted:
    return record(MoveStarted, {**answer, "warnings": tuple(answer["warnings"])})


def _as_it_is(answer: Any) -> Any:
    return answer


def _nothing(answer: Any) -> None:
    del answer
