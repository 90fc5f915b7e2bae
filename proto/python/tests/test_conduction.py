"""Checks the numerics of `strip_columns` against closed forms."""

import math

import numpy as np
import pytest
from conduction import (
    Material,
    SteadyConvolution,
    Window,
    accumulate,
    fast_length,
    kernel,
    merge,
    past_weights,
)

STEEL = Material(7850.0, 419.5, 50.0)


def steady(flux, h):
    """T β√(πV) on a row of elements of length h."""
    return SteadyConvolution(len(flux))(flux[None, :])[0] * math.sqrt(h)


def transient(windows, h, columns, depth=0.0):
    rise = np.zeros((1, columns))
    for window, (first, weights) in zip(windows, past_weights(windows, 0, h, columns, depth)):
        accumulate(rise, window.flux, first, weights)
    return rise[0]


def test_scales_of_steel():
    # The paper's effusivity, corrected, to its printed digits.
    assert round(STEEL.effusivity) == 12832


def test_a_uniform_flux_is_exact():
    n, h = 300, 1e-4
    flux = np.zeros(n)
    flux[20:250] = 3.0
    behind = (249.5 - np.arange(n)) * h
    exact = 6.0 * (np.sqrt(np.maximum(behind, 0)) - np.sqrt(np.maximum(behind - 230 * h, 0)))
    # Rounding of transforms, relative to the largest value.
    assert np.abs(steady(flux, h) - exact).max() < 1e-14 * exact.max()
    assert (steady(flux, h)[250:] == 0.0).all()


def ellipse_means(n):
    """Means of √(1 − x²) over n elements of [−1, 1], and their length."""
    edges = np.linspace(-1.0, 1.0, n + 1)
    primitive = 0.5 * (edges * np.sqrt(1.0 - edges**2) + np.arcsin(edges))
    return np.diff(primitive) * n / 2.0, 2.0 / n


def test_order_on_an_ellipse():
    # max of ∫ √(1−x²) dx/√(x−ξ) is 2.18830667 (docs/theory/columns.md).
    meshes = (40, 80, 160, 320)
    errors = [abs(steady(*ellipse_means(n)).max() / 2.18830667 - 1.0) for n in meshes]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    # Order 1.5 is expected where the slope of the flux does not vanish; finding the maximum at
    # centres only is of order 2.
    # centres only, which alone is of order 2.
    assert errors[1] < 2e-3
    assert (orders > 1.3).all(), orders


def test_the_leading_error_of_a_ramp_is_that_of_zeta():
    """2ζ(−½, ½) q′h^1.5, the constant stated in the module's documentation."""
    n = 4096
    for h in (1.0, 0.25):
        flux = (np.arange(n) + 0.5)[::-1] * h
        lengths = flux  # from each centre to the upstream end
        # ∫₀^L (L − s) ds/√s = 4/3 L^1.5, and the ramp falls upstream: q′ = −1.
        error = 4.0 / 3.0 * lengths**1.5 - steady(flux, h)
        constant = 2.0 * (math.sqrt(0.5) - 1.0) * -0.2078862249773546
        # The correction of the far end falls like L^−½.
        assert error[0] == pytest.approx(-constant * h**1.5, rel=2e-2)


def test_transient_windows_add_up_to_the_steady_field():
    n, h, speed = 60, 2e-4, 30.0
    rng = np.random.default_rng(1)
    flux = rng.random((1, n))
    unit = SteadyConvolution(n)(flux)[0] * math.sqrt(h / speed)
    for duration in (1e-7, 3e-6, 1e-4, 1.0):
        count = math.ceil(2.0 * n * h / speed / duration)
        count = min(count, 400)
        windows = [Window(duration, (speed, speed), (1.0, 1.0), flux)] * count
        passed = int(count * duration * speed / h)
        rise = transient(windows, h, n)
        # Points whose heat arrived within the windows only; rounding of sums of many roots.
        known = slice(max(n - passed, 0), n) if passed < n else slice(0, n)
        assert np.allclose(rise[known], unit[known], rtol=1e-11)
        assert (rise <= unit * (1.0 + 1e-11)).all()


def test_a_suddenly_heated_half_space():
    """2q√(t/π)/β, and in depth q√t ierfc, before any material has left the flux."""
    n, h, time = 40, 1.0, 0.3
    windows = [Window(time / 3.0, (1.0, 1.0), (1.0, 1.0), np.ones((1, n)))] * 3
    assert transient(windows, h, n)[:39] == pytest.approx(2.0 * math.sqrt(time), rel=1e-14)
    depth = 0.2
    ratio = depth / math.sqrt(time)
    ierfc = math.exp(-(ratio**2)) / math.sqrt(math.pi) - ratio * math.erfc(ratio)
    exact = 2.0 * math.sqrt(math.pi * time) * ierfc
    assert transient(windows, h, n, depth)[:39] == pytest.approx(exact, rel=1e-13)


def test_the_kernel_is_the_integral():
    """Compares with Gauss quadrature in √τ, on panels that are fine where e^(−c²/τ) becomes
    large."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    for depth in (0.0, 0.01, 0.5, 2.0):
        for age in (0.1, 1.0, 50.0):
            edges = np.concatenate(([0.0], math.sqrt(age) * 0.7 ** np.arange(80)[::-1]))
            middles, halves = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
            u = middles[:, None] + halves[:, None] * nodes
            slow = (2.0 * np.exp(-((depth / u) ** 2)) @ weights) @ halves
            # Rounding, relative to the surface value, since deep values are small differences.
            assert abs(kernel(np.array(age), depth) - slow) < 1e-13 * 2.0 * math.sqrt(age)


def test_merging_keeps_time_path_and_heat_and_bounds_the_number():
    n, h, speed = 50, 1e-4, 20.0
    rng = np.random.default_rng(2)
    windows: list[Window] = []
    everything: list[Window] = []
    for step in range(4000):
        speeds = (speed * (1 + 1e-3 * (step % 3)), speed)
        newest = Window(2e-7, speeds, (0.5, 0.5), rng.random((1, n)))
        windows = merge([newest, *windows], h, n)
        everything.insert(0, newest)
        assert windows[0] is newest
        # 500 windows are a fifth of the windows to remember.
        if step == 500:
            for read in (
                lambda w: 1.0,
                lambda w: w.speeds[0],
                lambda w: w.shares[1] * w.flux.sum(),
            ):
                kept, plain = (
                    sum(w.duration * read(w) for w in some) for some in (windows, everything)
                )
                # Rounding of sums of five hundred terms.
                assert kept == pytest.approx(plain, rel=1e-13)
    # Two windows per element of the grid's passage, which is kept twice over, and eight per factor
    # of two.
    assert len(windows) <= 2 * 2 * n + 8 * math.log2(h / speed / 2e-7)


def test_lengths_of_transforms():
    lengths = {2**a * 3**b * 5**c for a in range(12) for b in range(8) for c in range(6)}
    for least in range(1, 700):
        assert fast_length(least) == min(length for length in lengths if length >= least)
