"""Steady heat in a body that moves under a heat flux: finite elements of scikit-fem.

# Equation

In the frame of the contact, material moves at the speed V towards −x and conducts heat in all
directions. With the diffusivity κ = λ/(ρc), the depth z and the heat flux q [W/m²] into the surface

    −V ∂T/∂x = κ ΔT,   −λ ∂T/∂z = q on z = 0.

T is 0 at the inlet and at the bottom. The sides and the outlet are adiabatic.

# Mesh

The elements are trilinear bricks. There is one column of bricks under each element of the flux.
Around the flux, columns grow in size as far as heat spreads: 3.5 √(4κt), where erfc is 7·10⁻⁷, in
the time t in which material crosses the flux, and 10 κ/V against the motion. Layers end at the
depths 3.5 √(4κt) (k/n)².

# Petrov–Galerkin

Material crosses an element far faster than heat spreads along it: V h/(2κ) is 500 for a wheel with
elements of 0.4 mm. Test functions are therefore v − s ∂v/∂x, with s = (h/2)(coth Pe − 1/Pe),
Pe = V h/(2κ) (SUPG; Brooks & Hughes, Comput. Methods Appl. Mech. Eng. 32 (1982) 199-259). The added
part weights the whole residual. In the residual, conduction along x vanishes inside trilinear
bricks, and conduction across x is integrated by parts: s depends only on x, so that ∂v/∂x is
continuous across y and z. A test function is a product of hat functions, for which
∂²v/∂x∂z = (∂v/∂x)(∂v/∂z)/v.

# Solution

Unknowns are ordered downstream, with depth varying fastest. An incomplete factorisation in this
order is nearly exact, and GMRES needs about four iterations to 10⁻¹⁰. Units are SI.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from conduction import Material
from scipy.sparse.linalg import LinearOperator, gmres, spilu
from skfem import (
    Basis,
    BilinearForm,
    ElementHex0,
    ElementHex1,
    FacetBasis,
    LinearForm,
    MeshHex,
)

from cosim import Array, Structured

#: Tolerance of GMRES relative to the right-hand side.
TOLERANCE = 1e-10


class NotSolvedError(Exception):
    """The iteration did not reach its tolerance."""


class MovingBody:
    """One body under the elements of a heat flux, factorised once for any number of fluxes."""

    def __init__(self, material: Material, speed: float, plane: Structured, layers: int) -> None:
        """Set up the body for a speed [m/s] above 0; `plane` has the elements of the flux,
        `layers` is the number of layers in depth."""
        self._shape = (plane.nj, plane.ni)
        self._material = material
        mesh = bricks(material, speed, plane, layers)
        shift = upwind_shift(material, speed, mesh)
        self._order = downstream(mesh)
        basis = Basis(mesh, ElementHex1(), intorder=2)
        shifts = basis.with_element(ElementHex0()).interpolate(shift)
        matrix = transport.assemble(
            basis, shift=shifts, speed=speed, diffusivity=material.diffusivity
        )
        self._matrix = matrix[self._order][:, self._order].tocsc()
        factors = spilu(self._matrix, drop_tol=1e-4, permc_spec="NATURAL")
        self._near = LinearOperator(self._matrix.shape, factors.solve)
        facets = heated(mesh, plane)
        self._corners = mesh.facets[:, facets]
        self._surface = FacetBasis(mesh, ElementHex1(), facets=facets, intorder=2)
        self._shifts = self._surface.with_element(ElementHex0()).interpolate(shift)

    def rise(self, flux: Array) -> Array:
        """Return the temperature rise at element centres [K] for mean fluxes [W/m²], both of shape
        (nj, ni)."""
        heat = np.broadcast_to(flux.reshape(-1, 1), self._surface.dx.shape)
        capacity = self._material.density * self._material.specific_heat
        load = entering.assemble(self._surface, flow=heat / capacity, shift=self._shifts)
        nodes = np.zeros(len(load))
        nodes[self._order], failed = gmres(
            self._matrix, load[self._order], rtol=TOLERANCE, M=self._near, restart=40, maxiter=10
        )
        if failed:
            raise NotSolvedError(f"GMRES did not reach {TOLERANCE:g} in 400 iterations")
        return np.asarray(nodes[self._corners].mean(axis=0).reshape(self._shape))


@BilinearForm
def transport(rise: Any, v: Any, w: Any) -> Any:
    """The equation divided by ρc, weighted by v − s ∂v/∂x."""
    value = -w.speed * rise.grad[0] * (v - w.shift * v.grad[0])
    value = value + w.diffusivity * rise.grad[0] * v.grad[0]
    for across in (1, 2):
        mixed = v.grad[0] * v.grad[across] / v
        value = value + w.diffusivity * rise.grad[across] * (v.grad[across] - w.shift * mixed)
    return value


@LinearForm
def entering(v: Any, w: Any) -> Any:
    """The flux divided by ρc, with the same weight."""
    return w.flow * (v - w.shift * v.grad[0])


def bricks(material: Material, speed: float, plane: Structured, layers: int) -> MeshHex:
    """Return the mesh, with x and y as in the contact plane and z the depth."""
    time = plane.ni * plane.dx / speed
    spread = 3.5 * float(np.sqrt(4.0 * material.diffusivity * time))
    along = 10.0 * material.diffusivity / speed
    x0, y0, _ = plane.origin
    return MeshHex.init_tensor(
        axis(x0, plane.dx, plane.ni, along),
        axis(y0, plane.dy, plane.nj, spread),
        spread * np.linspace(0.0, 1.0, layers + 1) ** 2,
    )


def axis(middle: float, step: float, count: int, beyond: float) -> Array:
    """Return nodes of `count` equal elements, the first one centred on `middle`, and of
    growing elements on both sides."""
    own = middle + step * (np.arange(count + 1) - 0.5)
    lengths = [step]
    while sum(lengths) < beyond:
        lengths.append(1.6 * lengths[-1])
    outside = np.cumsum(lengths)
    return np.concatenate([own[0] - outside[::-1], own, own[-1] + outside])


def upwind_shift(material: Material, speed: float, mesh: MeshHex) -> Array:
    """Return s of every brick [m]."""
    places = mesh.p[0][mesh.t]
    length = places.max(axis=0) - places.min(axis=0)
    peclet = speed * length / (2.0 * material.diffusivity)
    return np.asarray(0.5 * length * (1.0 / np.tanh(peclet) - 1.0 / peclet))


def downstream(mesh: MeshHex) -> Array:
    """Return the free nodes, ordered downstream from the inlet, with depth varying fastest."""
    x, y, z = mesh.p
    order = np.lexsort((z, y, -x))
    return np.asarray(order[(x[order] < x.max()) & (z[order] < z.max())])


def heated(mesh: MeshHex, plane: Structured) -> Array:
    """Return the facets of the surface under the flux, in the order of its elements."""
    top = np.nonzero((mesh.p[2][mesh.facets] == 0.0).all(axis=0))[0]
    x, y = mesh.p[:2, mesh.facets[:, top]].mean(axis=1)
    i = np.rint((x - plane.origin[0]) / plane.dx).astype(int)
    j = np.rint((y - plane.origin[1]) / plane.dy).astype(int)
    inside = (i >= 0) & (i < plane.ni) & (j >= 0) & (j < plane.nj)
    element = j * plane.ni + i
    return np.asarray(top[inside][np.argsort(element[inside])])
