"""Fits the friction coefficient and the flexibility of a third-body layer to a creep curve.

    python3 fit_creep_curve.py [--seeds 20] [--plot fit.png]

The measured forces are synthetic: those of the model with known parameters, plus normal noise of a
known standard deviation. For each seed the noise is drawn again, and the fit must contain the known
parameters in its joint confidence region. docs/how-to/fit-to-measurements.md describes the method.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import chi2, norm

import cosim
from cosim import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CASE = Path(__file__).resolve().parents[3] / "cases" / "third-body.toml"
CREEPAGES = -1e-3 * np.array([0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0])
"""Creepages of the measured points; negative drives."""
NOISE_N = 600.0
"""Standard deviation of a measured force [N]: 1 % of the largest one."""
TRUE = np.array([0.45, 0.02])
"""Parameters behind the synthetic data: friction coefficient [1], flexibility [µm/MPa]."""
START = np.array([0.30, 0.01])
LEAST, LARGEST = [0.05, 0.001], [1.0, 0.2]
LEVEL = 0.999
"""Level of the joint confidence region: all of 20 seeds lie inside with a probability of 0.98."""


@dataclass(frozen=True)
class Fit:
    """Parameters of a fit, their covariance, and the weighted sum of squares."""

    parameters: Array
    covariance: Array
    squares: float

    def interval(self, level: float = 0.95) -> Array:
        """Return half the width of the confidence interval of each parameter."""
        width: Array = norm.ppf(0.5 + 0.5 * level) * np.sqrt(np.diag(self.covariance))
        return width

    def distance(self, other: Array) -> float:
        """Return the squared distance of other parameters, which has a chi-squared distribution."""
        away = other - self.parameters
        return float(away @ np.linalg.solve(self.covariance, away))


def creep_curve(creepages: Array = CREEPAGES, **options: Any) -> cosim.Model:
    """Return the model: friction and flexibility to the forces at creepages [N]."""
    return cosim.Model(
        CASE,
        inputs={
            "friction": "friction.coefficient",
            "flexibility": "effects.third_body_layer.flexibility [um/MPa]",
        },
        outputs=["contact.creep_force_x_n"],
        conditions={"motion.creepage.xi": creepages},
        mech={"resolution": 10},
        motion={"traction_coefficient": None, "creepage": {"xi": creepages[0]}},
        # Forces need no temperatures.
        thermal=None,
        effects={"friction_heat": None},
        **options,
    )


def measure(model: cosim.Model, seed: int) -> Array:
    """Return synthetic measurements: the model with the true parameters, and noise."""
    noise = np.random.default_rng(seed).normal(0.0, NOISE_N, len(CREEPAGES))
    measured: Array = model(TRUE) + noise
    return measured


def fit(model: cosim.Model, measured: Array) -> Fit:
    """Fit the parameters by weighted least squares; the noise is known."""
    found = least_squares(
        lambda p: (model(p) - measured) / NOISE_N,
        START,
        jac=lambda p: model.jacobian(p) / NOISE_N,
        bounds=(LEAST, LARGEST),
        x_scale="jac",
        ftol=1e-6,
        xtol=1e-5,
    )
    if not found.success:
        raise RuntimeError(found.message)
    covariance = np.linalg.inv(found.jac.T @ found.jac)
    return Fit(found.x, covariance, 2.0 * found.cost)


def summary(found: Fit) -> str:
    """Return a fit in words: parameters with intervals, their correlation, and chi-squared."""
    names = ("friction coefficient", "flexibility [µm/MPa]")
    lines = [
        f"{name:21}{value:.4f} ± {half:.4f} (95 %), true {true}"
        for name, value, half, true in zip(names, found.parameters, found.interval(), TRUE)
    ]
    correlation = found.covariance[0, 1] / np.sqrt(np.prod(np.diag(found.covariance)))
    freedom = len(CREEPAGES) - len(TRUE)
    lines.append(f"correlation {correlation:.2f}, chi-squared {found.squares:.1f} of {freedom}")
    return "\n".join(lines)


def draw(measured: Array, fits: Sequence[Fit], **options: Any) -> Figure:
    """Draw the first fit with its measurements, and the parameters of all fits.

    The options are those of `creep_curve`, which computes the curves.
    """
    from matplotlib import pyplot  # noqa: PLC0415

    first = fits[0]
    creepages = -1e-3 * np.linspace(0.25, 13.0, 35)
    curve = creep_curve(creepages, **options)
    slopes, forces = curve.jacobian(first.parameters), curve(first.parameters)
    band = norm.ppf(0.975) * np.sqrt(np.einsum("ki,ij,kj->k", slopes, first.covariance, slopes))
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10.0, 4.2), layout="constrained")
    percent = -100.0 * creepages
    edges = (forces - band) / 1e3, (forces + band) / 1e3
    left.fill_between(percent, *edges, alpha=0.35, lw=0.0, label="95 % band of the fit")
    left.plot(percent, forces / 1e3, label="fit")
    left.plot(percent, curve(TRUE) / 1e3, "k--", lw=1.0, label="true parameters")
    bars = {"fmt": "o", "ms": 4.0, "color": "tab:red", "capsize": 2.0}
    half = 1.96 * NOISE_N / 1e3
    left.errorbar(-100.0 * CREEPAGES, measured / 1e3, half, **bars, label="synthetic, ±1.96 σ")
    left.set(xlabel="creepage [%]", ylabel="creep force [kN]", xlim=(0.0, 1.3), ylim=(0.0, None))
    left.legend(loc="lower right", frameon=False)
    angles = np.linspace(0.0, 2.0 * np.pi, 200)
    circle = np.stack([np.cos(angles), np.sin(angles)])
    root = np.linalg.cholesky(first.covariance)
    for level, style in ((0.95, "-"), (LEVEL, ":")):
        edge = first.parameters[:, None] + np.sqrt(chi2.ppf(level, 2)) * root @ circle
        right.plot(*edge, style, color="tab:blue", label=f"joint region, {100.0 * level:g} %")
    right.plot(*first.parameters, "o", color="tab:blue", label="fit of the left plot")
    estimates = np.array([one.parameters for one in fits[1:]]).reshape(-1, 2)
    right.plot(*estimates.T, ".", color="0.55", label=f"fits of {len(estimates)} other seeds")
    right.plot(*TRUE, "k*", ms=11.0, label="true parameters")
    right.set(xlabel="friction coefficient", ylabel="flexibility of the layer [µm/MPa]")
    low, high = right.get_ylim()
    right.set_ylim(low, high + 0.45 * (high - low))
    right.legend(frameon=False, fontsize="small", loc="upper left")
    return figure


def plot(measured: Array, fits: Sequence[Fit], path: Path) -> None:
    """Write the figure of `draw` to a file; needs no display."""
    import matplotlib  # noqa: PLC0415

    matplotlib.use("Agg")
    draw(measured, fits).savefig(path, dpi=110)


def main() -> None:
    """Fit all seeds; print the parameters of the first, and how many regions hold the truth."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--plot", type=Path)
    asked = parser.parse_args()
    with creep_curve() as model:
        fits = [fit(model, measure(model, seed)) for seed in range(asked.seeds)]
        print(summary(fits[0]))
        distances = np.array([one.distance(TRUE) for one in fits])
        inside = int(np.sum(distances < chi2.ppf(LEVEL, 2)))
        print(f"inside the joint {100.0 * LEVEL:g} % region: {inside} of {len(fits)} seeds")
        print(f"mean squared distance {distances.mean():.2f}, expected 2")
        print(f"{model.runs} runs, error for the steps {model.error:.1e}")
        if asked.plot:
            plot(measure(model, 0), fits, asked.plot)


if __name__ == "__main__":
    main()
