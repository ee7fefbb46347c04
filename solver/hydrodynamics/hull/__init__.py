"""Shapes of hulls: bodies of revolution, panel meshes, files of meshes, and meshes for the boundary elements.

Geometry and hydrostatics alone: imports `errors`, `quantities` and, for `meshfile`, capytaine's readers.
"""
