"""A scene in the frequency domain: the record of its linear model in a stationary sea, without a march.

Responses wave by wave, drag and quadratic damping linearised by what moves against them, statistics of Gaussian
processes, of one harmonic, or of the sum of waves whose phases are known. The same names as the time domain's record.
May import all of the solver but `run` and `reference`.
"""
