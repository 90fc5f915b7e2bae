"""Probability that the rail exceeds 600 °C under a locked wheel.

    python3 probability.py [--samples 1000] [--plot probability.png]

First-order reliability (FORM) finds the most likely point of failure. Importance sampling around
this point gives the probability with its confidence interval. docs/how-to/probability.md explains
both.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import lognorm, norm

import cosim
from cosim import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CASE = Path(__file__).resolve().parents[3] / "cases" / "locked-wheel.toml"
LIMIT_K = 580.0
"""Rise from 20 °C to 600 °C."""
INPUTS = {
    "friction coefficient": ("friction.coefficient", lognorm(s=0.15, scale=0.07)),
    "load [kN]": ("load.normal_force [kN]", norm(20.0, 1.6)),
    "speed [m/s]": ("motion.speed", norm(5.0, 0.5)),
    "conductivity [W/(m K)]": ("materials.steel.conductivity", norm(50.0, 2.5)),
}
"""Uncertain inputs with keys and distributions, independent of each other."""
DISTRIBUTIONS = [one for _, one in INPUTS.values()]


@dataclass(frozen=True)
class DesignPoint:
    """The most likely point of failure, in standard normal variables and in inputs, and its
    distance β."""

    normal: Array
    physical: Array
    beta: float

    @property
    def probability(self) -> float:
        """Probability by the tangent plane at this point."""
        return float(norm.cdf(-self.beta))

    @property
    def shares(self) -> Array:
        """Share of each input in β²."""
        return (self.normal / self.beta) ** 2


@dataclass(frozen=True)
class Probability:
    """A probability with its standard error, and the sample behind it."""

    value: float
    error: float
    points: Array
    failed: NDArray[np.bool_]

    def interval(self, level: float = 0.95) -> tuple[float, float]:
        """Return the confidence interval."""
        half = float(norm.ppf(0.5 + 0.5 * level)) * self.error
        return self.value - half, self.value + half

    @property
    def plain_points(self) -> float:
        """Points of a plain Monte Carlo sample with the same interval."""
        return (1.0 - self.value) * self.value / self.error**2


def rail_rise(**options: Any) -> cosim.Model:
    """Return the model: all inputs to the largest rise of the rail after 3 ms [K]."""
    return cosim.Model(
        CASE,
        inputs={name: key for name, (key, _) in INPUTS.items()},
        outputs=["temperature.rail.max_rise_k"],
        time={"window": "0.3 ms", "end": "3 ms"},
        # Half of the heat enters the rail, by conduction normal to the surface.
        effects={"friction_heat": {"partition": "equal"}},
        thermal={"model": "columns"},
        **options,
    )


def physical(distributions: Sequence[Any], normal: Array) -> Array:
    """Return inputs (…, d) from independent standard normal variables of the same shape."""
    chances = norm.cdf(normal)
    columns = [one.ppf(chances[..., n]) for n, one in enumerate(distributions)]
    return np.stack(columns, axis=-1)


def design_point(
    model: cosim.Model, distributions: Sequence[Any], limit: float, most: int = 20
) -> DesignPoint:
    """Find the point of failure nearest to the origin, by the steps of Hasofer, Lind, Rackwitz and
    Fiessler."""
    normal = np.zeros(len(distributions))
    for _ in range(most):
        at = physical(distributions, normal)
        # dx/du of each input: the ratio of both densities.
        stretch = np.array(
            [norm.pdf(u) / one.pdf(x) for one, u, x in zip(distributions, normal, at)]
        )
        slope = model.gradient(at) * stretch
        short = limit - model(at)[0]
        stepped = slope * (short + slope @ normal) / (slope @ slope)
        done = np.linalg.norm(stepped - normal) < 1e-3
        normal = stepped
        if done:
            return DesignPoint(
                normal, physical(distributions, normal), float(np.linalg.norm(normal))
            )
    raise RuntimeError(f"no point of failure after {most} steps")


def importance_sampling(
    model: cosim.Model,
    distributions: Sequence[Any],
    limit: float,
    around: Array,
    samples: int,
    random: np.random.Generator,
) -> Probability:
    """Estimate the probability from points around the most likely point of failure.

    Each failure counts by the ratio of its density to the one it was drawn from.
    """
    points = random.normal(around, 1.0, (samples, len(around)))
    rises = model(physical(distributions, points))[:, 0]
    if model.failures:
        raise RuntimeError(f"{len(model.failures)} points failed: {model.failures[0].reason}")
    failed = rises > limit
    weights = np.exp(0.5 * around @ around - points @ around) * failed
    error = float(weights.std(ddof=1)) / np.sqrt(samples)
    return Probability(float(weights.mean()), error, points, failed)


def summary(form: DesignPoint) -> str:
    """Return the most likely point of failure in words: inputs, shares of the inputs, and
    probability."""
    place = ", ".join(f"{name} {x:.3g}" for name, x in zip(INPUTS, form.physical))
    shares = ", ".join(f"{name} {one:.0%}" for name, one in zip(INPUTS, form.shares))
    return (
        f"most likely: {place}\n"
        f"FORM: beta {form.beta:.2f}, probability {form.probability:.2e}\n"
        f"shares: {shares}"
    )


def draw(form: DesignPoint, found: Probability) -> Figure:
    """Draw the sample in the plane of friction and load, and the estimate over the sample size."""
    from matplotlib import pyplot  # noqa: PLC0415

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10.0, 4.2), layout="constrained")
    usual = physical(DISTRIBUTIONS, np.random.default_rng(0).normal(size=(2000, len(INPUTS))))
    left.plot(*usual[:, :2].T, ".", ms=4.0, color="0.85", mew=0.0, label="inputs as they occur")
    places = physical(DISTRIBUTIONS, found.points)[:, :2]
    for failed, colour, words in ((False, "tab:blue", "below 600 °C"), (True, "tab:red", "above")):
        chosen = places[found.failed == failed]
        left.plot(*chosen.T, ".", ms=5.0, mew=0.0, color=colour, label=f"sample, {words}")
    left.plot(*form.physical[:2], "k*", ms=11.0, label="most likely point of failure")
    names = list(INPUTS)
    left.set(xlabel=names[0], ylabel=names[1])
    left.legend(fontsize="small", loc="lower right")
    weights = np.exp(0.5 * form.beta**2 - found.points @ form.normal) * found.failed
    count = np.arange(1, len(weights) + 1)
    mean = np.cumsum(weights) / count
    spread = np.sqrt(np.maximum(np.cumsum(weights**2) / count - mean**2, 0.0) / count)
    shown = count >= 20
    band = (mean - 1.96 * spread)[shown], (mean + 1.96 * spread)[shown]
    right.fill_between(count[shown], *band, alpha=0.3, lw=0.0, label="95 % interval")
    right.plot(count[shown], mean[shown], label="importance sampling")
    right.axhline(form.probability, color="k", ls="--", lw=1.0, label="FORM")
    right.set(
        xlabel="points of the sample", ylabel="probability of more than 600 °C", ylim=(0, None)
    )
    right.legend(frameon=False)
    return figure


def plot(form: DesignPoint, found: Probability, path: Path) -> None:
    """Write the figure of `draw` to a file; needs no display."""
    import matplotlib  # noqa: PLC0415

    matplotlib.use("Agg")
    draw(form, found).savefig(path, dpi=110)


def main() -> None:
    """Print the most likely point of failure and the probability with its interval."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--samples", type=int, default=1000)
    parser.add_argument("--plot", type=Path)
    asked = parser.parse_args()
    with rail_rise() as model:
        form = design_point(model, DISTRIBUTIONS, LIMIT_K)
        print(f"{summary(form)}\n{model.runs} runs for FORM")
        random = np.random.default_rng(1)
        found = importance_sampling(
            model, DISTRIBUTIONS, LIMIT_K, form.normal, asked.samples, random
        )
        low, high = found.interval()
        print(f"probability {found.value:.2e}, 95 % interval {low:.2e} to {high:.2e}")
        plain = f"{found.plain_points:.1e}"
        print(f"{model.runs} runs; plain Monte Carlo needs {plain} for the same interval")
        if asked.plot:
            plot(form, found, asked.plot)


if __name__ == "__main__":
    main()
