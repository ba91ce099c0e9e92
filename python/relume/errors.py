# SPDX-License-Identifier: Apache-2.0
"""The exceptions of relume: one family under :class:`Error`.

Each says in one line what is wrong, where (file, channel, line and column) and what to do about it. Where Python has an
exception of the same meaning, ours is one of that kind too, so that ``except OSError`` or ``except ValueError`` works.
"""

from __future__ import annotations


class Error(Exception):
    """Base of everything that relume raises on purpose."""


class FileError(Error, OSError):
    """A file is missing, cannot be read or cannot be written; the disk is full."""


class FormatError(Error, ValueError):
    """A file is not what it should be: not an EXR, damaged, truncated, or beyond the limits of sanity."""


class ChannelError(Error, LookupError):
    """A channel that is needed is missing, ambiguous, or has the wrong size."""


class RigError(Error, ValueError):
    """A rig is not TOML, or holds an unknown or ill-typed key; the message has line and column."""


class ParameterError(Error, ValueError):
    """No such shader, light or parameter (the message has the nearest name), or a value out of its range."""


class UnknownNameError(ParameterError, KeyError, AttributeError):
    """A name that a mapping or an object of relume does not have; the message has the nearest one."""

    # KeyError shows the repr of its argument.
    __str__ = Exception.__str__


class ArgumentError(Error, ValueError):
    """An argument that no function can take: the shape or dtype of an array, a size, a number of threads."""


class PluginError(Error, RuntimeError):
    """A shader plugin that cannot be loaded."""


class MissingPackageError(Error, ImportError):
    """An optional package that this needs is not installed; the message says how to install it."""


class Cancelled(Error):  # noqa: N818 - it is no error of anybody's
    """The work was stopped because the caller asked for it."""
