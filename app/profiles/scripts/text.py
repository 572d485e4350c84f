"""What people wrote, put where it cannot be taken for anything but a remark.

Names and notes of a profile come from anywhere. In a script they stand in remarks and in quoted words alone: one line,
no controls, no marks that turn the direction of reading, and nothing that ends a remark in the language at hand.
"""

from __future__ import annotations

import re
import textwrap
import unicodedata
from collections.abc import Iterator

WIDTH = 100
LONGEST = 2000
"""Characters of a note that a script repeats; the profile has them all."""


def one_line(text: str) -> str:
    """`text` without line ends, controls, surrogates and marks of direction: a space stands for each."""
    plain = "".join(" " if _is_unseen(letter) else letter for letter in text)
    return re.sub(r" {2,}", " ", plain).strip()


def _is_unseen(letter: str) -> bool:
    category = unicodedata.category(letter)
    return category[0] == "C" or category in ("Zl", "Zp", "Zs")


def lines(text: str) -> Iterator[str]:
    """A note as lines of at most `WIDTH` characters, each of them as `one_line` leaves it; the paragraphs stay."""
    if len(text) > LONGEST:
        text = text[:LONGEST] + " ..."
    for paragraph in re.split(r"\r\n|[\n\r\v\f\x1c-\x1e\x85\u2028\u2029]", text):
        yield from textwrap.wrap(one_line(paragraph), WIDTH) or ([""] if paragraph else [])


def ascii_only(text: str) -> str:
    """For readers that know no other letters: what ASCII lacks by its number, as Python spells it."""
    return text.encode("ascii", "backslashreplace").decode("ascii")


def c_remark(text: str) -> str:
    """For between `/*` and `*/`: neither of them, no trigraph, nothing that joins this line to the next."""
    text = ascii_only(one_line(text))
    text = text.replace("*/", "* /").replace("/*", "/ *")
    return re.sub(r"\?(?=\?)", "? ", text).rstrip("\\")


def c_name(text: str) -> str:
    """A name for C made of `text`: small letters, digits and underscores; never empty, never a digit first."""
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode().lower()
    name = re.sub(r"[^a-z0-9]+", "_", plain)[:40].strip("_")
    return f"profile_{name}" if name else "profile"


def file_stem(text: str) -> str:
    """A file name without its ending: small letters, digits and dashes; never empty, never a path."""
    return c_name(text).removeprefix("profile_").replace("_", "-") or "profile"
