"""Entries of the audit log as the API tells them."""

from __future__ import annotations

from ...audit.csv_text import time_of
from ...store.audit_entries import Entry
from .schemas import AuditEntry


def shown(entry: Entry) -> AuditEntry:
    """An entry that is in the database."""
    assert entry.id is not None
    return AuditEntry(
        id=entry.id,
        time=time_of(entry),
        who=entry.who,
        kind=entry.kind,
        address=entry.address,
        device=entry.device,
        axis=entry.axis,
        action=entry.action,
        subject=entry.subject,
        old=entry.old,
        new=entry.new,
        outcome=entry.outcome,
        detail=entry.detail,
        call=entry.call,
    )
