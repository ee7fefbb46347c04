"""Shapes of hulls: bodies of revolution, panel meshes, files of meshes, and meshes for the boundary elements.

Geometry and hydrostatics alone: imports `errors`, and capytaine's readers for `meshfile`.
"""
