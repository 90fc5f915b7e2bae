# Opens the series beside this file in ParaView: one view for each, at its newest instant.
#
#     paraview --state=open.py              or: File, Load State
#     pvpython open.py [PICTURE.png]        saves a picture, fields.png if none is named
#
# A run replaces this file: keep a changed one under another name.

import math
import sys
from pathlib import Path

# Array by which each series is coloured.
SERIES = {}

FOLDER = Path(__file__).resolve().parent

# Names of the axes. For each axis normal to a plane: direction of view, and index of the axis that
# points up.
AXES = "xyz"
LOOKS = [((1, 0, 0), 2), ((0, -1, 0), 2), ((0, 0, 1), 1)]

# Units of length, in metres.
UNITS = [("m", 1), ("mm", 1e-3), ("µm", 1e-6)]

# Smallest ratio of depth to width of a section; a flatter section is stretched to it.
LEAST_DEPTH = 0.35

# Axes are labelled on their lower sides: ParaView's bits of x, y and z.
LOWER = 0b111

# Share of a view, in width and height, that a field fills, and its offset to the left. The rest is
# for axes, title, and the legend on the right.
FILLED = (0.66, 0.68)
LEFT = 0.055

# Size of a view in a saved picture [pixel].
VIEW = (900, 420)


def found():
    """Return file and array of each existing series, by name."""
    files = {name: FOLDER / f"{name}.pvd" for name in SERIES}
    return {name: (path, SERIES[name]) for name, path in files.items() if path.is_file()}


class Plane:
    """Position of a flat field [m], and its view."""

    def __init__(self, bounds):
        """Take the bounds as ParaView reports them."""
        self.low, self.high = bounds[0::2], bounds[1::2]
        sizes = [high - low for low, high in zip(self.low, self.high)]
        self.across = sizes.index(min(sizes))
        self.look, self.up = LOOKS[self.across]
        self.right = 3 - self.across - self.up
        self.size = (sizes[self.right], sizes[self.up])
        self.stretch = 1
        if AXES[self.up] == "z" and 0 < self.size[1] < LEAST_DEPTH * self.size[0]:
            self.stretch = round_up(LEAST_DEPTH * self.size[0] / self.size[1])

    def order(self):
        """Return the sort key: surfaces, then sections, with the upper body first."""
        return -self.across, -(self.low[2] + self.high[2])


def round_up(value):
    """Return the next of 1, 2, 5, 10, 20 and so on."""
    power = 10 ** math.floor(math.log10(value))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= value)


def unit_of(size):
    """Return the unit, and its metres, in which a length [m] is shown."""
    return next((unit for unit in UNITS if size >= unit[1]), UNITS[-1])


def show(series):
    """Open the series and lay them out: surfaces on the left, sections on the right."""
    from paraview import simple

    simple._DisableFirstRenderCameraReset()
    simple.LoadPalette("WhiteBackground")
    shown = []
    for name, (path, array) in series.items():
        reader = simple.PVDReader(registrationName=name, FileName=str(path))
        reader.UpdatePipelineInformation()
        times = list(reader.TimestepValues)
        reader.UpdatePipeline(times[-1])
        shown.append((name, reader, array, Plane(reader.GetDataInformation().GetBounds())))
    shown.sort(key=lambda one: one[3].order())
    layout, views = arrange(simple, [one[3].across for one in shown])
    for view, one in zip(views, shown):
        draw(simple, view, *one)
    if any(len(one[1].TimestepValues) > 1 for one in shown):
        clock = simple.AnnotateTime(registrationName="time", Format="t = {time:g} s")
        simple.Show(clock, views[0]).WindowLocation = "Upper Left Corner"
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    scene.GoToLast()
    simple.RenderAllViews()
    return layout


def arrange(simple, columns):
    """Make a layout with a view for each entry, in the column that it names."""
    layout = simple.CreateLayout("fields")
    counts = [columns.count(column) for column in dict.fromkeys(columns)]
    views = []
    for cell, count in zip(divide(layout.SplitHorizontal, 0, len(counts)), counts):
        for part in divide(layout.SplitVertical, cell, count):
            views.append(simple.CreateView("RenderView"))
            layout.AssignView(part, views[-1])
    layout.SetSize(VIEW[0] * len(counts), VIEW[1] * max(counts))
    return layout, views


def divide(split, cell, count):
    """Divide a cell of a layout into equal cells."""
    cells = []
    for left in range(count, 1, -1):
        cell = split(cell, 1 / left)
        cells.append(cell)
        cell += 1
    return [*cells, cell]


def draw(simple, view, name, reader, array, plane):
    """Show one series in its view."""
    display = simple.Show(reader, view)
    display.SetRepresentationType("Surface")
    display.Ambient, display.Diffuse = 1, 0  # Colours as in the legend, without light.
    simple.ColorBy(display, ("CELLS", array))
    display.RescaleTransferFunctionToDataRangeOverTime()
    scale = [1, 1, 1]
    scale[plane.up] = plane.stretch
    display.Scale = scale
    colours = simple.GetColorTransferFunction(array)
    colours.ApplyPreset("Viridis (matplotlib)", True)
    legend = simple.GetScalarBar(colours, view)
    legend.Title, legend.ComponentTitle = heading(array)
    legend.Orientation = "Vertical"
    legend.WindowLocation = "Any Location"
    legend.Position = [0.85, 0.16]
    legend.ScalarBarLength = 0.68
    display.SetScalarBarVisibility(view, True)
    title = name if plane.stretch == 1 else f"{name}, depth × {plane.stretch:g}"
    text = simple.Text(registrationName=f"title of {name}", Text=title)
    simple.Show(text, view).WindowLocation = "Upper Center"
    place(view, plane)


def heading(array):
    """Return the name and unit of an array, for its legend."""
    name, _, unit = array.rpartition(" ")
    return name.replace("_", " "), unit


def place(view, plane):
    """Look straight at the plane, with its axes in units of their size."""
    view.OrientationAxesVisibility = 0
    view.InteractionMode = "2D"
    view.CameraParallelProjection = 1
    grid = view.AxesGrid
    grid.Visibility = 1
    grid.AxesToLabel = LOWER
    units = [unit_of(high - low) for low, high in zip(plane.low, plane.high)]
    titles = [f"{axis} [{name}]" for axis, (name, _) in zip(AXES, units)]
    grid.XTitle, grid.YTitle, grid.ZTitle = titles
    scale = [metres for _, metres in units]
    scale[plane.up] *= plane.stretch
    grid.DataScale = scale
    middle = [(low + high) / 2 for low, high in zip(plane.low, plane.high)]
    middle[plane.up] *= plane.stretch
    width, height = plane.size[0], plane.size[1] * plane.stretch
    aspect = view.ViewSize[0] / view.ViewSize[1]
    half = max(height / FILLED[1], width / FILLED[0] / aspect) / 2
    middle[plane.right] += LEFT * 2 * half * aspect
    view.CameraFocalPoint = middle
    view.CameraPosition = [at + 10 * half * way for at, way in zip(middle, plane.look)]
    view.CameraViewUp = [float(axis == plane.up) for axis in range(3)]
    view.CameraParallelScale = half


# ParaView's window runs a state under the name __vtkconsole__.
if __name__ in ("__main__", "__vtkconsole__"):
    layout = show(found())
    if __name__ == "__main__":
        from paraview import simple

        picture = sys.argv[1] if len(sys.argv) > 1 else "fields.png"
        simple.SaveScreenshot(picture, layout)
