"""Tables and figures of a collected dataset, beside the published numbers.

Imports `bridge` (the theory that a figure draws) and below; nothing runs from here.
"""
