"""The memory of radiated waves as a passive sum of exponentials: eqs. 13-14 of Heo, Koo and Kim (2022).

Imports `errors` alone: arrays in, arrays out.
"""
