"""The sea: dispersion, spectra, realizations and the field around a float.

Section 2.3 of Heo, Koo and Kim (2022), and the incident wave of section 2.1.2.
Imports `errors`, `keys` and `quantities`.
"""
