"""Sobol' indices of the rail's peak temperature of the paper's contact.

    python3 sensitivity.py [--samples 256] [--plot sensitivity.png]

SALib draws the sample and estimates the indices; docs/how-to/sensitivity.md explains them.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from SALib.analyze import sobol as analyse
from SALib.sample import sobol as sample

import cosim
from cosim import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CASE = Path(__file__).resolve().parents[3] / "cases" / "wheel-rail.toml"
RANGES = {
    "friction coefficient": ("friction.coefficient", 0.50, 0.65),
    "creepage [%]": ("motion.creepage.xi [%]", -1.05, -0.70),
    "load [kN]": ("load.normal_force [kN]", 120.0, 148.0),
    "speed [km/h]": ("motion.speed [km/h]", 126.0, 154.0),
    "crown radius [m]": ("bodies.rail.radius_y", 0.25, 0.35),
    "conductivity [W/(m K)]": ("materials.steel.conductivity", 40.0, 55.0),
    "specific heat [J/(kg K)]": ("materials.steel.specific_heat", 420.0, 500.0),
}
"""Inputs with keys and ranges, in which each value is equally likely."""
Indices = Mapping[str, Array]


def peak_temperature(**options: Any) -> cosim.Model:
    """Return the model: all inputs to the largest temperature rise of the rail [K]."""
    return cosim.Model(
        CASE,
        inputs={name: key for name, (key, _, _) in RANGES.items()},
        outputs=["temperature.rail.max_rise_k"],
        mech={"resolution": 20},
        motion={"traction_coefficient": None, "creepage": {"xi": -0.0086}},
        **options,
    )


def problem(ranges: Mapping[str, tuple[str, float, float]]) -> dict[str, Any]:
    """Return the ranges as SALib wants them."""
    bounds = [list(ends) for _, *ends in ranges.values()]
    return {"num_vars": len(ranges), "names": list(ranges), "bounds": bounds}


def indices(
    model: cosim.Model, ranges: Mapping[str, tuple[str, float, float]], samples: int
) -> tuple[Indices, Array]:
    """Return first-order and total indices with 95 % intervals (S1, ST, S1_conf, ST_conf), and the
    rises.

    Takes samples × (inputs + 2) points; `samples` is a power of two.
    """
    asked = problem(ranges)
    points = sample.sample(asked, samples, calc_second_order=False, seed=1)
    rises = model(points)[:, 0]
    if model.failures:
        raise RuntimeError(f"{len(model.failures)} points failed: {model.failures[0].reason}")
    found = analyse.analyze(asked, rises, calc_second_order=False, seed=1)
    return found, rises


def table(found: Indices) -> str:
    """Return the indices with their intervals as a table, the largest first."""
    lines = [f"{'input':26}total          first order"]
    names = np.array(list(RANGES))
    for n in np.argsort(-found["ST"]):
        total, first = (
            f"{found[key][n]:.3f} ± {found[f'{key}_conf'][n]:.3f}" for key in ("ST", "S1")
        )
        lines.append(f"{names[n]:26}{total}  {first}")
    lines.append(f"sum of the first order: {found['S1'].sum():.2f}")
    return "\n".join(lines)


def draw(found: Indices, rises: Array) -> Figure:
    """Draw the indices as bars, and the distribution of the rise."""
    from matplotlib import pyplot  # noqa: PLC0415

    order = np.argsort(found["ST"])
    places = np.arange(len(order))
    figure, (left, right) = pyplot.subplots(
        1, 2, figsize=(10.0, 4.2), width_ratios=(3, 2), layout="constrained"
    )
    for key, shift, words in (("ST", 0.19, "total"), ("S1", -0.19, "first order")):
        bars = {"height": 0.36, "capsize": 2.0, "label": words}
        left.barh(places + shift, found[key][order], xerr=found[f"{key}_conf"][order], **bars)
    left.set_yticks(places, np.array(list(RANGES))[order])
    left.set(
        xlabel="Sobol' index of the rail's peak temperature, with 95 % interval", xlim=(0, None)
    )
    left.legend(loc="lower right", frameon=False)
    right.hist(rises, bins=40, color="0.6", density=True)
    right.set_ylim(0.0, 1.15 * right.get_ylim()[1])
    low, middle, high = np.percentile(rises, [2.5, 50.0, 97.5])
    for value in (low, middle, high):
        right.axvline(value, color="tab:red", lw=1.0)
        right.text(value, 0.98 * right.get_ylim()[1], f" {value:.0f} K", color="tab:red", va="top")
    right.set(xlabel="largest temperature rise of the rail [K]", yticks=[])
    right.set_title("2.5, 50 and 97.5 % of all points", fontsize="medium")
    return figure


def plot(found: Indices, rises: Array, path: Path) -> None:
    """Write the figure of `draw` to a file; needs no display."""
    import matplotlib  # noqa: PLC0415

    matplotlib.use("Agg")
    draw(found, rises).savefig(path, dpi=110)


def main() -> None:
    """Print the indices, the largest first."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--plot", type=Path)
    asked = parser.parse_args()
    with peak_temperature() as model:
        found, rises = indices(model, RANGES, asked.samples)
    print(f"{len(rises)} points, rise {rises.mean():.1f} K ± {rises.std():.1f} K")
    print(table(found))
    if asked.plot:
        plot(found, rises, asked.plot)


if __name__ == "__main__":
    main()
