# SPDX-License-Identifier: Apache-2.0
"""What ``./dev`` does once the machine is set up: one module for each thing it does."""
