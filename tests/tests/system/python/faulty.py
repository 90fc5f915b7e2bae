"""`strip_columns.py` with a fault, named by the first argument, for the system tests."""

import ctypes
import sys
import time

import numpy as np
from cosim import Refusal, main
from strip_columns import StripColumns

FAULT = sys.argv.pop(1)
KEPT = []


class Faulty(StripColumns):
    """Misbehaves in its first solve, unless the fault names another place."""

    def configure(self, configuration):
        if FAULT == "refuse":
            raise Refusal("thermal.model", "told to refuse", "write something else")
        if FAULT == "layout":
            layout = super().configure(configuration)
            layout.fields.clear()
            return layout
        return super().configure(configuration)

    def solve(self, step, inputs, outputs):
        if FAULT == "second-row" and step.window == 1:
            raise ValueError("told to fail in the second row")
        report = super().solve(step, inputs, outputs)
        match FAULT:
            case "wrong-index" if step.window == 20:
                outputs["lower_temperature"][30] = outputs["lower_temperature"][31]
            case "raise":
                raise ValueError("told to fail")
            case "keep-input":
                KEPT.append(inputs["friction_power"][::2])
            case "keep-output":
                KEPT.append(outputs["lower_temperature"].reshape(-1, 1))
            case "write-input":
                inputs["friction_power"][0] = 0.0
            case "unwritten":
                outputs["lower_temperature"][7] = np.nan
            case "heat":
                report.received_power = np.nan
            case "unknown":
                outputs["rail_temperatur"] = 0.0
            case "exit":
                sys.exit(9)
            case "sleep":
                time.sleep(600.0)
            case "hold":
                # `PyDLL` keeps the interpreter lock.
                ctypes.PyDLL(None).usleep(5_000_000)
            case "spin":
                while True:
                    pass
        return report

    def accept(self):
        super().accept()
        if FAULT == "accept":
            raise ValueError("told to fail")


main(Faulty)
