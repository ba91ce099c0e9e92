# SPDX-License-Identifier: Apache-2.0
"""Frame patterns and ranges, as Python sees them."""

from __future__ import annotations

from pathlib import Path

import pytest
import relume
from relume.frames import find_frames, is_pattern, parse_frames, resolve_frame


@pytest.mark.parametrize(
    ("pattern", "frame", "name"),
    [
        ("shot.####.exr", 7, "shot.0007.exr"),
        ("shot.%04d.exr", 7, "shot.0007.exr"),
        ("shot.%d.exr", 1234, "shot.1234.exr"),
        ("shot.{frame}.exr", 7, "shot.7.exr"),
        ("shot.{frame:03d}.exr", 7, "shot.007.exr"),
        ("v_##/shot.####.exr", 12, "v_12/shot.0012.exr"),
        ("shot.exr", 7, "shot.exr"),
    ],
)
def test_names(pattern: str, frame: int, name: str) -> None:
    assert resolve_frame(pattern, frame) == name
    assert is_pattern(pattern) == (pattern != name)


def test_ranges() -> None:
    assert parse_frames("1001") == [1001]
    assert parse_frames("1-7x3,5") == [1, 4, 7, 5]
    assert parse_frames("-2-1") == [-2, -1, 0, 1]
    for wrong in ("", "a", "1-", "1-5x0", "1,,2", "1-99999999999"):
        with pytest.raises(relume.ArgumentError):
            parse_frames(wrong)


def test_find(tmp_path: Path) -> None:
    for name in (
        "a.0001.exr",
        "a.0010.exr",
        "a.12345.exr",
        "a.002.exr",
        "a.0003.png",
        "b.0004.exr",
        "a.-001.exr",
        "a.exr",
    ):
        (tmp_path / name).touch()
    assert find_frames(str(tmp_path / "a.####.exr")) == [-1, 1, 10, 12345]
    assert find_frames(str(tmp_path / "a.%04d.exr")) == [-1, 1, 10, 12345]
    assert find_frames(str(tmp_path / "a.###.exr")) == [2, 12345]
    assert find_frames(str(tmp_path / "c.####.exr")) == []
    assert find_frames(str(tmp_path / "nowhere" / "c.####.exr")) == []
    with pytest.raises(relume.ArgumentError, match="folder"):
        find_frames(str(tmp_path / "shot_####" / "a.####.exr"))
