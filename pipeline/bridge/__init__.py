"""The only room that knows physics: tables of a task -> the solver's inputs, and what workers run.

Checks of a study, realizations, geometries and their coefficients, scenes, the engine, and the solver's judgement
before anything runs. Imports `results`, `tasks` and `study`; the solver inside functions: `study status` is quick.
"""
