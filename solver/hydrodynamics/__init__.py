"""Loads of the water on a float: section 2.1.2 of Heo, Koo and Kim (2022).

Four rooms: `hull` (shapes), `radiation` (memory), `pressure` (the incident wave on the wetted surface) and `bem`
(coefficients); `library` has capytaine. They import the sea, and know nothing of scenes, platforms or time loops.
"""
