"""Heat conduction normal to the surface under a moving contact: the numerics.

# Equation

A column of material passes under the contact at the surface speed V and conducts heat along z only
(Péclet number Va/(2κ) ≫ 1). With the flux q [W/m²] into the body, its effusivity β = √(λρc) and
diffusivity κ, the rise at the distance z from the surface is, by Duhamel's principle (Carslaw &
Jaeger, Conduction of Heat in Solids, 2.9),

    T(x, z, t) = 1/(β√π) ∫₀^∞ q(x + s(τ), t − τ) exp(−c²/τ) dτ/√τ,   c = z/(2√κ),   s(τ) = ∫₀^τ V.

τ is the age: a time τ ago, the material now at x was at x + s, upstream (x points in the rolling
direction and material enters at large x). In steady motion s = Vτ, and on the surface this is the
Abel integral 1/(β√(πV)) ∫ₓ^∞ q(x′) dx′/√(x′ − x).

# Discretisation

The input flux is averaged over elements and windows and is assumed constant over each. The kernel
is integrated exactly over every interval of age: with

    J(τ, c) = ∫₀^τ exp(−c²/τ′) dτ′/√τ′ = 2√τ exp(−c²/τ) − 2c√π erfc(c/√τ),

the element k elements upstream, in which an element centre was between the ages τ₁ and τ₂, has the
weight w_k = J(τ₂, c) − J(τ₁, c), and T_i = 1/(β√π) Σ_k w_k q_{i+k}. In steady motion the ages are
(k ∓ ½)h/V, at least 0, and √(h/V) is a common factor of the weights. The weights are the same for
every point, so that each window is one convolution of all rows. It is computed by FFT in steady
motion and directly in transient motion, where a window crosses only a few elements.

# Errors

The method is exact, to rounding, for a flux that is constant over elements. The slope q′ of a
smooth flux inside the elements is neglected. Near the point, where the kernel is singular, this
causes an error of order 1.5 in the element length h: 2ζ(−½, ½) = 0.12178 times q′h^1.5/(β√(πV)),
with Hurwitz's ζ, where q′ is the slope upstream (summation by parts against ∫√s ds). The
participant `thermal-solver` reconstructs a parabola in every element and is of order 2.5.

Past windows are merged while their total duration is at most h/V and at most a quarter of their
age. This bounds the memory for windows of any length. Heat and path are preserved.

Pairs are ordered upper, lower. Units are SI.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cosim import Array

#: Merged windows last at most this fraction of their age.
PART_OF_AGE = 0.25


@dataclass(frozen=True)
class Material:
    """Thermal properties of a body, independent of temperature."""

    density: float
    """[kg/m³]"""
    specific_heat: float
    """[J/(kg K)]"""
    conductivity: float
    """[W/(m K)]"""

    @property
    def diffusivity(self) -> float:
        """κ = λ/(ρc) [m²/s]."""
        return self.conductivity / (self.density * self.specific_heat)

    @property
    def effusivity(self) -> float:
        """β = √(λρc) [J/(m² K √s)]."""
        return math.sqrt(self.conductivity * self.density * self.specific_heat)

    @property
    def amplitude(self) -> float:
        """1/(β√π) [m² K √s/J]."""
        return 1.0 / (self.effusivity * math.sqrt(math.pi))


_erfc = np.vectorize(math.erfc, otypes=[np.float64])


def kernel(age: Array, depth: float = 0.0) -> Array:
    """Return J(τ, c) [√s] at ages τ ≥ 0 [s] and depth c [√s]."""
    root = np.sqrt(age)
    if depth == 0.0:
        return np.asarray(2.0 * root)
    with np.errstate(divide="ignore"):
        ratio = np.where(age > 0.0, depth / root, np.inf)
    decay = np.exp(-ratio * ratio)
    return np.asarray(2.0 * root * decay - 2.0 * depth * math.sqrt(math.pi) * _erfc(ratio))


class SteadyConvolution:
    """Steady surface convolution of rows of `columns` elements, each passed in unit time.

    Computed in Fourier space. The rise of a body [K] is (share)·amplitude·√(h/V) times the result.
    """

    def __init__(self, columns: int) -> None:
        self._length = fast_length(2 * columns)
        edges = np.maximum(np.arange(columns + 1) - 0.5, 0.0)
        # A correlation, because the weights run upstream.
        self._weights = np.fft.rfft(np.diff(kernel(edges)), self._length).conj()

    def __call__(self, flux: Array) -> Array:
        """Return Σ_k w_k q_{i+k} for the rows of `flux`; both arrays have shape (rows, columns)."""
        columns = flux.shape[1]
        spectrum = np.fft.rfft(flux, self._length, axis=1)
        spectrum *= self._weights
        rise = np.fft.irfft(spectrum, self._length, axis=1)[:, :columns]
        # Transforms spread rounding errors over the row; the rise ahead of all heat is
        # zero by causality.
        heated = flux != 0.0
        last = np.where(heated.any(axis=1), columns - heated[:, ::-1].argmax(axis=1), 0)
        rise[np.arange(columns) >= last[:, None]] = 0.0
        return np.asarray(rise)


def fast_length(least: int) -> int:
    """Return the smallest 2^a 3^b 5^c that is at least `least`."""
    best = 1 << (least - 1).bit_length()
    five = 1
    while five < best:
        three = five
        while three < best:
            quotient = -(-least // three)
            best = min(best, three << max(quotient - 1, 0).bit_length())
            three *= 3
        five *= 5
    return best


@dataclass(frozen=True)
class Window:
    """A time interval with the mean flux of the interface and its distribution over the bodies."""

    duration: float
    """[s]; infinite in steady motion."""
    speeds: tuple[float, float]
    """Surface speeds [m/s]."""
    shares: tuple[float, float]
    """Shares of the heat [-]."""
    flux: Array
    """Element means [W/m²], shape (rows, columns)."""

    def merged(self, older: Window) -> Window:
        """Merge this window with an older one; duration, path, and heat of each body are
        preserved."""
        duration = self.duration + older.duration
        parts = self.duration / duration, older.duration / duration
        heats = [
            max(abs(float(w.flux.sum())), np.finfo(float).tiny) * w.duration for w in (self, older)
        ]
        speeds = [parts[0] * a + parts[1] * b for a, b in zip(self.speeds, older.speeds)]
        shares = [np.average(pair, weights=heats) for pair in zip(self.shares, older.shares)]
        return Window(
            duration,
            (speeds[0], speeds[1]),
            (float(shares[0]), float(shares[1])),
            parts[0] * self.flux + parts[1] * older.flux,
        )


def crossings(
    duration: float, begin: float, passed: float, rate: float, columns: int, place: float = 0.5
) -> tuple[int, Array]:
    """Divide the past of a window into pieces: the first element upstream, and the ages at their
    ends.

    The window begins (looking back) at the age `begin` [s], when the material was `passed` elements
    upstream, and moves `rate` elements per second. `place` ∈ [0, 1] is the position of the point in
    its element, along x.
    """
    end = min(passed + rate * duration, columns + 1.0)
    first, last = math.floor(passed + place), math.ceil(end + place)
    edges = np.arange(first + 1, last) - place
    inner = begin + (edges - passed) / rate
    stop = begin + (end - passed) / rate
    return first, np.concatenate(([begin], inner, [stop]))


def past_weights(
    windows: list[Window], body: int, h: float, columns: int, depth: float = 0.0, place: float = 0.5
) -> list[tuple[int, Array]]:
    """Return first element upstream and weights [√s] of each window, newest first."""
    begin, passed, parts = 0.0, 0.0, []
    for window in windows:
        if passed >= columns:
            break
        rate = window.speeds[body] / h
        first, ages = crossings(window.duration, begin, passed, rate, columns, place)
        parts.append((first, window.shares[body] * np.diff(kernel(ages, depth))))
        begin, passed = begin + window.duration, passed + rate * window.duration
    return parts


def accumulate(rise: Array, flux: Array, first: int, weights: Array) -> None:
    """Add Σ_k w_k q_{i+first+k} to every point of rows of shape (..., columns)."""
    columns = flux.shape[-1]
    for upstream, weight in enumerate(weights, first):
        if upstream >= columns:
            break
        rise[..., : columns - upstream] += weight * flux[..., upstream:]


def merge(windows: list[Window], h: float, columns: int) -> list[Window]:
    """Return the windows, newest first, with old short ones merged and those beyond the grid
    dropped."""
    slowest = min(windows[0].speeds)
    kept, age = [windows[0]], windows[0].duration
    for window in windows[1:]:
        if age * slowest > 2.0 * columns * h:
            break
        newest_age = age - kept[-1].duration
        together = kept[-1].duration + window.duration
        bound = min(h / slowest, PART_OF_AGE * newest_age)
        if len(kept) > 1 and together <= bound:
            kept[-1] = kept[-1].merged(window)
        else:
            kept.append(window)
        age += window.duration
    return kept
