"""Heat in one of two bodies in rolling contact, with Nutils, behind preCICE's interface.

    python3 solid.py BODY CONFIGURATION LENGTH DEPTH WIDTH ELEMENTS LAYERS

BODY is the participant in the CONFIGURATION. The body rests in the frame of the program. Its domain
is LENGTH x DEPTH [m], with ELEMENTS elements along the surface and LAYERS below it, finer near the
surface. The program reads the heat at each vertex [W], for a contact of WIDTH [m], and writes the
temperature rise T of the surface [K].

    rho c dT/dt = k (d2T/dx2 + d2T/dz2), T = 0 at t = 0, heat flux through z = 0 only

Linear elements in space, the trapezoidal rule in time.
"""

import sys

import numpy
import precice
from nutils import function, mesh
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu

CONDUCTIVITY = 50.0  # [W/(m K)]
HEAT_CAPACITY = 7850 * 419.5  # per volume [J/(m3 K)]
GRADING = 3.5  # logarithm of the ratio of the deepest layer to the first one, approximately


def matrices(length, depth, elements, layers):
    """Returns the matrices of heat capacity and conduction, the nodes of the surface and their x."""
    shares = numpy.expm1(GRADING * numpy.linspace(0, 1, layers + 1)) / numpy.expm1(GRADING)
    along, below = numpy.linspace(0, length, elements + 1), -depth * shares[::-1]
    domain, place = mesh.rectilinear([along, below])
    basis = domain.basis("std", degree=1)
    gradient = basis.grad(place)
    jacobian = function.J(place)
    capacity, conduction = domain.integrate(
        [
            HEAT_CAPACITY * basis[:, None] * basis[None, :] * jacobian,
            CONDUCTIVITY * (gradient[:, None, :] * gradient[None, :, :]).sum(-1) * jacobian,
        ],
        degree=2,
        legacy=True,
    )
    surface = numpy.arange(elements + 1) * (layers + 1) + layers
    return sparse(capacity), sparse(conduction), surface, along


def sparse(matrix):
    """Returns a matrix of Nutils as one of SciPy."""
    values, columns, rows = matrix.export("csr")
    return csr_array((values, columns, rows))


def main(body, configuration, length, depth, width, elements, layers):
    width = float(width)
    capacity, conduction, surface, along = matrices(
        float(length), float(depth), int(elements), int(layers)
    )
    participant = precice.Participant(body, configuration, 0, 1)
    mesh_name = f"{body}-Surface"
    vertices = participant.set_mesh_vertices(
        mesh_name, numpy.stack([along, numpy.zeros_like(along)], axis=1)
    )
    participant.set_mesh_edges(mesh_name, numpy.stack([vertices[:-1], vertices[1:]], axis=1))
    participant.initialize()

    rise, heat = numpy.zeros(capacity.shape[0]), None
    saved, factors = (rise, heat), {}
    while participant.is_coupling_ongoing():
        if participant.requires_writing_checkpoint():
            saved = rise, heat
        dt = participant.get_max_time_step_size()
        if dt not in factors:
            factors[dt] = splu((capacity / dt + conduction / 2).tocsc())
        before, heat = heat, participant.read_data(mesh_name, f"Heat-{body}", vertices, dt)
        right = capacity @ rise / dt - conduction @ rise / 2
        # Heat begins at once: in the first window there is none before.
        right[surface] += (heat if before is None else (before + heat) / 2) / width
        rise = factors[dt].solve(right)
        participant.write_data(mesh_name, f"Rise-{body}", vertices, rise[surface])
        participant.advance(dt)
        if participant.requires_reading_checkpoint():
            rise, heat = saved
    participant.finalize()


if __name__ == "__main__":
    if len(sys.argv) != 8:
        sys.exit("usage: solid.py BODY CONFIGURATION LENGTH DEPTH WIDTH ELEMENTS LAYERS")
    main(*sys.argv[1:])
