"""Axial forces of a frame under a load."""

import numpy as np

from solver.structure import statics


def pushed(model, load, spread=None):
    """N (ne, 2) under a load (6n,), of which `spread` (ne, 12) lies along the elements."""
    spread = np.zeros((len(model.length), 12)) if spread is None else spread
    return statics.axial_force(model, statics.static(model, load), spread)
