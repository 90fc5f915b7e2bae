"""Values on disk: read to the bit, and never wrong after damage or by several writers."""

import multiprocessing
import os
from pathlib import Path

import numpy as np
import pytest

from cosim.cache import Cache

SIZES = (2, 1)
ROWS = [(np.array([k, 1.0 / 3.0]), np.array([np.sqrt(k)])) for k in range(1, 5)]


def pairs(rows):
    return [(point.tolist(), values.tolist()) for point, values in rows]


def test_values_are_read_to_the_bit_and_only_once(tmp_path):
    writer, reader = Cache(tmp_path, "content"), Cache(tmp_path, "content")
    assert reader.news(SIZES) == []
    writer.add(ROWS[:2])
    assert pairs(reader.news(SIZES)) == pairs(ROWS[:2])
    writer.add(ROWS[2:])
    assert pairs(reader.news(SIZES)) == pairs(ROWS[2:])
    assert Cache(tmp_path, "content").news((3, 1)) == []
    assert Cache(tmp_path, "other").news(SIZES) == []


def test_a_file_of_another_content_is_ignored(tmp_path):
    Cache(tmp_path, "content").add(ROWS)
    (tmp_path / "content.jsonl").rename(tmp_path / "other.jsonl")
    assert Cache(tmp_path, "other").news(SIZES) == []


def test_a_cut_costs_the_line_that_it_is_in(tmp_path):
    Cache(tmp_path, "content").add(ROWS)
    file = tmp_path / "content.jsonl"
    whole = file.read_bytes()
    for cut in range(len(whole)):
        file.write_bytes(whole[:cut])
        found = pairs(Cache(tmp_path, "content").news(SIZES))
        assert found == pairs(ROWS[: whole[:cut].count(b"\n")])
        # The next line is whole again.
        Cache(tmp_path, "content").add(ROWS[3:])
        assert pairs(Cache(tmp_path, "content").news(SIZES))[-1] == pairs(ROWS[3:])[0]


def test_damage_costs_lines_and_never_changes_a_value(tmp_path):
    Cache(tmp_path, "content").add(ROWS)
    file, random = tmp_path / "content.jsonl", np.random.default_rng(1)
    whole, lost = file.read_bytes(), 0
    for _ in range(300):
        data = bytearray(whole)
        data[random.integers(len(data))] = random.integers(256)
        file.write_bytes(data)
        found = pairs(Cache(tmp_path, "content").news(SIZES))
        assert all(one in pairs(ROWS) for one in found)
        lost += len(ROWS) - len(found)
    assert 250 < lost < 700


def write(folder, number):
    for k in range(50):
        Cache(folder, "content").add([(np.array([number, k]), np.array([number * k]))] * 20)


def test_several_processes_write_whole_lines(tmp_path):
    context = multiprocessing.get_context("spawn")
    writers = [context.Process(target=write, args=(tmp_path, n)) for n in range(4)]
    for one in writers:
        one.start()
    for one in writers:
        one.join(60.0)
        assert one.exitcode == 0
    found = Cache(tmp_path, "content").news(SIZES)
    assert len(found) == 4 * 50 * 20
    assert all(values[0] == point[0] * point[1] for point, values in found)


@pytest.mark.parametrize("text", ["", "[", "[[1.0],[2.0]]", "[[1.0, 2.0], null]", "é"])
def test_lines_without_a_check_sum_are_ignored(tmp_path, text):
    (tmp_path / "content.jsonl").write_text(f"0123456789abcdef {text}\n", "utf-8")
    assert Cache(tmp_path, "content").news(SIZES) == []


@pytest.mark.parametrize("text", ["1.0", "[1.0, 2.0]", "[[[1.0], [2.0]], [3.0]]", "[" * 100_000])
def test_forged_lines_of_another_form_are_ignored(tmp_path, text):
    cache = Cache(tmp_path, "content")
    (tmp_path / "content.jsonl").write_text(f"{cache._check(text)} {text}\n", "utf-8")
    assert cache.news(SIZES) == []


@pytest.mark.parametrize("make", [Path.mkdir, os.mkfifo, lambda path: path.symlink_to("/dev/zero")])
def test_what_is_no_file_is_refused_at_once(tmp_path, make):
    make(tmp_path / "content.jsonl")
    for use in (lambda cache: cache.news(SIZES), lambda cache: cache.add(ROWS)):
        with pytest.raises(OSError, match=r"content\.jsonl"):
            use(Cache(tmp_path, "content"))
