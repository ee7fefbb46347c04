"""Rigid bodies on chains of joints: kinematics and equations of motion in minimal coordinates.

In place of the constraints of section 2.1.1 of Heo, Koo and Kim (2022), which are in `solver.reference`. Imports
`hydrodynamics.pressure` and `catenary`, whose loads depend on where the bodies are.
"""
