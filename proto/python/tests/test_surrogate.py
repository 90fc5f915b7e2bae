"""Surrogates: closed forms, shapes, refusals, and invalid files."""

import copy
import json
import random

import numpy as np
import pytest

from cosim import surrogate

A, B = "load.a", "load.b"
DOCUMENT = {
    "schema": 1,
    "origin": {"case": "small", "file": "small.toml", "options": [], "points": 9, "left_out": 0},
    "keys": [
        {"key": A, "unit": "N", "from": float(np.e), "to": float(np.e**2)},
        {"key": B, "unit": "N", "from": 1.0, "to": 4.0},
    ],
    "coordinates": [
        {"key": A, "from": float(np.e), "to": float(np.e**2)},
        {"key": B, "per": A, "from": 0.25, "to": 1.25},
    ],
    "figures": [
        {
            "key": "law",
            "words": "−a",
            "held": {"measure": "relative", "largest": 0.01, "rms": 0.002},
            "scale": "log",
            "negative": True,
            "scales": ["log", "linear"],
            "degrees": [[0, 0], [1, 0]],
            "coefficients": [1.5, 0.5],
        },
        {
            "key": "square",
            "words": "3 T₁ T₂",
            "held": {"measure": "absolute", "largest": 0.01, "rms": 0.002},
            "scale": "linear",
            "scales": ["log", "linear"],
            "degrees": [[1, 2]],
            "coefficients": [3.0],
        },
    ],
}


@pytest.fixture
def load(tmp_path):
    def write_and_load(document):
        file = tmp_path / "fit.json"
        file.write_bytes(document if isinstance(document, bytes) else json.dumps(document).encode())
        return surrogate.load(file)

    return write_and_load


def test_figures_are_the_sums_of_their_terms(load):
    asked = load(DOCUMENT)
    a, b = np.linspace(3.0, 7.0, 5000)[:, None], np.array([1.8, 2.0, 3.5])
    found = asked.ask({A: a, B: b})
    s, t = 2.0 * np.log(a) - 3.0, 2.0 * (b / a) - 1.5
    assert found["law"].shape == (5000, 3)
    np.testing.assert_allclose(found["law"], np.broadcast_to(-a, (5000, 3)), rtol=1e-14)
    np.testing.assert_allclose(found["square"], 3.0 * s * (2.0 * t**2 - 1.0), atol=1e-14)
    one = asked.ask(**{A: 4.0, B: 2.0}, figures=["square"])
    assert list(one) == ["square"]
    assert one["square"].ndim == 0
    np.testing.assert_allclose(asked.figures["law"].bound(-5.0), 0.05)
    np.testing.assert_allclose(asked.figures["square"].bound([1.0, 2.0]), [0.01, 0.01])


def test_a_point_outside_is_refused(load):
    asked = load(DOCUMENT)
    with pytest.raises(
        surrogate.Outside, match=r"load\.b = 4\.5 N is outside 1\.0 to 4\.0 N"
    ) as told:
        asked.ask({A: 4.0, B: [2.0, 4.5, 5.0]})
    assert (told.value.key, told.value.value, told.value.largest) == (B, 4.5, 4.0)
    with pytest.raises(surrogate.Outside, match=r"load\.b/load\.a = 1\.333"):
        asked.ask({A: 3.0, B: 4.0})
    with pytest.raises(surrogate.Outside, match="nan"):
        asked.ask({A: np.nan, B: 2.0})
    with pytest.raises(KeyError, match=r"load\.c did not vary; load\.b is missing"):
        asked.ask({A: 3.0, "load.c": 1.0})


def test_a_figure_that_overflows_is_a_fault(load):
    document = copy.deepcopy(DOCUMENT)
    document["figures"][0]["coefficients"] = [800.0, 0.0]
    with pytest.raises(surrogate.Fault, match="law has no finite value here"):
        load(document).ask({A: 4.0, B: 2.0})


def test_what_is_no_surrogate_is_a_fault(load, tmp_path):
    def fault(words, change):
        document = copy.deepcopy(DOCUMENT)
        change(document)
        with pytest.raises(surrogate.Fault, match=words):
            load(document)

    fault("version 2", lambda d: d.update(schema=2))
    fault("no interval", lambda d: d["keys"][0].update({"from": 9.0}))
    fault("can be 0", lambda d: d["keys"][0].update({"from": -1.0}))
    fault("logarithm", lambda d: d["coordinates"][0].update({"from": -1.0}))
    fault("terms", lambda d: d["figures"][1].update(degrees=[[1, 33]]))
    fault("not finite", lambda d: d["figures"][1].update(coefficients=[float("nan")]))
    (tmp_path / "fit.json").write_bytes(b" " * (surrogate.LONGEST + 1))
    with pytest.raises(surrogate.Fault, match="longer"):
        surrogate.load(tmp_path / "fit.json")


def test_any_bytes_are_refused_or_evaluated(load):
    pick = random.Random(1)
    good = json.dumps(DOCUMENT).encode()
    for _ in range(300):
        text = bytearray(good)
        for _ in range(pick.randrange(1, 4)):
            at = pick.randrange(len(text))
            text[at : at + pick.randrange(4)] = pick.choices(b'0123456789.eE-[]{}",:nul', k=2)
        try:
            asked = load(bytes(text))
        except surrogate.Fault:
            continue
        middle = {key: 0.5 * (one.least + one.largest) for key, one in asked.keys.items()}
        with np.errstate(all="ignore"):
            try:
                asked.ask(middle)
            except (surrogate.Outside, surrogate.Fault):
                continue
