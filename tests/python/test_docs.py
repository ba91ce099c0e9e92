# SPDX-License-Identifier: Apache-2.0
"""The manual against the tree: citations, links, paths, commands and code in it are real.

In README.md and docs/, a fence ``sh`` is parsed by the command line that it calls; ``sh ci`` and ``python ci`` are run
as well, in an empty folder that all such fences of one file share, in order.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MANUAL = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")])
FOLDERS = ("core", "plugins", "bindings", "python", "tests", "tools", "examples", "docs", "cmake")

# Words before a year that are no author.
NOT_AUTHORS = {"SIGGRAPH", "Rec", "ACES", "Python", "Copyright"}


def name(path: Path) -> str:
    return str(path.relative_to(ROOT))


def sources() -> list[Path]:
    """Code and manual: everything that may cite."""
    suffixes = {".h", ".cpp", ".inl", ".py", ".md"}
    found = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if path.suffix in suffixes]
    return sorted(path for path in found if path != Path(__file__).resolve())


# ---- citations ------------------------------------------------------------------------------------------------------


def bibliography() -> dict[str, dict[str, str]]:
    """Fields of each entry, by key."""
    text = (ROOT / "docs" / "references.bib").read_text(encoding="utf-8")
    entries: dict[str, dict[str, str]] = {}
    for kind, key, body in re.findall(r"^@(\w+)\{(\w+),\n(.*?)^\}", text, re.MULTILINE | re.DOTALL):
        assert key not in entries, f"{key} is there twice"
        entries[key] = {"kind": kind, **dict(re.findall(r"^  (\w+) = \{(.*)\},?$", body, re.MULTILINE))}
    assert len(entries) == len(re.findall(r"^@", text, re.MULTILINE)), "an entry that is not laid out like the others"
    return entries


def plain(text: str) -> str:
    """A name without TeX's accents and braces."""
    return re.sub(r"\\.|[{}~]| (?=[a-z]\})", "", text)


def surnames(entry: dict[str, str]) -> list[str]:
    return [plain(author.split(",")[0]).strip() for author in entry["author"].split(" and ")]


def test_bibliography_is_complete() -> None:
    for key, entry in bibliography().items():
        for field in ("author", "title", "year"):
            assert entry.get(field), f"{key} has no {field}"
        assert key.endswith(entry["year"]), key
        first = surnames(entry)[0]
        names = (re.sub(r"[^A-Za-z]", "", first), *re.findall(r"[A-Za-z]+", first))
        assert key.lower().startswith(tuple(part.lower() for part in names)), key


def test_cited_keys_are_in_the_bibliography() -> None:
    known = bibliography()
    cited = 0
    missing = []
    for path in sources():
        for key in re.findall(r"\[([A-Za-z]{2,}(?:1[6-9]|20)\d\d[a-z]?)(?=[\],;])", path.read_text(encoding="utf-8")):
            cited += 1
            if key not in known:
                missing.append(f"{name(path)}: [{key}]")
    assert missing == []
    assert cited > 5


def test_authors_and_years_are_in_the_bibliography() -> None:
    """The same for prose, "Walter et al. 2007": an author of that name has an entry of that year."""
    known = {(surname.split()[-1], entry["year"]) for entry in bibliography().values() for surname in surnames(entry)}
    pattern = re.compile(r"\b([A-Z][a-zA-Z]*[a-z])(?: et al\.)?,? \(?((?:1[6-9]|20)\d\d)\b(?![-.]\d)")
    cited = 0
    missing = []
    for path in sources():
        if path.suffix == ".md" or "tests" in path.parts:
            continue
        for author, year in pattern.findall(path.read_text(encoding="utf-8")):
            if author in NOT_AUTHORS:
                continue
            cited += 1
            if (author, year) not in known:
                missing.append(f"{name(path)}: {author} {year}")
    assert missing == []
    assert cited > 5


# ---- links and paths ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("page", MANUAL, ids=name)
def test_links_lead_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text):
        if not re.match(r"[a-z]+:", target):
            assert (page.parent / target).exists(), f"{name(page)} links to {target}"
    for path in re.findall(rf"`((?:{'|'.join(FOLDERS)})/[\w./-]*)`", text):
        assert (ROOT / path).exists(), f"{name(page)} speaks of {path}"


# ---- fences ---------------------------------------------------------------------------------------------------------


FENCE = re.compile(r"^```([^\n`]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def fences(page: Path, *kinds: str) -> list[tuple[str, str]]:
    """Pairs (what stands behind the backticks, text) of the page's fences of these kinds."""
    found = FENCE.findall(page.read_text(encoding="utf-8"))
    return [(info.strip(), text) for info, text in found if info.split()[:1] and info.split()[0] in kinds]


def shell_words(text: str) -> list[list[str]]:
    """The words of each command of a shell text, whatever joins them."""
    found = []
    for line in text.replace("\\\n", " ").splitlines():
        for part in re.split(r"\s(?:&&|\|\||\||;)\s", line):
            words = shlex.split(part, comments=True)
            while words and re.fullmatch(r"\w+=.*", words[0]):
                words.pop(0)
            if words:
                found.append(words)
    return found


def check_command(words: list[str]) -> None:
    """The command exists and knows its options."""
    import click
    from relume.cli import commands as relume

    if words[0] == "./dev":
        usage = subprocess.run([ROOT / "dev", "help"], capture_output=True, text=True, check=True).stdout
        assert re.search(rf"^  {re.escape(words[1])} ", usage, re.MULTILINE), words
        if words[1] != "relume":
            return
        words = words[1:]
    if words[0] != "relume":
        return
    command: click.Command = relume
    context = click.Context(command, info_name="relume")
    rest = words[1:]
    while isinstance(command, click.Group) and rest and not rest[0].startswith("-"):
        sub = command.get_command(context, rest[0])
        assert sub is not None, f"`relume {' '.join(rest)}`: no command {rest[0]}"
        command, context, rest = sub, click.Context(sub, parent=context, info_name=rest[0]), rest[1:]
    # Options and the number of arguments, not the files that they name.
    command.make_parser(context).parse_args(list(rest))


def test_shell_commands_are_known() -> None:
    known = [words for page in MANUAL for _, text in fences(page, "sh") for words in shell_words(text)]
    assert any(words[0] == "relume" for words in known)
    for words in known:
        check_command(words)


def test_examples_run(tmp_path: Path) -> None:
    programs = tmp_path / "bin"
    programs.mkdir()
    relume = programs / "relume"
    relume.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m relume.cli "$@"\n')
    relume.chmod(0o755)
    environment = os.environ | {"PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"}
    count = 0
    for page in MANUAL:
        folder = tmp_path / name(page).replace("/", "-")
        folder.mkdir()
        for info, text in fences(page, "sh", "python"):
            if "ci" not in info.split():
                continue
            count += 1
            run = ["bash", "-euo", "pipefail", "-c", text] if info.startswith("sh") else [sys.executable, "-c", text]
            done = subprocess.run(run, cwd=folder, env=environment, capture_output=True, text=True, check=False)
            assert done.returncode == 0, f"{name(page)}:\n{text}\n{done.stdout}{done.stderr}"
    assert count > 0


def test_generated_pages_are_current() -> None:
    """After a change to a parameter table or help text: ./dev docs."""
    done = subprocess.run(
        [sys.executable, ROOT / "tools" / "generate_docs.py", "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def without_license(path: Path) -> str:
    lines = path.read_text(encoding="utf-8").splitlines()
    return "\n".join(line for line in lines if not re.match(r"(//|#) (SPDX|A shading model outside)", line))


def test_shader_guide_shows_the_example_that_is_built() -> None:
    page = ROOT / "docs" / "howto-shader.md"
    for kind, file in (("cpp", "toon.cpp"), ("cmake", "CMakeLists.txt")):
        ((_, shown),) = fences(page, kind)
        # Whatever a formatter makes of the white space.
        assert shown.split() == without_license(ROOT / "examples" / "shaders" / file).split()
