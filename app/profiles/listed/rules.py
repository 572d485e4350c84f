"""What of a module that is known by name alone is configuration: nobody here knows, so that it has no profiles."""

from __future__ import annotations

from ..rules import ProfileRules

RULES = ProfileRules(state=frozenset(), order=(), known=False)
