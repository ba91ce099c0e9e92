# SPDX-License-Identifier: Apache-2.0
"""Sequences on many machines: tasks of Dask.distributed, templates of Open Job Description."""
