# SPDX-License-Identifier: Apache-2.0
"""``python -m relume.cli``."""

from relume.cli import main

main()
