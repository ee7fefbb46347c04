"""A study file: TOML -> tables whose names, types and ranges are right, and the files that it refers to.

Imports no other room. Of the solver it knows errors, and the settings that [solver] and [record] mirror.
"""
