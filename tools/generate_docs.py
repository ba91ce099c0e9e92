# SPDX-License-Identifier: Apache-2.0
"""Writes the pages of the manual that are made from the parameter tables, with their pictures.

    ./dev docs             writes them
    ./dev docs --check     only says whether the texts are current and the pictures there (exit code 1 if not)

docs/shaders/NAME.md           a page for each built-in shader, with a strip of spheres for each parameter
docs/shaders/pictures/*.jpg    the strips
docs/shaders/README.md         the list of them
docs/lights.md                 the lights
"""

from __future__ import annotations

import sys
from pathlib import Path

from manual import pages, spheres

DOCS = Path(__file__).resolve().parents[1] / "docs"


def main(arguments: list[str]) -> int:
    """Write or check; returns the exit code."""
    check = arguments == ["--check"]
    if arguments and not check:
        print(__doc__, file=sys.stderr)
        return 2
    texts = pages.all_pages(DOCS)
    strips = spheres.all_strips()
    if check:
        stale = [path for path, text in texts.items() if not path.exists() or path.read_text(encoding="utf-8") != text]
        folder = DOCS / "shaders"
        stale += [path for path in folder.glob("*.md") if path not in texts]
        wanted = {folder / "pictures" / strip.file for strip in strips}
        stale += sorted(wanted ^ set((folder / "pictures").glob("*")))
        for path in stale:
            print(f"{path.relative_to(DOCS.parent)} is not what ./dev docs would write", file=sys.stderr)
        return 1 if stale else 0
    pictures = DOCS / "shaders" / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    for old in [*pictures.glob("*"), *(DOCS / "shaders").glob("*.md")]:
        old.unlink()
    for path, text in texts.items():
        path.write_text(text, encoding="utf-8")
    for strip in strips:
        if not spheres.write(strip, pictures / strip.file):
            print(f"{strip.shader} {strip.parameter}: all spheres look the same", file=sys.stderr)
    print(f"{len(texts)} pages, {len(strips)} pictures", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
