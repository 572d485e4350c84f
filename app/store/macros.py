"""Macros that people keep. What their steps mean is said in `app.macros`."""

from __future__ import annotations

from .revisions import RevisionChanged, RevisionStore


class MacroChanged(RevisionChanged):
    """A macro has another revision than the one that was to be replaced."""

    kind = "macro"


class MacroStore(RevisionStore):
    """The folder `macros`."""

    kind = "macro"
    changed = MacroChanged
