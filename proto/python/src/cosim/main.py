"""The command line of a participant.

PROGRAM --describe                      print the description as JSON
PROGRAM --estimate < configuration      print grids and expected cost as JSON
PROGRAM --join RUN_FOLDER --role ROLE   take part in a run
"""

from __future__ import annotations

import argparse
import gc
import json
import logging
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .configuration import Configuration, Refusal
from .solver import Solver, checked_layout


def main(solver: type[Solver], arguments: Sequence[str] | None = None) -> None:
    """The whole main of a participant. Ends the process with exit code 1 after an error."""
    logging.basicConfig(format="%(levelname)s %(name)s: %(message)s")
    parser = argparse.ArgumentParser(description=solver.__doc__)
    action = parser.add_mutually_exclusive_group()
    action.add_argument("--describe", action="store_true", help="print what this program can do")
    action.add_argument("--estimate", action="store_true", help="print grids and expected cost")
    action.add_argument("--join", type=Path, metavar="RUN_FOLDER", help="take part in this run")
    parser.add_argument("--role", help="the role to play in the run")
    parser.add_argument("--version", action="version", version=solver.version)
    given = parser.parse_args(arguments)
    if given.describe:
        _print(solver.description())
    elif given.estimate:
        _print(_estimate(solver(), json.load(sys.stdin)))
    elif given.join and given.role:
        _take_part(solver, given.join, given.role)
    else:
        sys.exit(
            "error: nothing to do; started by hand, a participant needs --describe, --estimate or "
            "--join RUN_FOLDER --role ROLE"
        )


def _print(value: Any) -> None:
    json.dump(value, sys.stdout, indent=2)
    sys.stdout.write("\n")


def _estimate(solver: Solver, configuration: dict[str, Any]) -> dict[str, Any]:
    try:
        return {"layout": checked_layout(solver, Configuration.from_json(configuration)).to_json()}
    except Refusal as refusal:
        return {"refused": refusal.to_json()}


def _take_part(solver: type[Solver], folder: Path, role: str) -> None:
    # Only a run needs shared memory: a program that describes itself starts without it.
    from .heart import Heart
    from .run_dir import Membership, RunError
    from .server import Server
    from .transport import TransportError

    try:
        membership = Membership(folder, role)
    except RunError as error:
        sys.exit(f"error: {error}")
    heart = Heart(membership)
    try:
        server = Server(solver, membership, role, heart)
        server.serve()
    except TransportError as error:
        sys.exit(f"error: {error}")
    finally:
        heart.stop()
        # Ports close before the run's folder is left and perhaps removed.
        server = None  # type: ignore[assignment]
        gc.collect()
        membership.leave()
