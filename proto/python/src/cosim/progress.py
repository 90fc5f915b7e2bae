"""Progress of a command, shown during the run: a tqdm bar if tqdm is installed.

With `COSIM_PROGRESS=json` the coordinator writes lines of JSON to standard error
(coordinator/console/src/feed.rs). Without tqdm it writes plain lines, which are passed on.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

FORM = {"COSIM_PROGRESS": "json"}
"""Environment that makes the coordinator write lines of JSON."""
START = '{"progress":'
"""Beginning of such a line."""


class Bar:
    """A progress bar, created at the first progress line."""

    def __init__(self, kind: Any) -> None:
        self._kind = kind
        self._bar: Any = None

    def takes(self, line: str) -> bool:
        """Show a progress line; return false for any other line."""
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
        """Leave the bar in its last state."""
        if self._bar is not None:
            self._bar.close()


def bar() -> Bar | None:
    """Return a bar if tqdm is installed: a widget in notebooks that support it, otherwise text."""
    try:
        with warnings.catch_warnings():
            # Without widgets the bar is text; the warning about this is suppressed.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm  # noqa: PLC0415
    except ImportError:
        return None
    return Bar(tqdm)


@contextmanager
def needs(extra: str) -> Iterator[None]:
    """Add installation advice to the error if a package imported here is missing."""
    try:
        yield
    except ModuleNotFoundError as error:
        fix = f"pip install 'cosim-participant[{extra}]'"
        raise ModuleNotFoundError(f"{error.msg}; {fix}", name=error.name) from None
