"""Volumes: announced by their counts, with a geometry that follows."""

import numpy as np
import pytest

from cosim import Grid, Layout, Volume

AXES = ([0.0, 1.0, 4.0], [-1.0, 1.0], [0.0, 0.5])


def boxes():
    return Volume.rectilinear(*AXES)


def volumes():
    box = boxes()
    vertices, elements = box.vertices(), box.elements()
    return [box, Volume.structured((2, 1, 1), vertices), Volume.unstructured(vertices, elements)]


@pytest.mark.parametrize("volume", volumes(), ids=lambda volume: volume.hexahedra)
def test_three_kinds_of_the_same_elements(volume):
    Grid("body", volume).check()
    assert (volume.points, volume.vertex_count) == (2, 12)
    assert volume.volumes().tolist() == [1.0, 3.0]
    assert volume.centres().tolist() == [[0.5, 0.0, 0.25], [2.5, 0.0, 0.25]]
    assert volume.elements()[1].tolist() == [1, 2, 5, 4, 7, 8, 11, 10]


def test_the_golden_layout_of_the_geometry():
    """The golden values of proto/contract/src/grid/volume.rs."""
    box, structured, unstructured = (volume.known().ravel().tolist() for volume in volumes())
    assert box == [0.0, 1.0, 4.0, -1.0, 1.0, 0.0, 0.0, 0.5, 0.0]
    assert structured[:6] == [0.0, 1.0, 4.0, 0.0, 1.0, 4.0]
    assert structured[12:18] == [-1.0, -1.0, -1.0, 1.0, 1.0, 1.0]
    assert len(unstructured) == 3 * (12 + 6)
    assert unstructured[12:18] == [0.0, 3.0, 10.0, 1.0, 4.0, 11.0]
    assert unstructured[30:36] == [1.0, 6.0, 9.0, 2.0, 7.0, 10.0]
    assert unstructured[48:54] == [4.0, 7.0, 0.0, 5.0, 8.0, 0.0]


@pytest.mark.parametrize("volume", volumes(), ids=lambda volume: volume.hexahedra)
def test_a_volume_is_announced_and_comes_to_its_geometry(volume):
    grid = Grid("body", volume)
    announced = grid.announced()
    assert (announced.revision, grid.revision) == (0, 1)
    announced.check()
    told = announced.to_json()
    assert "geometry" not in told and (told["kind"], told["revision"]) == ("volume", 0)
    read = Grid.from_json(told)
    assert (read.shape.hexahedra, read.shape.counts) == (volume.hexahedra, volume.counts)
    announced.check_moved(grid)
    again = read.with_geometry(grid.encoded_geometry(), 1)
    assert np.array_equal(again.encoded_geometry(), grid.encoded_geometry())
    again.check_moved(grid)
    moved = again.moved(again.shape.with_geometry(again.shape.known() * 1.0))
    assert moved.revision == 2
    with pytest.raises(ValueError, match="announced in revision 0"):
        Grid("body", volume, 0).check()
    with pytest.raises(ValueError, match="precedes"):
        announced.encoded_geometry()
    layout = Layout(grids=[announced])
    layout.check()
    assert layout.to_json()["grids"] == [told]
    with pytest.raises(ValueError, match="the geometry of `body` follows"):
        Layout(grids=[grid]).check()


def test_no_input_is_wanted_on_a_volume():
    body = Grid("body", boxes()).announced()
    layout = Layout(grids=[body], inputs={"heat": "body"})
    with pytest.raises(ValueError, match="wanted on the volume `body`"):
        layout.check()


@pytest.mark.parametrize(
    ("which", "at", "value", "why"),
    [
        (0, 2, 1.0, "do not rise"),
        (0, 5, 1.0, "too many"),
        (0, 8, np.nan, "not finite"),
        (1, 13, 19.0, "element 0 without a positive volume"),
        (2, 12, 12.0, "element 0, which names"),
        (2, 12, 0.5, "element 0, which names"),
        (2, 50, 1.0, "element 0, which names"),
    ],
)
def test_a_geometry_from_outside_is_checked(which, at, value, why):
    volume = volumes()[which]
    geometry = volume.known().copy()
    geometry.flat[at] = value
    with pytest.raises(ValueError, match=why):
        Volume(volume.hexahedra, volume.counts, geometry).check()


@pytest.mark.parametrize(
    "volume",
    [
        Volume("structured", (0, 1, 1)),
        Volume("rectilinear", (1 << 62, 1 << 62, 1)),
        Volume("unstructured", (7, 1)),
        Volume("unstructured", (8, 1 << 33)),
        Volume("pyramids", (8, 1)),
        Volume("structured", (2, 1)),
    ],
)
def test_counts_are_limited(volume):
    with pytest.raises(ValueError, match=r"elements and|hexahedra with"):
        volume.check()


def test_elements_keep_their_vertices():
    volume = volumes()[2]
    other = Volume.unstructured(volume.vertices(), volume.elements()[::-1])
    with pytest.raises(ValueError, match="other vertices"):
        volume.with_geometry(other.known())
    with pytest.raises(ValueError, match="not the grid `body`"):
        Grid("body", volume).check_moved(Grid("body", other, 2))
