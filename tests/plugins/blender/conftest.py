# SPDX-License-Identifier: Apache-2.0
"""The extension, installed into this process' Blender as a user installs it. ./dev test --blender runs these tests."""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import pytest

NAME = "bl_ext.user_default.relume"


def pytest_sessionstart() -> None:
    """Install and enable it before test files import what it brings: relume. The environment names the archive."""
    archive = os.environ["RELUME_BLENDER_EXTENSION"]
    assert bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default") == {"FINISHED"}
    assert NAME in bpy.context.preferences.addons


@pytest.fixture
def module() -> Callable[[str], Any]:
    """A module of the extension."""
    return lambda name: importlib.import_module(f"{NAME}.{name}")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path
