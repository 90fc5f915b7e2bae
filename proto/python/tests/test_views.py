"""Views of memory lent for a call: kept views are detected, and views of inputs cannot be
written."""

import ctypes

import numpy as np
import pytest

from cosim.views import KeptView, Views


@pytest.fixture
def memory():
    return (ctypes.c_double * 12)(*range(12))


def view(views, memory, read_only=True):
    return views.view("value", ctypes.addressof(memory), (3, 4), read_only=read_only)


def test_a_kept_view_is_told(memory):
    views = Views()
    kept = view(views, memory).reshape(4, 3)[2:, ::2]
    with pytest.raises(KeptView, match=r"`value` was kept.*numpy\.array"):
        views.end()
    assert kept.tolist() == [[6.0, 8.0], [9.0, 11.0]]
    copy = np.array(view(views, memory))
    views.end()
    assert copy.sum() == 66.0


def test_views_of_inputs_cannot_be_written(memory):
    views = Views()
    values = view(views, memory)
    with pytest.raises(ValueError, match="read-only"):
        values[0] = 2.0
    with pytest.raises(ValueError, match="WRITEABLE"):
        values.flags.writeable = True
    with pytest.raises(ValueError, match="WRITEABLE"):
        values[::2].setflags(write=True)


def test_views_of_outputs_are_written_in_place(memory):
    views = Views()
    view(views, memory, read_only=False)[1] = -1.0
    views.end()
    assert list(memory)[3:9] == [3.0, -1.0, -1.0, -1.0, -1.0, 8.0]


def test_views_in_a_cycle_of_garbage_are_nobodys(memory):
    views = Views()
    cycle = [view(views, memory)]
    cycle.append(cycle)
    del cycle
    views.end()
