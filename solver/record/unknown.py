"""What coefficients from a file do not tell of a record: loads along motions that joints hold."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from solver.hydrodynamics.bem.coefficients import DOFS, Hydrodynamics, lacking
from solver.record.channels import Labelled, Record
from solver.scene import Scene

OUTPUT = "hinge_force"


def without_unknown(record: Record, scene: Scene, h: Hydrodynamics | None) -> tuple[Record, list[str]]:
    """The record with NaN for forces of joints along which waves push and a file lacks that; and sentences of it."""
    if h is None or not (columns := lacking(h)):
        return record, []
    cells, sentences = set(), []
    for b, f in enumerate(scene.floats):
        if not (along := [dof for body, dof in columns if body == b]):
            continue
        cells |= {(bearer, dof) for bearer in scene.bearers(b) for dof in along}  # a joint bears what it carries, too
        held, axes = (", ".join(names[d] for d in along) for names in (DOFS, "xyz"))
        sentences.append(f"coefficients: the file lacks {held} of {f.name}, so its {OUTPUT} along {axes} is not known")
    known = replace(record, variables=_masked(record.variables, cells), series=_masked(record.series, cells))
    return known, sentences


def _masked(of: Mapping[str, Labelled], cells: set[tuple[int, int]]) -> dict[str, Labelled]:
    out = dict(of)
    for name, (dims, values) in of.items():
        if name.startswith(OUTPUT) and "direction" in dims:
            known = np.moveaxis(np.array(values, float), (dims.index("float"), dims.index("direction")), (0, 1))
            for cell in cells:
                known[cell] = np.nan
            out[name] = dims, np.moveaxis(known, (0, 1), (dims.index("float"), dims.index("direction")))
    return out
