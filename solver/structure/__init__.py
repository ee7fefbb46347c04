"""Bottom-fixed elastic platform, a frame of 3-D beams: section 2.2 of Heo, Koo and Kim (2022).

Stiffness, mass, statics, modes, water loads, stresses of the legs. Imports `errors`, `kernels` and `statistics`; knows
neither waves nor scenes: a platform as the time loop sees it is in `solver.coupled.support`.
"""
