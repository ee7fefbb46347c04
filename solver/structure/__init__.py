"""Bottom-fixed elastic platform, a frame of 3-D beams: section 2.2 of Heo, Koo and Kim (2022).

Stiffness, mass, statics, modes, water loads, stresses of the legs. Imports what is no room, and `sea` to tell how long
waves are beside a member; knows no scenes: a platform as the time loop sees it is in `solver.coupled.support`.
"""
