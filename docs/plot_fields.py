"""Draws the fields of a steady result directory: pressure and traction, friction power, rail
temperature on the surface and in depth.

    python3 docs/plot_fields.py results/wheel-rail docs/img/wheel-rail.png

Needs numpy and matplotlib. Reads the .vti files that `coordinator run` writes.
"""

import json
import pathlib
import re
import struct
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np


def read_vti(path):
    """Cell centres along the two axes of the image [mm] and its arrays, by name."""
    raw = pathlib.Path(path).read_bytes()
    head, data = raw.split(b'<AppendedData encoding="raw">\n_', 1)
    head = head.decode()
    numbers = lambda name: [float(v) for v in re.search(f'{name}="([^"]*)"', head)[1].split()]
    cells = np.array(numbers("WholeExtent")[1::2], dtype=int)
    origin, spacing = numbers("Origin"), numbers("Spacing")
    axes = [k for k in range(3) if cells[k] > 0]
    coordinates = [
        1e3 * (origin[k] + spacing[k] * (0.5 + np.arange(cells[k]))) for k in axes
    ]
    arrays = {}
    pattern = r'Name="(\w+) \[[^"]*" NumberOfComponents="(\d)" format="appended" offset="(\d+)"'
    for name, components, offset in re.findall(pattern, head):
        (size,) = struct.unpack_from("<Q", data, int(offset))
        values = np.frombuffer(data, "<f8", size // 8, int(offset) + 8)
        shape = (len(coordinates[1]), len(coordinates[0]), int(components))
        arrays[name] = values.reshape(shape)
    return coordinates, arrays


def main(results, picture):
    results = pathlib.Path(results)
    summary = json.loads((results / "summary.json").read_text())
    contact, rail = summary["contact"], summary["temperature"]["rail"]
    a, b = 1e3 * contact["semi_axis_a_m"], 1e3 * contact["semi_axis_b_m"]
    fields = results / "fields"
    (x, y), mech = read_vti(next(fields.glob("mech_contact_*.vti")))
    # The half-space has its friction power half an element upstream, on a grid of its own.
    passage = next(fields.glob("mech_passage_*.vti"), None)
    (xq, yq), power = read_vti(passage) if passage else ((x, y), mech)
    (xt, yt), thermal = read_vti(next(fields.glob("thermal_contact_*.vti")))
    (xs, zs), section = read_vti(next(fields.glob("thermal_rail_section_*.vti")))
    middle = len(y) // 2

    plt.rcParams.update({"font.size": 9, "axes.titlesize": 10, "figure.dpi": 130})
    figure, axes = plt.subplots(2, 2, figsize=(10, 6.4), layout="constrained")
    figure.suptitle(
        f"{summary['case']}: rail +{rail['max_rise_k']:.1f} K at x/a = {rail['x_over_a']:.3f}, "
        f"creepage {100 * contact['creepage_xi']:.3f} %; rolling to the right"
    )

    stress = axes[0, 0]
    stress.plot(x / a, mech["pressure"][middle, :, 0] / 1e6, label="pressure")
    stress.plot(x / a, mech["traction"][middle, :, 0] / 1e6, label="traction on the wheel")
    stress.set(title="centre line", xlabel="x/a", ylabel="MPa")
    stress.legend(frameon=False)

    heat = axes[0, 1]
    heat.plot(xq / a, power["friction_power"][len(yq) // 2, :, 0] / 1e6, color="tab:red")
    heat.set(title="centre line", xlabel="x/a")
    heat.set_ylabel("friction power [W/mm²]", color="tab:red")
    warm = heat.twinx()
    warm.plot(xt / a, thermal["rail_temperature"][len(yt) // 2, :, 0], color="tab:purple")
    warm.set_ylabel("rail temperature rise [K]", color="tab:purple")

    surface = axes[1, 0]
    image = surface.pcolormesh(xt, yt, thermal["rail_temperature"][:, :, 0], cmap="inferno")
    turn = np.linspace(0, 2 * np.pi, 200)
    surface.plot(a * np.cos(turn), b * np.sin(turn), color="white", lw=0.8)
    surface.plot(1e3 * rail["x_m"], 1e3 * rail["y_m"], "+", color="white")
    surface.set(title="rail surface", xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    figure.colorbar(image, ax=surface, label="K")

    depth = axes[1, 1]
    image = depth.pcolormesh(xs, 1e3 * zs, section["rail_section_temperature"][:, :, 0], cmap="inferno")
    level = rail["max_rise_k"] / np.e
    depth.contour(xs, 1e3 * zs, section["rail_section_temperature"][:, :, 0], [level], colors="w")
    depth.set(title="rail, y = 0 (line: 1/e of the peak)", xlabel="x [mm]", ylabel="z [µm]")
    depth.set_ylim(-300, 0)
    figure.colorbar(image, ax=depth, label="K")
    figure.savefig(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
