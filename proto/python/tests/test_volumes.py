"""Volumes: announced by their counts, with a geometry that follows."""

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
    assert (volume.points, volume.vertex_count) == (2, 12)
    assert volume.volumes().tolist() == [1.0, 3.0]
    assert volume.centres().tolist() == [[0.5, 0.0, 0.25], [2.5, 0.0, 0.25]]
    assert volume.elements()[1].tolist() == [1, 2, 5, 4, 7, 8, 11, 10]


def test_the_golden_layout_of_the_geometry():
    """Checks the golden values of proto/grids/src/volume.rs."""
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
    told = announced.to_json()
    assert "geometry" not in told and (told["kind"], told["revision"]) == ("volume", 0)
    assert not announced.is_where(grid) and grid.is_where(Grid("body", volume))
    moved = grid.moved(Volume(volume.hexahedra, volume.counts, volume.known() * 2.0))
    assert moved.revision == 2 and not grid.is_where(moved)
    with pytest.raises(ValueError, match="precedes"):
        announced.encoded_geometry()
    assert Layout(grids=[announced]).to_json()["grids"] == [told]
