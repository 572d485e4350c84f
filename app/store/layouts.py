"""Layouts of the page's panels. What a layout says is the page's own business."""

from __future__ import annotations

from .revisions import RevisionChanged, RevisionStore


class LayoutChanged(RevisionChanged):
    """A layout has another revision than the one that was to be replaced."""

    kind = "layout"


class LayoutStore(RevisionStore):
    """The folder `layouts`."""

    kind = "layout"
    changed = LayoutChanged
