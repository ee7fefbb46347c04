"""Coefficients that others computed: readers of their files, each giving solver.hydrodynamics.bem.given.Given.

`reading` chooses by the file's name. Phases: WAMIT and BEMIO have Re{X exp(+iωt)}, capytaine Re{X exp(-iωt)} as here.
"""
