"""How far a command is, shown while it works: a bar of tqdm where that is installed.

The coordinator writes lines of JSON on standard error where `COSIM_PROGRESS` is `json`
(coordinator/console/src/feed.rs). Without tqdm it writes plain lines, which are passed on.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

FORM = {"COSIM_PROGRESS": "json"}
"""What asks the coordinator for lines of JSON."""
START = '{"progress":'
"""What such a line begins with."""


class Bar:
    """A bar, from the first line about progress on."""

    def __init__(self, kind: Any) -> None:
        self._kind = kind
        self._bar: Any = None

    def takes(self, line: str) -> bool:
        """Show a line about progress; false for any other one."""
        if not line.startswith(START):
            return False
        told = json.loads(line)["progress"]
        if self._bar is None:
            self._bar = self._kind(total=told["of"], unit=f" {told['what']}", leave=True)
        self._bar.total = told["of"]
        self._bar.n = told["done"] or 0
        self._bar.set_postfix_str(told["words"], refresh=False)
        self._bar.refresh()
        return True

    def close(self) -> None:
        """Leave the bar as it is."""
        if self._bar is not None:
            self._bar.close()


def bar() -> Bar | None:
    """A bar, if tqdm is installed: a widget in a notebook that has them, text elsewhere."""
    try:
        with warnings.catch_warnings():
            # Without widgets the bar is text, which needs no remark.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm  # noqa: PLC0415
    except ImportError:
        return None
    return Bar(tqdm)


@contextmanager
def needs(extra: str) -> Iterator[None]:
    """Says how a package that is imported here is installed, if it is not there."""
    try:
        yield
    except ModuleNotFoundError as error:
        fix = f"pip install 'cosim-participant[{extra}]'"
        raise ModuleNotFoundError(f"{error.msg}; {fix}", name=error.name) from None
