"""What a record says of its error beside the true one, on Buan and on scenes unlike it.

True: against the same coefficients with every knob refined. The share of the boundary elements, which needs
other coefficients, is told by `make validate` and tests/coupled/test_linear.py.
"""

from collections.abc import Iterator

from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.record.audit import MARGIN
from solver.run import simulate
from solver.scene import Scene
from studies.benchmark.case import coefficients, scene, with_settings, worst
from tests.awkward import SCENES

SECONDS = 900.0  # analysed, of Buan; the other scenes are as they are
FINER = 8  # times shorter steps
FINE = {
    "modes": 40, "stations_per_element": 6, "azimuths": 48, "arc_points": 16, "line_points": 10, "panel_size": 0.12,
    "field_tolerance": 1e-9, "newton_tolerance": 1e-9, "memory_tolerance": 3e-4,
}  # fmt: skip
HEADER = f"{'scene':20s}{'true':>10s}{'estimated':>11s}{'true over it':>14s}  worst"


def cases() -> Iterator[tuple[str, Scene, Hydrodynamics | None]]:
    """Name, scene and coefficients."""
    for platform in ("fixed", "elastic"):
        yield f"buan, {platform}", with_settings(scene(platform), duration=SECONDS), coefficients()[0]
    for name, make in SCENES.items():
        yield name.replace("_", " "), *make()


def table() -> list[float]:
    """Print a row a scene; true errors over estimates."""
    print(HEADER)
    ratios = []
    for name, item, known in cases():
        record = simulate(item, known)
        exact = simulate(with_settings(item, time_step=record.attrs["time_step"] / FINER, **FINE), known)
        true, what = worst(record, exact)
        told = record.attrs["estimated_error"] - MARGIN * record.attrs["mesh_effect"]
        ratios.append(true / told)
        print(f"{name:20s}{true:10.1e}{told:11.1e}{true / told:14.2f}  {what}", flush=True)
    return ratios


if __name__ == "__main__":
    table()
