"""Floats, platform and sea as one system in time: a scene becomes arrays (`assembly`, `support`), and steps (`march`).

Sections 2.1 and 2.2 of Heo, Koo and Kim (2022) together. Imports the scene, its `limits` and the rooms of physics
below; knows neither statistics nor files.
"""
