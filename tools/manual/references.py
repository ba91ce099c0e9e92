# SPDX-License-Identifier: Apache-2.0
"""docs/references.bib, and the citations of it in help texts."""

from __future__ import annotations

import re
from pathlib import Path

_ACCENTS = {"'": "\u0301", "`": "\u0300", '"': "\u0308", "v": "\u030c", "c": "\u0327"}
_CITATION = re.compile(r"\[([A-Za-z]{2,}\d{4}[a-z]?)(?=[\],;])")


def _plain(text: str) -> str:
    """TeX as far as the file uses it: accents, dashes, protecting braces."""
    import unicodedata

    text = re.sub(r"\\(['`\"vc]) ?\{?(\w)\}?", lambda m: unicodedata.normalize("NFC", m[2] + _ACCENTS[m[1]]), text)
    return text.replace("--", "–").replace("{", "").replace("}", "")


def read(path: Path) -> dict[str, dict[str, str]]:
    """Fields of each entry, by key."""
    entries = re.findall(r"^@\w+\{(\w+),\n(.*?)^\}", path.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    return {key: dict(re.findall(r"^  (\w+) = \{(.*)\},?$", body, re.MULTILINE)) for key, body in entries}


def cited(text: str) -> list[str]:
    """Keys in the order of their first mention."""
    return list(dict.fromkeys(_CITATION.findall(text)))


def entry_text(entry: dict[str, str]) -> str:
    """One entry as a line: authors, year, title, where it appeared."""
    surnames = [_plain(author.split(",")[0]).strip() for author in entry["author"].split(" and ")]
    authors = surnames[0] + " et al." if len(surnames) > 3 else ", ".join(surnames)
    places = ("journal", "booktitle", "publisher", "institution", "school", "howpublished")
    place = next((_plain(entry[field]) for field in places if field in entry), "")
    return f"{authors} {entry['year']}. *{_plain(entry['title'])}*." + (f" {place}." if place else "")
