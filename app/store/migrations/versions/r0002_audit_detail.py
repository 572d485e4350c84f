"""What else there is to say of an entry of the audit log: fields of a register, notes, what a request asked for."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """A column more; entries from before have nothing in it."""
    op.add_column("audit", sa.Column("detail", sa.String, nullable=False, server_default=""))
