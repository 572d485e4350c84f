"""Named tokens on disk: who may come in, and what each may do. Hashes alone, in a file for its owner's eyes.

The command line writes this file as the server does; whoever may write to the data directory says who may come in.
"""

from __future__ import annotations

import hashlib
import re
import secrets
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from ..errors import UnknownThing, UsageError, WrongState
from .document import Entries, Entry, UnreadableDocument

FORMAT, VERSION = "stepscope-tokens", 1
FILE_NAME = "tokens.json"
Role = Literal["look", "drive", "administer"]
ROLES: tuple[Role, ...] = get_args(Role)
"""Each may do what those before it may."""
NAME = re.compile(r"[^\W\d](?:[\w.@+ -]{0,58}[\w.@+-])?")
RESERVED = frozenset({"stepscope"})
"""What the server calls itself in the audit log."""
TOKENS_MAX = 1000


@dataclass(frozen=True, slots=True)
class NamedToken:
    """One who may come in. `hash` is that of the token, which nobody can be told again."""

    name: str
    role: Role
    hash: str
    created_unix_s: float


@dataclass(frozen=True, slots=True)
class LoadedTokens:
    """What was found. `warnings` are for people."""

    tokens: tuple[NamedToken, ...]
    warnings: tuple[str, ...] = ()


def hash_of(token: str) -> str:
    """SHA-256, hexadecimal: what is drawn from 192 random bits needs no slow hash against guessing."""
    return hashlib.sha256(token.encode("utf-8", "replace")).hexdigest()


def at_least(role: Role, needed: Role) -> bool:
    """Whether `role` may do what `needed` may."""
    return ROLES.index(role) >= ROLES.index(needed)


class TokenStore:
    """The file. Everything here blocks."""

    def __init__(self, data_dir: Path) -> None:
        self._entries = Entries(data_dir / FILE_NAME, "tokens", FORMAT, VERSION)

    @property
    def path(self) -> Path:
        return self._entries.path

    def stamp(self) -> tuple[int, int, int] | None:
        """Another value whenever the file is another one; None without a file."""
        try:
            found = self.path.stat()
        except OSError:
            return None
        return found.st_mtime_ns, found.st_ino, found.st_size

    def load(self) -> LoadedTokens:
        """All of them; what cannot be read lets nobody in. Raises nothing."""
        try:
            entries = self._entries.read()
        except UnreadableDocument as error:
            return LoadedTokens((), (f"{self.path} cannot be read ({error}): no named token lets anybody in",))
        tokens, warnings = [], []
        for entry in entries:
            try:
                tokens.append(_token(entry))
            except (KeyError, TypeError, ValueError) as error:
                warnings.append(f"{self.path}: a token is left out: {error!r}")
        return LoadedTokens(tuple(tokens), tuple(warnings))

    def add(self, name: str, role: Role) -> str:
        """Make a token and return it, the only time. Raises UsageError, WrongState where the name is taken, OSError."""
        if not NAME.fullmatch(name) or name.casefold() in RESERVED:
            raise UsageError(
                f"{name[:70]!r} is no name for a token: it begins with a letter, and has 1 to 60 letters, digits and"
                f" . @ + - _ or spaces between,"
                f" and is not {', '.join(sorted(RESERVED))}"
            )
        if role not in ROLES:
            raise UsageError(f"a role is {', '.join(ROLES)}, not {role!r}")
        token = secrets.token_urlsafe(24)
        with self._entries.document.locked():
            tokens = self._kept()
            if any(each.name.casefold() == name.casefold() for each in tokens):
                raise WrongState(f"there is a token {name!r} already", "revoke it first, or take another name")
            if len(tokens) >= TOKENS_MAX:
                raise WrongState(f"there are {TOKENS_MAX} tokens already", "revoke one first")
            self._write([*tokens, NamedToken(name, role, hash_of(token), round(time.time(), 3))])
        return token

    def revoke(self, name: str) -> None:
        """End that token. Raises UnknownThing, OSError."""
        with self._entries.document.locked():
            tokens = self._kept()
            left = [each for each in tokens if each.name != name]
            if len(left) == len(tokens):
                raise UnknownThing("token", name, [each.name for each in tokens])
            self._write(left)

    def _kept(self) -> tuple[NamedToken, ...]:
        """What there is, before it is written anew; a file with something unreadable is kept under another name."""
        found = self.load()
        if found.warnings and self.path.exists():
            aside = self._entries.document.set_aside()
            aside.chmod(0o700 if aside.is_dir() else 0o600)
        return found.tokens

    def _write(self, tokens: Sequence[NamedToken]) -> None:
        # Made by mkstemp, so 0600 from its first moment.
        self._entries.write(
            [
                {"name": each.name, "role": each.role, "sha256": each.hash, "created_unix_s": each.created_unix_s}
                for each in tokens
            ]
        )


def _token(entry: Entry) -> NamedToken:
    name, role, digest, created = entry["name"], entry["role"], entry["sha256"], entry.get("created_unix_s", 0.0)
    if not isinstance(name, str) or not NAME.fullmatch(name) or name.casefold() in RESERVED:
        raise ValueError("its name is none")
    if role not in ROLES:
        raise ValueError(f"the role of {name!r} is none of {', '.join(ROLES)}")
    if not isinstance(digest, str) or not re.fullmatch("[0-9a-f]{64}", digest):
        raise ValueError(f"the hash of {name!r} is none")
    if isinstance(created, bool) or not isinstance(created, int | float):
        raise TypeError(f"when {name!r} was made is no number")
    return NamedToken(name, role, digest, float(created))
