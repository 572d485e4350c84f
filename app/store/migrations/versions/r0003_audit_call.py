"""Which entries of the audit log belong together: those of one request."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """A column more; of entries from before nobody knows."""
    op.add_column("audit", sa.Column("call", sa.Integer, nullable=True))
