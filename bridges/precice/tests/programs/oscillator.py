"""Two masses between two walls, held by three springs; see oscillator.c for the equations."""

import csv
import math
import sys

import precice


def step(state, dt, stiffness, force):
    """Returns the state one step later, given the force at its end: Newmark's method."""
    time, displacement, velocity, acceleration = state
    predicted = displacement + dt * velocity + dt * dt / 4 * acceleration
    after = (force - stiffness * predicted) / (1 + dt * dt / 4 * stiffness)
    return (
        time + dt,
        predicted + dt * dt / 4 * after,
        velocity + dt / 2 * (acceleration + after),
        after,
    )


def main(name, configuration, output, substeps="1"):
    other = {"Left": "Right", "Right": "Left"}[name]
    mesh, writes, reads = f"{name}-Mesh", f"Force-{name}", f"Force-{other}"
    substeps = int(substeps)
    middle = 6 * math.pi * math.pi
    stiffness = 4 * math.pi * math.pi + middle

    participant = precice.Participant(name, configuration, 0, 1)
    vertices = participant.set_mesh_vertices(mesh, [[0.0, 0.0]])
    displacement = 1.0 if name == "Left" else 0.0
    if participant.requires_initial_data():
        participant.write_data(mesh, writes, vertices, [middle * displacement])
    participant.initialize()

    force = participant.read_data(mesh, reads, vertices, 0.0)[0]
    state = saved = (0.0, displacement, 0.0, force - stiffness * displacement)
    rows = [[*state[:3], 0]]
    substep, iterations = 0, 1
    while participant.is_coupling_ongoing():
        if participant.requires_writing_checkpoint():
            saved = state
        rest = participant.get_max_time_step_size()
        if substep == 0:
            dt = rest / substeps
        elif substep == substeps - 1:
            dt = rest
        force = participant.read_data(mesh, reads, vertices, dt)[0]
        state = step(state, dt, stiffness, force)
        participant.write_data(mesh, writes, vertices, [middle * state[1]])
        participant.advance(dt)
        substep = (substep + 1) % substeps
        if participant.requires_reading_checkpoint():
            state = saved
            iterations += 1
        elif participant.is_time_window_complete():
            rows.append([*state[:3], iterations])
            iterations = 1
    participant.finalize()

    with open(output, "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["time", "displacement", "velocity", "iterations"])
        table.writerows(rows)


if __name__ == "__main__":
    if not 4 <= len(sys.argv) <= 5:
        sys.exit("usage: oscillator.py Left|Right CONFIGURATION OUTPUT [SUBSTEPS]")
    main(*sys.argv[1:])
