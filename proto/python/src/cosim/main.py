"""The main function of a participant."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from .solver import Solver


def main(solver: type[Solver], arguments: Sequence[str] | None = None) -> None:
    """Take part in a run with `--join`, or print the description with `--describe`.

    Ends the process with exit code 1 after an error, and with 2 for invalid arguments.
    """
    # Only a running participant needs the library; a module imported by a test does not.
    from .library import load
    from .participant import Participant

    try:
        library = load()
    except (OSError, AttributeError) as error:
        sys.exit(f"error: {error}")
    code = Participant(solver, library).main(sys.argv[1:] if arguments is None else arguments)
    if code != 0:
        sys.exit(code)
