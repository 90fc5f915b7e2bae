"""Samples over real shared memory: views cannot outlive it, and what arrives is checked."""

import ctypes
import gc
import time

import numpy as np
import pytest

from cosim import Grid, MissingInput, NonFiniteInput, Structured
from cosim.fields import FieldKind
from cosim.geometry import GeometryError
from cosim.messages import PROTOCOL_VERSION, Command, FieldHeader
from cosim.ports import Inputs, Outputs, PortError, Topic, advance, open_inputs, open_outputs
from cosim.solver import Step
from cosim.transport import TransportError
from cosim.views import KeptView

POINTS = 1000
KIND = FieldKind("value", "1")
TOPIC = Topic(
    "value",
    "field/one/value",
    Grid("line", Structured.contact_plane(0.0, 0.0, 1.0, 1.0, POINTS, 1)),
    1,
    None,
)


class Pair:
    """One field from a writer to a reader of the same process."""

    def __init__(self, endpoint, interpolation="constant", topic=TOPIC):
        self.inputs = open_inputs(endpoint, [TOPIC], [KIND], interpolation, [])
        self.outputs = open_outputs(endpoint, [topic], "one", {"value": KIND})
        self.outputs["value"].writer.wait_for_subscribers(time.monotonic() + 10.0)

    def send(self, value, window=0, iteration=1):
        outputs = Outputs(self.outputs, frozenset({"value"}))
        outputs["value"] = value
        outputs.publish(Step(window, iteration, 0.0, 0.0))

    def advance(self, expected, window=0):
        command = Command(window=window)
        command.expected[0] = expected
        advance(self.inputs, command)
        return Inputs(self.inputs)


def test_a_kept_view_is_told_and_its_memory_outlives_everything(endpoint):
    pair = Pair(endpoint)
    pair.send(1.0)
    inputs = pair.advance(1)
    kept = inputs["value"].reshape(10, 100)[3:, ::2]
    with pytest.raises(KeptView, match=r"`value` was kept.*numpy\.array"):
        inputs.end()
    with pytest.raises(PortError):
        inputs["value"]
    # The producer goes on through its slots; the one that is held stays what it was.
    for sequence in range(2, 5):
        pair.send(float(sequence))
    values = pair.advance(2)
    assert (values["value"] == 2.0).all()
    values.end()
    # Two samples may be held: a view that is kept would starve the input, also with the check off.
    with pytest.raises(TransportError, match="ExceedsMaxBorrows"):
        pair.advance(3)
    assert (kept == 1.0).all()
    pair.inputs.clear()
    pair.outputs.clear()
    del pair, inputs, values
    gc.collect()
    assert (kept == 1.0).all()


def test_views_of_inputs_cannot_be_written(endpoint):
    pair = Pair(endpoint)
    pair.send(1.0)
    inputs = pair.advance(1)
    values = inputs["value"]
    with pytest.raises(ValueError, match="read-only"):
        values[0] = 2.0
    with pytest.raises(ValueError, match="WRITEABLE"):
        values.flags.writeable = True
    with pytest.raises(ValueError, match="WRITEABLE"):
        values[::2].setflags(write=True)
    del values
    inputs.end()


def test_kept_places_of_outputs_are_told_and_stay_mapped(endpoint):
    pair = Pair(endpoint)
    outputs = Outputs(pair.outputs, frozenset({"value"}))
    kept = outputs["value"]
    kept[:] = 1.0
    with pytest.raises(KeptView, match="value"):
        outputs.publish(Step(0, 1, 0.0, 0.0))
    outputs.discard()
    pair.outputs.clear()
    del pair, outputs
    gc.collect()
    kept[:] = 2.0
    assert (kept == 2.0).all()


def test_views_in_a_cycle_of_garbage_are_nobodys(endpoint):
    pair = Pair(endpoint)
    pair.send(1.0)
    inputs = pair.advance(1)
    cycle = [inputs["value"]]
    cycle.append(cycle)
    del cycle
    inputs.end()


def test_every_value_must_be_written(endpoint):
    pair = Pair(endpoint)
    outputs = Outputs(pair.outputs, frozenset({"value"}))
    outputs["value"][:-1] = 0.0
    with pytest.raises(PortError, match=f"`value` is not finite at index {POINTS - 1} .*written"):
        outputs.publish(Step(0, 1, 0.0, 0.0))
    with pytest.raises(KeyError, match="provides no `valu`"):
        outputs["valu"] = 0.0
    outputs.discard()


def test_inputs_are_checked(endpoint):
    pair = Pair(endpoint)
    with pytest.raises(PortError, match="sequence number 0, expected 1"):
        pair.advance(1)
    pair.send(np.where(np.arange(POINTS) == 7, np.pi, 0.0))
    inputs = pair.advance(1)
    assert inputs.finite("value")[7] == np.pi
    with pytest.raises(MissingInput, match="input `pressure` is missing"):
        inputs["pressure"]
    inputs.end()
    # A sample that skips a number, as from a producer that lost one.
    pair.outputs["value"].header.sequence += 1
    pair.send(0.0)
    with pytest.raises(PortError, match="sequence number 3, expected 2: a sample is missing"):
        pair.advance(2)


def raw(pair, **header):
    """Publish a sample past the checks of `Outputs`."""
    port = pair.outputs["value"]
    label = {"protocol": PROTOCOL_VERSION, "sequence": 1, "name": b"value", "components": 1}
    label |= {"grid_revision": 1, **header}
    length = label.pop("length", POINTS)
    loan = port.writer.loan(length)
    ctypes.memset(loan.pointer, 0xFF, 8 * length)
    port.writer.publish(loan, FieldHeader(points=length, producer=b"one", **label))


def test_wrong_samples_are_named(endpoint):
    pair = Pair(endpoint)
    raw(pair)
    inputs = pair.advance(1)
    with pytest.raises(NonFiniteInput, match="`value` is not finite at index 0"):
        inputs.finite("value")
    inputs.end()
    stale = "on revision 2 of grid `line`, whose geometry is known in revision 1"
    for sequence, wrong, told in [
        (2, {"name": b"pressure"}, "topic of `value` carries `pressure`"),
        (2, {"protocol": 1}, "protocol version 1"),
        (2, {"length": POINTS - 1}, f"from `one` has {POINTS - 1} values, expected {POINTS}"),
        (3, {"grid_revision": 2}, stale),
    ]:
        raw(pair, sequence=sequence, **wrong)
        with pytest.raises((PortError, GeometryError), match=told):
            pair.advance(sequence)


def test_values_at_the_start_of_a_window_are_the_accepted_ones(endpoint):
    pair = Pair(endpoint, "linear")

    def start(sequence, window):
        inputs = pair.advance(sequence, window)
        values = inputs.start("value")
        first = float(values[0])
        del values
        inputs.end()
        return first

    pair.send(10.0, window=0, iteration=0)
    assert start(1, 0) == 10.0
    pair.send(11.0, window=0, iteration=1)
    assert start(2, 0) == 10.0
    pair.send(12.0, window=0, iteration=2)
    assert start(3, 0) == 10.0
    # A new window begins with the last iterate of the one before; solved again, it still does.
    assert start(3, 1) == 12.0
    pair.send(13.0, window=1, iteration=1)
    assert start(4, 1) == 12.0
    pair.send(14.0, window=1, iteration=1)
    assert start(5, 1) == 12.0
    constant = open_inputs(endpoint, [TOPIC], [KIND], "constant", [])
    assert Inputs(constant).start("value") is None
