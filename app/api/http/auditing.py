"""Enters what comes from outside in the audit log: every call that may change something, done or refused.

It stands where it is known whose call it is, and before anything that may refuse it for a reason worth keeping (the
lease). What registers held and hold, drivers tell; the lease tells of itself.
"""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import asdict, replace
from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from ...devices.core.changes import DONE
from ...devices.core.config import DeviceConfig
from ...devices.manager import DeviceManager
from ...errors import UnknownThing
from ...store.audit import AuditLog, Request, request_under_way
from ..audit.wording import in_words, is_silent, taken_apart, value_of
from ..policy import Call, Policy, Said
from .guard import SAFE_METHODS
from .policies import Policies

KEPT_BYTES = 64 * 1024
"""Bodies and answers longer than this are not looked into: none whose words matter is."""
UNCERTAIN = (502, 504)
"""Answers that say that something went wrong on the wire: it may have happened."""


class Auditing:
    """ASGI middleware. `actor` is set already."""

    def __init__(self, app: ASGIApp, audit: AuditLog, manager: DeviceManager, policies: Policies) -> None:
        self._app, self._audit, self._manager, self._policies = app, audit, manager, policies
        self._base = f"{policies.base}/"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or scope["method"] in SAFE_METHODS or not scope["path"].startswith(self._base):
            await self._app(scope, receive, send)
            return
        call = taken_apart(
            scope["method"], scope["path"].removeprefix(self._base), scope["query_string"], self._policies.plain
        )
        policy = self._policies.of_call(call.key)
        if is_silent(policy, call):
            await self._app(scope, receive, send)
            return
        before = self._config(call)
        body, answer = _Kept(), _Kept()
        status = 500

        async def heard() -> Message:
            message = await receive()
            if message["type"] == "http.request":
                body.add(message.get("body", b""))
            return message

        async def said(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
            elif message["type"] == "http.response.body":
                answer.add(message.get("body", b""))
            await send(message)

        with request_under_way() as request:
            try:
                await self._app(scope, heard, said)
            finally:
                self._enter(call, policy, request, status, body, answer, before)

    def _enter(
        self,
        call: Call,
        policy: Policy,
        request: Request,
        status: int,
        body: _Kept,
        answer: _Kept,
        before: DeviceConfig | None,
    ) -> None:
        done = status < 400
        told_by_drivers = policy.audit == "told by drivers"
        if done and request.changes and told_by_drivers and not policy.partly:
            return  # the most frequent of all: nothing is taken apart for it
        given = answer.json()
        asked = body.json()
        call = replace(call, body=asked if isinstance(asked, dict) else {}, answer=given if done else None)
        outcomes = _failures(policy, call) if done else [_outcome(status, given)]
        if done and before is not None:
            self._edited(call, before)
            return
        if not done and request.failures and not policy.whole:
            return  # told by the driver already, and better
        if done and not outcomes and (policy.changed_nothing(call) or (told_by_drivers and request.changes)):
            return
        said = in_words(policy, call)
        for outcome in outcomes or [DONE]:
            for each in (said, *said.more):
                self._note(call, each, outcome)

    def _note(self, call: Call, said: Said, outcome: str) -> None:
        self._audit.note(
            said.action,
            said.subject,
            device=said.device or call.device,
            axis=call.axis if said.axis is None else said.axis,
            old=said.old,
            new=said.new,
            outcome=outcome,
            detail=said.detail,
        )

    # --- a connection that is edited ------------------------------------------------------------

    def _config(self, call: Call) -> DeviceConfig | None:
        """What is to be edited, as it is before."""
        if call.key != ("PATCH", "devices/{}") or call.device is None:
            return None
        try:
            return self._manager.get(call.device).config
        except UnknownThing:
            return None

    def _edited(self, call: Call, before: DeviceConfig) -> None:
        """An entry for each setting that is another one now."""
        name = call.answer.get("id") if isinstance(call.answer, dict) else None
        try:
            after = self._manager.get(name if isinstance(name, str) else str(call.device)).config
        except UnknownThing:  # removed meanwhile
            return
        old, new = _settings(before), _settings(after)
        for setting in sorted(old.keys() | new.keys()):
            if old.get(setting) != new.get(setting):
                said = Said("edit device", setting, value_of(old.get(setting)), value_of(new.get(setting)))
                self._note(call, said, DONE)


class _Kept:
    """The bytes of a message, as far as they are worth looking into."""

    __slots__ = ("_parts", "_size")

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._size = 0

    def add(self, part: bytes) -> None:
        self._size += len(part)
        if self._size <= KEPT_BYTES:
            self._parts.append(part)

    def json(self) -> Any:
        """What they say; None where they say nothing that we understand."""
        with suppress(ValueError, RecursionError):
            return json.loads(b"".join(self._parts)) if 0 < self._size <= KEPT_BYTES else None
        return None


def _failures(policy: Policy, call: Call) -> list[str]:
    """What went wrong within an answer that is a success as a whole."""
    if not policy.partly or not isinstance(call.answer, dict):
        return []
    results = call.answer.get("results")
    if isinstance(results, list):
        failed = [result for result in results if isinstance(result, dict) and result.get("problem")]
        return [
            f"not proven: {result.get('device')} axis {result.get('axis')}: {result['problem'].get('detail')}"
            for result in failed
        ]
    failed_write = call.answer.get("failed")
    return [_outcome(int(failed_write.get("status", 0)), failed_write)] if isinstance(failed_write, dict) else []


def _outcome(status: int, problem: Any) -> str:
    detail = problem.get("detail") if isinstance(problem, dict) else None
    return f"{'not proven' if status in UNCERTAIN else 'refused'}: {detail or f'status {status}'}"


def _settings(config: DeviceConfig) -> dict[str, Any]:
    """Every setting of a connection by a name as people say it: `axes.0.gear_ratio`."""
    flat: dict[str, Any] = {}

    def add(name: str, value: Any) -> None:
        if isinstance(value, dict):
            for key, part in value.items():
                add(f"{name}.{key}" if name else str(key), part)
        elif isinstance(value, list | tuple):
            for index, part in enumerate(value):
                add(f"{name}.{index}", part)
        else:
            flat[name] = value

    add("", asdict(config))
    return {name: value for name, value in flat.items() if name != "demo"}
