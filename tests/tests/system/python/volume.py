"""Participant of `cases/volume.toml` in Python; its laws are in tests/src/volume.rs."""

import struct

import numpy as np
from cosim import FieldKind, Grid, Key, Layout, ModelSpec, Solver, Volume, main


def block(kind, n, swollen):
    counts = [n, -(-n // 2), -(-n // 4)]
    u, v, w = (np.arange(count + 1) / count for count in counts)
    u, v, w = (0.5 * at * (1.0 + at) for at in (u, v, w))
    swell = 1.0 + 0.01 * swollen
    if kind == "rectilinear":
        return Volume.rectilinear(swell * 2.0 * u, swell * v, swell * 0.5 * w)
    w, v, u = np.meshgrid(w, v, u, indexing="ij")
    x, y = (1.0 + v) * np.sin(u), (1.0 + v) * np.cos(u)
    vertices = swell * np.column_stack([x.ravel(), y.ravel(), 0.5 * w.ravel()])
    structured = Volume.structured(counts, vertices)
    if kind == "structured":
        return structured
    return Volume.unstructured(vertices, structured.elements())


class Block(Solver):
    """Block that heats up, and may swell."""

    name, role, standalone = "python-volume", "volume", True
    fields = (
        FieldKind("volume_temperature", "K", meaning="temperature in the block"),
        FieldKind("volume_place", "m", 3, meaning="centres of the block's elements"),
    )
    models = (
        ModelSpec(
            "law",
            "a temperature given as a function of place and time",
            "a closed form",
            provides=("volume_temperature", "volume_place"),
            transient=True,
        ),
    )
    keys = (
        Key.integer("volume.elements", "elements along the block", at_least=1, default=8),
        Key.choice("volume.hexahedra", ["rectilinear", "structured", "unstructured"], "their kind",
                   default="structured"),
        Key.flag("volume.swells", "it grows with every window", default=False),
    )

    def configure(self, configuration):
        case = configuration.case
        self.kind, self.n = case.get("volume.hexahedra"), case.integer("volume.elements")
        self.swells, self.windows = case.get("volume.swells", False), 0
        grid = Grid("block", block(self.kind, self.n, 0)).announced()
        return Layout([grid], {kind.name: "block" for kind in self.fields})

    def build(self):
        self.grid = self.solved_on = self.after(0)

    def after(self, windows):
        swollen = windows if self.swells else 0
        return Grid("block", block(self.kind, self.n, swollen), 1 + swollen)

    def solve(self, step, inputs, outputs):
        pass

    def accept(self):
        self.windows += 1
        self.solved_on, self.grid = self.grid, self.after(self.windows)

    def moved_grids(self):
        return [self.grid]

    def observe(self, outputs):
        x, y, z = self.solved_on.centres().T
        law = 2.0 + np.sin(1.3 * x) * np.cos(0.9 * y) + z
        outputs["volume_temperature"] = (1.0 + self.windows) * law
        outputs["volume_place"] = np.array([x, y, z])

    def save(self, file):
        file.write(struct.pack("<q", self.windows))

    def restore(self, file):
        (self.windows,) = struct.unpack("<q", file.read(8))
        self.grid, self.solved_on = self.after(self.windows), self.after(max(self.windows, 1) - 1)

    def summary(self):
        return {"volume": {"windows": self.windows}}


main(Block)
