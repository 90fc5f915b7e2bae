"""The examples are tested too; a run's services in a folder of their own."""

import sys
import tempfile
from pathlib import Path

import pytest

from cosim.run_dir import RunInfo, _remove
from cosim.transport import Endpoint

sys.path.insert(0, str(Path(__file__).parent.parent / "examples"))


@pytest.fixture
def endpoint():
    with tempfile.TemporaryDirectory(prefix="ct-", dir="/dev/shm") as folder:
        run = Path(folder) / "r" / "t"
        run.mkdir(parents=True)
        info = RunInfo(run, f"cosim_{Path(folder).name}_", ("one",))
        yield Endpoint(info)
        _remove(info)
