"""Variant of `strip_columns.py` that breaks a single rule: the first argument, a check of
`coordinator conform`. The library satisfies the rules of the message protocol; the rogue breaks those."""

import dataclasses
import os
import sys

import numpy as np
from cosim import FieldKind, Grid, Refusal, StepError, Volume, main
from strip_columns import StripColumns

FAULT = sys.argv.pop(1)


class Astray(StripColumns):
    """Misbehaves in ways the library allows."""

    calls = 0
    configured = 0
    built = 0

    def configure(self, configuration):
        Astray.configured += 1
        try:
            layout = super().configure(configuration)
        except Refusal as refusal:
            if FAULT == "missing-key":
                raise Refusal("case", "something is missing", "find out what") from refusal
            raise
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
        if FAULT == "received-power":
            report = dataclasses.replace(report, received_power=report.received_power * (1.0 + 1e-8))
        if FAULT == "accept":
            super().accept()
        return report

    def accept(self):
        super().accept()
        self.is_asked_for_figures = True

    def observe(self, outputs):
        super().observe(outputs)
        self.remember(outputs)
        if FAULT == "observe":
            self.accepted = []

    def remember(self, outputs):
        """Publish fields that depend on the number of solves, or builds."""
        if FAULT == "reuse" and "lower_temperature" in outputs:
            outputs["lower_temperature"][0] += Astray.built
        if FAULT == "repeat" and "lower_temperature" in outputs:
            outputs["lower_temperature"][0] += self.calls

    def moved_grids(self):
        # Elements are inside out.
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
        if FAULT == "figures" and self.is_asked_for_figures:
            self.is_asked_for_figures = False
            return {}
        return {"temperature": {"rail": np.nan}} if FAULT == "finish" else super().summary()


match FAULT:
    case "describe":
        Astray.models = (dataclasses.replace(StripColumns.models[0], source=""),)
    case "volumes":
        model = StripColumns.models[0]
        Astray.models = (dataclasses.replace(model, provides=(*model.provides, "depth")),)
        Astray.fields = (FieldKind("depth", "m", meaning="depth under the surface"),)
        Volume.check = lambda _: None

main(Astray)
