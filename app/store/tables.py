"""The tables of `stepscope.sqlite3`. A change here needs a migration; a test compares the two."""

from __future__ import annotations

from typing import Any

from sqlalchemy import JSON, Index
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

from .audit_entries import Value


class Base(DeclarativeBase):
    """All tables."""

    type_annotation_map = {dict[str, Any]: JSON}  # noqa: RUF012 (SQLAlchemy's own name, read once)


class AuditRow(Base):
    """One thing that a user did, or was refused."""

    __tablename__ = "audit"
    __table_args__ = (
        Index("audit_at", "at_unix_s"),
        Index("audit_device", "device", "id"),
        {"sqlite_autoincrement": True},  # ids never come again: "newer than the last that I saw" stays true
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    at_unix_s: Mapped[float]
    who: Mapped[str]
    kind: Mapped[str]
    """browser, client or server."""
    address: Mapped[str]
    device: Mapped[str | None]
    axis: Mapped[int | None]
    action: Mapped[str]
    subject: Mapped[str]
    old: Mapped[Value] = mapped_column(JSON(none_as_null=True))
    new: Mapped[Value] = mapped_column(JSON(none_as_null=True))
    outcome: Mapped[str]
    detail: Mapped[str] = mapped_column(server_default="")
    call: Mapped[int | None]
    """What entries of one request have in common; NULL of what belongs to none, and of entries from before."""


class ProfileRow(Base):
    """One kept profile: the document whole, and what lists show of it."""

    __tablename__ = "profiles"
    __table_args__ = ({"sqlite_autoincrement": True},)

    id: Mapped[int] = mapped_column(primary_key=True)
    name: Mapped[str]
    model: Mapped[str] = mapped_column(index=True)
    created_unix_s: Mapped[float]
    note: Mapped[str]
    document: Mapped[dict[str, Any]]
    version: Mapped[int]
    """Of the document's format."""
