"""A study as tasks: expansion along the axes, identity, and selection.

Imports `study`; knows nothing of physics and of files.
"""
