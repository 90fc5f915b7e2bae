"""Role `right` of `cases/exchange.toml`: builds for three seconds with progress reports, and hangs in
the first solve."""

import time

from cosim import FieldKind, Layout, ModelSpec, Solver, Structured, main
from cosim.grids import Grid


class Long(Solver):
    """Sends what it receives."""

    name, role, standalone = "python-long", "right", True
    fields = (FieldKind("left_value", "1"), FieldKind("right_value", "1"))
    models = (
        ModelSpec("relay", "sends what it receives", "none", True, True, ("left_value",), ("right_value",)),
    )

    def configure(self, configuration):
        assert configuration.threads >= 1
        grid = Grid("numbers", Structured.contact_plane(0.0, 0.0, 1.0, 1.0, 1000, 1))
        return Layout([grid], {"right_value": "numbers"})

    def build(self):
        for done in range(30):
            self.progress(done, 30, "assembling")
            time.sleep(0.1)

    def solve(self, step, inputs, outputs):
        outputs["right_value"] = inputs["left_value"]
        self.progress(7, what="sweeping")
        time.sleep(600)


main(Long)
