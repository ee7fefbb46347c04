"""Hydrostatic and incident-wave pressure on the surface that is wet now: section 2.1.2 of Heo, Koo and Kim (2022).

By quadrature, on bodies of revolution and on panels; the paper's sum over panels is in `solver.reference`.
Of physics imports `hull` and the sea's local field.
"""
