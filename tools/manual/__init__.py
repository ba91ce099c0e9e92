# SPDX-License-Identifier: Apache-2.0
"""What tools/generate_docs.py makes the manual with: texts, references and pictures."""
