"""The method of Heo, Koo and Kim (2022) as they have it, to hold the production path against; slow.

Constraints and Lagrange multipliers in two loops (section 2.1.1), panels under all wave components and direct
convolution (2.1.2), all modes (2.2). May import all of the solver but `run`; nothing else imports it.
"""
