"""What outputs of the steel cost, and loads to the surface: `python -m studies.benchmark.outputs`, in `make bench`.

Runs of the representative Buan case, elastic, in turns with the same run without any; processor time of one core.
"""

import statistics
import time
from dataclasses import replace

from solver.run import simulate
from solver.scene import Output, Scene
from studies.benchmark.case import coefficients, scene, with_settings

PAIRS = 5
YIELD = 355e6  # [Pa], by which tubes are utilised
FOUR: tuple[Output, ...] = ("reactions", "section_forces", "fibre_stress", "fatigue")
ASKED: dict[str, tuple[Output, ...]] = {
    **{name: (name,) for name in FOUR},
    "utilisation": ("utilisation",),
    "all but utilisation": FOUR,
    "all and leg tops": (*FOUR, "leg_tops", "utilisation"),
}


def yielding() -> Scene:
    """The case, with a yield strength."""
    item = scene("elastic")
    assert item.platform is not None, "asked of the elastic platform"
    frame = item.platform.frame
    members = tuple(replace(m, material=replace(m.material, yield_strength=YIELD)) for m in frame.members)
    return replace(item, platform=replace(item.platform, frame=replace(frame, members=members)))


def costs() -> dict[str, float]:
    """Medians of what each adds to a run, as a share of the run without any beside it."""
    item, (known, _) = yielding(), coefficients()
    assert item.platform is not None, "it has one"

    def seconds(asked: Scene) -> float:
        start = time.process_time()
        simulate(asked, known)
        return time.process_time() - start

    scenes = {name: with_settings(item, outputs=outputs) for name, outputs in ASKED.items()}
    scenes["loads to the surface"] = replace(item, platform=replace(item.platform, wave_stretching="wheeler"))
    added = {}
    for name, asked in scenes.items():
        seconds(asked)  # compile, and keep what every task has
        added[name] = statistics.median(seconds(asked) / seconds(item) - 1 for _ in range(PAIRS))
    return added


def table() -> dict[str, float]:
    """Print them."""
    added = costs()
    print("added to a run without any outputs of the steel:")
    for name, share in added.items():
        print(f"  {name:28s}{share:+6.0%}")
    return {f"cost_of_{name.replace(' ', '_')}": share for name, share in added.items()}


if __name__ == "__main__":
    table()
