"""Checks the finite elements of `moving_body` against closed forms, on three meshes."""

import math

import numpy as np
from conduction import Material, SteadyConvolution
from moving_body import MovingBody

from cosim import Structured

STEEL = Material(7850.0, 419.5, 50.0)
#: Half the length of the patch [m], and the flux at its centre [W/m²].
A, HEAT = 8e-3, 2e8
#: Elements along the patch, and layers in depth.
MESHES = ((8, 6), (16, 12), (32, 24))


def flux(x, y):
    """[W/m²]"""
    bump = [np.clip(1.0 - (place / A) ** 2, 0.0, None) ** 2 for place in (x, y)]
    return HEAT * bump[0] * bump[1]


def patch(n):
    """Return n × n elements on the patch, their centres, and their mean fluxes (to fourth
    order)."""
    h = 2.0 * A / n
    plane = Structured.contact_plane(-A + h / 2, -A + h / 2, h, h, n, n)
    x, y = np.meshgrid(plane.x, plane.y)
    off = h / math.sqrt(12.0)
    means = np.mean([flux(x + p, y + q) for p in (-off, off) for q in (-off, off)], axis=0)
    return plane, x, y, means


def source(speed, x, y):
    """T = 1/(2πλ) ∫∫ q exp(−V (r + x − x')/(2κ)) dr dθ, in polar coordinates round the point."""
    decay = speed / (2.0 * STEEL.diffusivity)
    nodes, weights = np.polynomial.legendre.leggauss(240)
    angle, along = np.pi * (nodes + 1.0), math.sqrt(2.0) * A * (nodes + 1.0)
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    # x' = x + r cos θ is upstream where cos θ > 0; heat from there arrives.
    kernel = flux(x + along * c, y + along * s) * np.exp(-decay * along * (1.0 - c))
    integral = np.pi * math.sqrt(2.0) * A * (weights @ kernel @ weights)
    return integral / (2.0 * np.pi * STEEL.conductivity)


def orders(errors):
    return np.log2(np.array(errors[:-1]) / errors[1:])


def test_second_order_where_heat_flows_in_every_direction():
    speed = 2.0 * STEEL.diffusivity * 20.0 / A  # Péclet number 20
    errors = []
    for n, layers in MESHES:
        plane, x, y, means = patch(n)
        rise = MovingBody(STEEL, speed, plane, layers).rise(means)
        row = n // 2
        exact = [source(speed, x[row, i], y[row, i]) for i in range(n)]
        errors.append(float(np.abs(rise[row] - exact).max() / max(exact)))
    # The largest error of the coarsest mesh is 8 % of the peak.
    assert (orders(errors) > 1.8).all() and errors[-1] < 0.006, errors


def test_second_order_at_the_speed_of_a_wheel():
    """Compares with one-dimensional conduction into the depth; conduction across is 1e-4 of
    that."""
    speed = 38.889
    errors = []
    for n, layers in MESHES:
        plane, _, _, means = patch(n)
        rise = MovingBody(STEEL, speed, plane, layers).rise(means)
        row = n // 2
        fine = flux(np.linspace(-A, A, 40 * n, endpoint=False) + A / (40 * n), plane.y[row])
        exact = SteadyConvolution(40 * n)(fine[None])[0]
        exact *= STEEL.amplitude * math.sqrt(2.0 * A / (40 * n) / speed)
        middles = 0.5 * (exact[19::40] + exact[20::40])
        errors.append(float(np.abs(rise[row] - middles).max() / exact.max()))
    assert (orders(errors) > 1.8).all() and errors[-1] < 0.006, errors
