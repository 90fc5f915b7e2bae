"""Data that crosses the process boundary: layouts, JSON, refusals."""

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest
from strip_columns import StripColumns

from cosim import (
    Configuration,
    Grid,
    Key,
    Layout,
    Quadrilaterals,
    Refusal,
    Simplification,
    Structured,
    Vertices,
)
from cosim.participant import to_json
from cosim.recording import LABEL
from cosim.solver import first_non_finite


def test_the_label_of_a_recording_is_that_of_the_contract():
    """Checks the golden numbers of `proto/contract/src/message.rs`."""
    offsets = [LABEL.fields[name][1] for name in LABEL.names]
    assert offsets == [0, 4, 8, 16, 24, 32, 36, 40, 48, 56, 64, 96, 112, 144]
    assert LABEL.itemsize == 176


def configuration(**more):
    plane = Structured.contact_plane(-0.1 / 3, -1e-3, 1e-4, 2e-4, 8, 4)
    fields = {
        "friction_power": ("W/m2", 1, "conservative", Grid("contact", plane).to_json()),
        "surface_speed": ("m/s", 2, "consistent", None),
    }
    inputs = [
        {
            "field": {
                "name": name,
                "unit": unit,
                "components": components,
                "mapping": mapping,
                "body": "interface",
                "meaning": "",
            },
            "producer": "mech",
            "grid": grid,
        }
        for name, (unit, components, mapping, grid) in fields.items()
    ]
    steel = {"density": 7850.0, "specific_heat": 419.5, "conductivity": 50.0}
    return {
        "role": "thermal",
        "model": "columns",
        "mode": "steady",
        "case": {
            "bodies": {"wheel": {"position": "upper", "material": "steel"},
            "rail": {"position": "lower", "material": "steel"}},
            "materials": {"steel": steel},
            "motion": {"speed": 38.889},
            "effects": {"friction_heat": {"partition": "equal"}},
        },
        "inputs": inputs,
        "outputs": ["lower_temperature"],
        "observed": [],
        **more,
    }


def laid_out(**more):
    return StripColumns().configure(Configuration.from_json(configuration(**more)))


def test_a_layout_places_fields_and_wishes_inputs_only_when_asked():
    layout = laid_out()
    assert layout.fields["lower_temperature"] == "contact"
    assert "inputs" not in layout.to_json()
    case = {**configuration()["case"], "thermal": {"resolution": 16}}
    layout = laid_out(case=case)
    # The patch is 8 x 1e-4 m by 4 x 2e-4 m: square elements of 5e-5 m, on the same patch.
    shape = layout.grid("contact").shape
    assert (shape.ni, shape.nj) == (16, 16)
    assert layout.to_json()["inputs"] == [{"field": "friction_power", "grid": "contact"}]
    low = np.array(shape.origin) - 0.5 * np.array(shape.step_i) - 0.5 * np.array(shape.step_j)
    # Rounding of sums of 0.03.
    assert np.allclose(low, [-0.1 / 3 - 5e-5, -1e-3 - 1e-4, 0.0], rtol=0, atol=1e-16)


def test_refusals_name_the_key():
    def refused(**more):
        with pytest.raises(Refusal) as refusal:
            laid_out(**more)
        return refusal.value.key

    case = configuration()["case"]
    assert refused(case={**case, "effects": {}}) == "effects.friction_heat"
    assert refused(case={**case, "motion": {"speed": "fast"}}) == "motion.speed"
    assert refused(case={**case, "materials": {}}) == "materials.steel.density"


def test_grids_travel_with_every_bit_and_agree_with_each_other():
    plane = Structured((-0.1 / 3, 1e-17, 0.2), (0.1, 0.02, 0.0), (0.03, 0.0, -0.2), 3, 2)
    again = Grid.from_json(json.loads(json.dumps(Grid("g", plane).to_json())))
    assert again == Grid("g", plane)
    corner = [
        np.array(plane.origin)
        + (i - 0.5) * np.array(plane.step_i)
        + (j - 0.5) * np.array(plane.step_j)
        for j in range(3)
        for i in range(4)
    ]
    n = [j * 4 + i for j in range(2) for i in range(3)]
    elements = np.array([[k, k + 1, k + 5, k + 4] for k in n], dtype=np.uint32)
    surface = Quadrilaterals(np.array(corner), elements)
    again = Grid.from_json(json.loads(json.dumps(Grid("g", surface).to_json()))).shape
    assert np.array_equal(again.points_xyz, surface.points_xyz)
    # Rounding of coordinates of order 0.1.
    assert np.allclose(surface.centres(), plane.centres(), rtol=0, atol=1e-16)
    assert np.allclose(surface.areas(), plane.areas(), rtol=1e-14)


def test_vertices_travel_and_have_the_areas_of_their_measure():
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
    grid = Grid("mesh", Vertices(points, triangles=triangles, measure="per-area"))
    again = Grid.from_json(json.loads(json.dumps(grid.to_json())))
    assert again.points == 4 and again.is_where(grid)
    assert again.shape.to_json() == grid.shape.to_json()
    assert np.allclose(again.areas(), np.array([2, 1, 2, 1]) / 6, rtol=1e-15)
    assert np.isclose(grid.integrate(points[:, 0]), 0.5, rtol=1e-15)  # x over the unit square
    line = Vertices(points[:3], np.array([[0, 1], [1, 2]], dtype=np.uint32), measure="per-area")
    assert line.areas().tolist() == [0.5, 1.0, 0.5]
    assert Vertices(points, measure="per-point").areas().tolist() == [1.0] * 4
    assert Vertices(points).areas().tolist() == [0.0] * 4


def test_first_non_finite_value_and_sums_that_overflow():
    values = np.full(5000, 1e308)
    assert first_non_finite(values) is None
    values[4001], values[4500] = -math.inf, math.nan
    assert first_non_finite(values) == 4001


def test_summaries_of_numpy_values_are_json():
    value = {"a": np.float64(0.5), "b": np.arange(2), "c": math.nan, "d": (np.int64(3), True)}
    assert json.loads(to_json(value)) == {"a": 0.5, "b": [0, 1], "c": None, "d": [3, True]}


def test_the_readme_shows_the_example():
    package = Path(__file__).parent.parent
    solvers = (package / "README.md").read_text().split("## Solvers\n")[1]
    shown = solvers.split("```python\n")[1].split("```")[0]
    assert shown == (package / "examples/short_columns.py").read_text()


def test_a_layout_says_what_it_is_asked_for_and_nothing_else():
    grid = Grid("line", Structured.contact_plane(0.0, 0.0, 1.0, 1.0, 3, 1))
    plain = Layout(grids=[grid], fields={"pressure": "line"})
    optional = {"inputs", "moving", "build_seconds", "left_out", "closed_forms"}
    assert not optional & set(plain.to_json())
    full = dataclasses.replace(
        plain,
        inputs={"friction_power": "line"},
        moving=["line"],
        build_seconds=2.5,
        left_out=[Simplification("the wake", 0.01, "a study")],
        closed_forms={"contact.area_m2": 1e-4},
    )
    told = full.to_json()
    assert optional <= set(told)
    assert told["left_out"] == [
        {"what": "the wake", "error": 0.01, "source": "a study", "with_effects": []}
    ]


def test_text_that_is_not_utf8_travels_with_escapes():
    """Python reads a file name in another encoding with surrogates, which JSON refuses."""
    name = b"gr\xf6sse.csv".decode("utf-8", "surrogateescape")
    assert json.loads(to_json({"error": f"no file {name}"})) == {"error": r"no file gr\udcf6sse.csv"}
    refusal = Refusal("bodies.rail.profile", f"{name} is not there", "name another file")
    to_json(refusal.to_json()).decode("utf-8")
    assert refusal.to_json()["reason"] == r"gr\udcf6sse.csv is not there"


def test_the_geometry_of_a_moving_grid():
    plane = Grid("patch", Structured.contact_plane(-1.0, 2.0, 0.5, 0.25, 3, 2))
    # The golden values of `proto/grids/src/geometry.rs`.
    golden = [-1.0, 0.5, 0.0, 3.0, 2.0, 0.0, 0.25, 2.0, 0.0, 0.0, 0.0, 1.0]
    assert plane.encoded_geometry().ravel().tolist() == golden
    vertices = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]])
    surface = Quadrilaterals(vertices, np.array([[0, 1, 2, 3]], dtype=np.uint32))
    assert np.array_equal(Grid("patch", surface).encoded_geometry().T, vertices)
    moved = plane.moved(Structured.contact_plane(0.0, 2.0, 0.5, 0.25, 3, 2))
    assert moved.revision == 2 and not plane.is_where(moved)


def test_histories_give_the_case_of_a_window():
    from types import SimpleNamespace

    from cosim import Configuration

    def given(rows):
        return Configuration.from_json(
            {
                "role": "thermal",
                "model": "short",
                "mode": "steady",
                "case": {"load": {"normal_force": 1.0, "other": 5.0}},
                "inputs": [],
                "outputs": [],
                "observed": [],
                "histories": {
                    "rows": rows,
                    "times": [0.0, 1.0, 3.0],
                    "values": {"load.normal_force": [1.0, 3.0, 2.0]},
                },
            }
        )

    row = given(True).case_at(SimpleNamespace(window=2, start=3.0, end=3.0))
    assert (row.number("load.normal_force"), row.number("load.other")) == (2.0, 5.0)
    for start, end, expected in ((0.0, 1.0, 2.0), (1.5, 2.5, 2.5), (8.0, 9.0, 2.0)):
        instant = given(False).case_at(SimpleNamespace(window=0, start=start, end=end))
        assert instant.number("load.normal_force") == expected
    assert given(True).case.number("load.normal_force") == 1.0


def test_live_values_are_those_given_last():
    from types import SimpleNamespace

    from cosim.configuration import Histories

    histories = Histories(
        rows=True,
        times=[0.0, 1.0, 2.0],
        values={"load.normal_force": [2.0, 1.0, 3.0]},
        live={"limits": {"load.normal_force": [1.0, 3.0]}},
    )
    step = SimpleNamespace(window=7, start=0.0, end=0.0)
    assert histories.at(step) == {"load.normal_force": 2.0}
    histories.given["load.normal_force"] = 2.5
    assert histories.at(step) == {"load.normal_force": 2.5}


def test_a_word_of_a_key_asks_for_fields():
    words = ("equal", "continuity")
    key = Key.choice("effects.heat.partition", words, "how", consumes={"continuity": ("pressure",)})
    assert key.to_json()["consumes"] == {"continuity": ["pressure"]}
    assert "consumes" not in Key.choice("effects.heat.partition", words, "how").to_json()
    assert len({key, key}) == 1
