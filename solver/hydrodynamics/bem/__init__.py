"""Coefficients by boundary elements, as eqs. 12-14 of Heo, Koo and Kim (2022) need them.

Of physics imports `hull`, `radiation` (the fitted memory rides along with coefficients) and the sea.
"""
