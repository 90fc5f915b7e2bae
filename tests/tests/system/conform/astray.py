"""`strip_columns.py`, led astray: it breaks the one demand of the contract that is its first argument,
by the name that `coordinator conform` has for it."""

import dataclasses
import os
import sys

import cosim.heart
import cosim.run_dir
import cosim.server
import cosim.solver
import numpy as np
from cosim import FieldKind, Grid, Refusal, StepError, Volume, main
from cosim.ports import Inputs, PortError
from cosim.server import ProtocolError, Server
from strip_columns import StripColumns

FAULT = sys.argv.pop(1)


class NoHeart:
    """Neither beats nor looks at the coordinator."""

    def __init__(self, membership):
        self.membership = membership

    def nothing(self, *_):
        pass

    busy = report = idle_after = stop = nothing


class Astray(StripColumns):
    """Misbehaves where its library lets a solver do so."""

    calls = 0
    configured = 0
    built = 0

    def configure(self, configuration):
        Astray.configured += 1
        if FAULT == "unknown-model":
            configuration = dataclasses.replace(configuration, model="columns")
        try:
            layout = super().configure(configuration)
        except Refusal as refusal:
            if FAULT == "missing-key":
                raise Refusal("case", "something is missing", "find out what") from refusal
            raise
        if FAULT == "estimate" and "--estimate" in sys.argv and self.grid:
            layout.grids.append(Grid("spare", self.grid))
        if FAULT == "volumes":
            layout.grids.append(self.moved_grids()[0].announced())
            layout.fields["depth"] = "inside"
        if FAULT == "configure":
            layout.solve_seconds = float(Astray.configured)
        return layout

    def build(self):
        super().build()
        Astray.built += 1
        self.earliest = np.inf
        if FAULT == "growing-grids" and self.grid.points > 1000:
            raise StepError("too many elements")

    def first_outputs(self, outputs):
        super().first_outputs(outputs)
        if FAULT == "initialise":
            outputs["lower_temperature"][0] = np.inf

    def solve(self, step, inputs, outputs):
        self.calls += 1
        if FAULT == "other-end":
            self.earliest = min(self.earliest, step.end)
            step = dataclasses.replace(step, end=self.earliest)
        if FAULT == "no-duration" and not self.steady and step.duration == 0.0:
            os._exit(3)
        report = super().solve(step, inputs, outputs)
        if FAULT == "solve":
            outputs["lower_temperature"][0] = np.inf
        self.remember(outputs)
        if FAULT == "heat-received":
            report = dataclasses.replace(report, heat_received=report.heat_received * (1.0 + 1e-8))
        if FAULT == "accept":
            super().accept()
        return report

    def observe(self, outputs):
        super().observe(outputs)
        self.remember(outputs)
        if FAULT == "observe":
            self.accepted = []

    def remember(self, outputs):
        """What is published depends on how often it was solved, or built."""
        if FAULT == "reuse" and "lower_temperature" in outputs:
            outputs["lower_temperature"][0] += Astray.built
        if FAULT == "repeat" and "lower_temperature" in outputs:
            outputs["lower_temperature"][0] += self.calls

    def moved_grids(self):
        # Inside out.
        corners = [(x, y, z) for z in (0.0, -1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)]
        return [Grid("inside", Volume.structured((1, 1, 1), np.array(corners)))]

    def save(self, file):
        windows = self.accepted
        if FAULT == "restore":
            self.accepted = windows[:1]
        super().save(file)
        self.accepted = windows

    def restore(self, file):
        try:
            super().restore(file)
        except Exception:
            if FAULT != "damaged-state":
                raise

    def summary(self):
        return {"temperature": {"rail": np.nan}} if FAULT == "finish" else super().summary()


def careless(call, errors, then):
    """`call` with `errors` met by `then`."""

    def careful_no_more(*arguments):
        try:
            return call(*arguments)
        except errors:
            return then()

    return careful_no_more


def end():
    os._exit(4)


match FAULT:
    case "describe":
        Astray.models = (dataclasses.replace(StripColumns.models[0], source=""),)
    case "volumes":
        model = StripColumns.models[0]
        Astray.models = (dataclasses.replace(model, provides=(*model.provides, "depth")),)
        Astray.fields = (FieldKind("depth", "m", meaning="depth under the surface"),)
        Volume.check = lambda _: None
    case "version":
        cosim.run_dir.PROTOCOL_VERSION = 999
    case "unknown-model" | "unknown-effect" | "unknown-field":
        cosim.solver.admit = lambda *_: None
    case "missing-sample" | "wrong-sample":
        cosim.server.advance = careless(cosim.server.advance, PortError, lambda: None)
    case "not-finite":
        Inputs.finite = Inputs.__getitem__
    case "unknown-command":
        Server._handle = careless(Server._handle, ProtocolError, end)
    case "malformed":
        cosim.server.parse = careless(cosim.server.parse, ProtocolError, end)
    case "out-of-order":
        Server._ready = careless(Server._ready, ProtocolError, end)
    case "figures":
        cosim.server._figure = lambda *_: 0.0
    case "heart" | "coordinator-dies":
        cosim.heart.Heart = NoHeart

main(Astray)
