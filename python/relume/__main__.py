# SPDX-License-Identifier: Apache-2.0
"""``python -m relume``: the command line."""

from relume.cli import main

main()
