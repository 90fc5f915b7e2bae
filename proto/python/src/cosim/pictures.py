"""Pictures of results by matplotlib; each function draws one picture and returns its axes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .progress import needs
from .series import Field

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .front import Study
    from .results import Results

LONG_UNITS = {"Pa": (1e6, "MPa"), "W/m2": (1e6, "W/mm²"), "m": (1e-3, "mm"), "N": (1e3, "kN")}
"""Units for drawing: scale in units of the field, and name."""

STICK = 1e-3
"""Share of the largest slip velocity below which surfaces count as sticking."""

ARROWS = 24
"""Maximum number of arrows along the longer side."""


def new_axes(axes: Axes | None) -> Axes:
    """Return the given axes, or those of a new figure; needs matplotlib."""
    if axes is not None:
        return axes
    with needs("plots"):
        from matplotlib import pyplot  # noqa: PLC0415

    # Axes of equal scales are narrower than their figure; this layout keeps them in its middle.
    return pyplot.subplots(layout="compressed")[1]


def words(name: str) -> str:
    """Return a name of the contract as people write it."""
    return name.replace("_", " ")


def field(field: Field, axes: Axes | None = None) -> Axes:
    """Draw a field over its plane: filled contours, and arrows for a vector."""
    axes = new_axes(axes)
    scale, unit = LONG_UNITS.get(field.unit, (1.0, field.unit))
    down, across = (getattr(field, name) for name in field.axes)
    x, y = 1e3 * across, 1e3 * down
    if len(y) == 1:
        axes.plot(x, field.magnitude[0] / scale)
        axes.set(xlabel="x [mm]", ylabel=f"{words(field.name)} [{unit}]")
        return axes
    drawn = axes.contourf(x, y, field.magnitude / scale, levels=32)
    axes.figure.colorbar(drawn, ax=axes, label=f"{words(field.name)} [{unit}]")
    if field.values.ndim == 3:
        step = max(max(field.values.shape[:2]) // ARROWS, 1)
        vectors = field.values[step // 2 :: step, step // 2 :: step]
        seen = np.linalg.norm(vectors, axis=-1) > 1e-3 * field.magnitude.max(initial=1e-300)
        grid = np.meshgrid(x[step // 2 :: step], y[step // 2 :: step])
        axes.quiver(
            *(one[seen] for one in grid),
            vectors[seen][:, 0],
            vectors[seen][:, 1],
            color="white",
            alpha=0.8,
        )
    if field.axes[0] == "y":
        axes.set_aspect("equal")
    axes.set(xlabel="x [mm]", ylabel=f"{field.axes[0]} [mm]")
    return axes


def stick_and_slip(results: Results, axes: Axes | None = None) -> Axes:
    """Draw the stick and slip zones of the contact."""
    axes = new_axes(axes)
    pressure, slip = results["pressure"], results["slip_velocity"]
    speed = slip.magnitude
    state = np.where(
        pressure.values > 0.0, np.where(speed > STICK * speed.max(initial=0.0), 2.0, 1.0), np.nan
    )
    from matplotlib.colors import ListedColormap  # noqa: PLC0415
    from matplotlib.patches import Patch  # noqa: PLC0415

    colours = ("#2f6f9f", "#d97b29")
    axes.pcolormesh(
        1e3 * pressure.x, 1e3 * pressure.y, state, cmap=ListedColormap(colours), vmin=1.0, vmax=2.0
    )
    axes.legend(
        handles=[Patch(color=c, label=label) for c, label in zip(colours, ("stick", "slip"))],
        loc="upper left",
        bbox_to_anchor=(1.02, 1.0),  # beside the contact, not over it
        borderaxespad=0.0,
    )
    axes.set_aspect("equal")
    axes.set(xlabel="x [mm]", ylabel="y [mm]")
    return axes


def depth_profile(section: Field, axes: Axes | None = None, label: str | None = None) -> Axes:
    """Draw the values of a section over depth, below the largest value at the surface."""
    axes = new_axes(axes)
    if section.axes[0] != "z":
        raise ValueError(f"`{section.name}` is not a section over the depth")
    scale, unit = LONG_UNITS.get(section.unit, (1.0, section.unit))
    column = np.unravel_index(np.abs(section.magnitude).argmax(), section.magnitude.shape)[1]
    axes.plot(
        section.magnitude[:, column] / scale,
        1e3 * np.abs(section.z),
        label=label or words(section.name),
    )
    if not axes.yaxis_inverted():
        axes.invert_yaxis()
    axes.set(xlabel=f"{words(section.name)} [{unit}]", ylabel="depth [mm]")
    axes.legend()
    return axes


def curve(
    study: Study, x: str, y: str, labels: tuple[str, str], axes: Axes | None = None
) -> Axes:
    """Draw a column of a study over another one, such as a force over a creepage."""
    axes = new_axes(axes)
    order = np.argsort(study[x])
    axes.plot(study[x][order], study[y][order], marker="o", markersize=3)
    axes.set(xlabel=labels[0], ylabel=labels[1])
    axes.locator_params(axis="x", nbins=6)
    return axes
