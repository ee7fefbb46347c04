"""What is kept of a run: statistics and series, spectra, and the audit that says how far to trust them.

The figures of section 3.2 of Heo, Koo and Kim (2022). Imports `coupled` and what is below it.
"""
