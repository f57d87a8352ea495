"""Shows this run in ParaView: the fluid's speed, grains and the spheres of clumps, obstacles and moving walls where they are,
intact bonds; broken bonds are hidden.

    pvpython view.py                           writes view.png beside this file
    pvpython view.py --time 0.5 --out a.png    (or pvbatch)
    paraview --script=view.py                  the same scene, ready, in the program

Without a screen it draws on one that xvfb-run (Debian: xvfb, xauth) makes. In three dimensions the fluid and the
solids are cut at the middle of the box, and what lies in front of the cut is left out. Light grey in the plane is what solids cover of
it. Beside it stand all solids whole, without the fluid, and walls that can be looked through.
"""

import argparse
import os
import shutil
import sys

try:
    import paraview
    from paraview import simple as pv
except ImportError:
    sys.exit("view | error | this Python has no ParaView; start it as: pvpython view.py, or paraview --script=view.py "
             "(Debian: apt install paraview); in plain Python, import bplbm reads the fields")

PIXELS = 1100  # of the longer side
GREEN, RED, GREY, DARK = [0.18, 0.56, 0.31], [0.84, 0.15, 0.16], [0.78, 0.76, 0.72], [0.2, 0.2, 0.2]
STONE = [0.45, 0.55, 0.66]  # of obstacles
MOST_CELLS = 50_000_000  # that are read, all frames together, to find the largest speed


def folder():
    here = globals().get("__file__") or "view.py"
    return os.path.dirname(os.path.abspath(here))


def arguments():
    p = argparse.ArgumentParser(prog="view.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--time", type=float, help="of the frame [s]; default: the last one")
    p.add_argument("--out", default=os.path.join(folder(), "view.png"), help="picture to write")
    p.add_argument("--broken", action="store_true", help="show broken bonds too, where they broke")
    p.add_argument("--field", default="velocity", choices=["velocity", "pressure", "viscosity"])
    return p.parse_args([] if paraview.fromGUI else sys.argv[1:])


def need_screen():
    """Debian's ParaView dies without a screen: begins anew with one that is made for it, or says what is missing."""
    if paraview.fromGUI or os.environ.get("DISPLAY") or sys.platform != "linux":
        return
    if shutil.which("xvfb-run") is None:
        sys.exit("view | error | there is no screen (DISPLAY) to draw on; install xvfb and xauth, or log in with one")
    program = os.path.basename(os.readlink("/proc/self/exe")).partition("-")[0]
    os.execvp("xvfb-run", ["xvfb-run", "-a", "-s", "-screen 0 1600x1400x24 -noreset", program, os.path.join(folder(), "view.py"),
                           *sys.argv[1:]])


def block(name):
    """A reader of one block of fields.xdmf; None where the run has no such block."""
    path = os.path.join(folder(), "fields.xdmf")
    with open(path) as text:
        if f'<Grid Name="{name}" GridType="Collection"' not in text.read():
            return None
    reader = pv.XDMFReader(registrationName=name, FileNames=[path])
    reader.UpdatePipelineInformation()
    reader.GridStatus = [grid for grid in reader.GridStatus.Available if grid.partition("[")[0] == name]  # a grid each frame
    reader.UpdatePipeline()
    return reader


def named(proxy, name):
    pv.RenameSource(name, proxy)
    return proxy


def fluid_and_solids(fluid, flat, bounds):
    """The fluid without what solids cover, and what they cover or None; in three dimensions at the middle of the box."""
    plane = fluid
    if not flat:
        plane = named(pv.Slice(Input=fluid, SliceType="Plane"), "cut")
        plane.SliceType.Origin = [0.5 * (bounds[k] + bounds[k + 1]) for k in (0, 2, 4)]
        plane.SliceType.Normal = [0, 1, 0]
    if not fluid.CellData.GetArray("solid_fraction"):
        return plane, None
    parts = (False, "fluid without solids"), (True, "solids in the plane")
    return [half_covered(plane, "solid_fraction", *part) for part in parts]


def half_covered(cells, array, solid, name):
    """The cells of which solids cover at least a half, or the others."""
    part = pv.Threshold(Input=cells, Scalars=["CELLS", array], LowerThreshold=0.5, UpperThreshold=0.5,
                        ThresholdMethod="Above Upper Threshold" if solid else "Below Lower Threshold")
    return named(part, name)


def highest(fluid, field, times):
    """Largest absolute value of a field over all frames; of the pressure that of half of the frames, since a first pulse or a blow
    would leave no colours to the flow. Over the present frame where they are many."""
    cells = fluid.GetDataInformation().GetNumberOfCells()
    peaks = []
    for time in times if cells * len(times) <= MOST_CELLS else []:
        fluid.UpdatePipeline(time)
        peaks.append(max(map(abs, reach(fluid, field))))
    peaks = sorted(peak for peak in peaks if peak) or [max(map(abs, reach(fluid, field)))]
    return peaks[len(peaks) // 2 if field == "pressure" else -1]


def reach(fluid, field):
    array = fluid.CellData.GetArray(field)
    low, high = array.GetRange(-1 if array.GetNumberOfComponents() > 1 else 0)
    return (low, high) if low <= high else (0.0, 0.0)


def colour(display, view, fluid, field, largest):
    """Colours of the field, the same in all frames, with a bar that names the unit."""
    vector = field == "velocity"
    pv.ColorBy(display, ("CELLS", field, "Magnitude") if vector else ("CELLS", field))
    table = pv.GetColorTransferFunction(field)
    table.ApplyPreset("Inferno (matplotlib)" if vector else "Cool to Warm", True)
    if field == "viscosity":
        low, high = reach(fluid, field)
        table.RescaleTransferFunction(low, high)
        table.MapControlPointsToLogSpace()
        table.UseLogScale = 1
    else:
        table.RescaleTransferFunction(0.0 if vector else -largest, largest or 1.0)
    bar = pv.GetScalarBar(table, view)
    bar.Title, bar.ComponentTitle = {"velocity": "speed [m/s]", "viscosity": "viscosity [m²/s]"}.get(field, "pressure [Pa]"), ""
    bar.TitleColor = bar.LabelColor = [0, 0, 0]
    bar.TitleFontSize = bar.LabelFontSize = 14
    bar.AutomaticLabelFormat, bar.LabelFormat, bar.RangeLabelFormat = 0, "%.3g", "%.3g"
    bar.WindowLocation = "Upper Right Corner"
    display.SetScalarBarVisibility(view, True)


def behind(points, flat, bounds):
    """Grains, ends of bonds or walls that the cut of the fluid leaves to be seen; all of them without bounds."""
    if flat or bounds is None:
        return points
    cut = pv.Clip(Input=points, ClipType="Plane", Invert=0)
    cut.ClipType.Origin = [0.5 * (bounds[k] + bounds[k + 1]) for k in (0, 2, 4)]
    cut.ClipType.Origin[1] += 1e-4 * (bounds[3] - bounds[2])  # else a face would lie in the plane of the fluid
    cut.ClipType.Normal = [0, 1, 0]
    return cut


def glyphs(points, flat, part, name):
    """A disc or sphere at each point. part: of its radius."""
    glyph = pv.Glyph(Input=points, GlyphType="Cylinder" if flat else "Sphere", ScaleArray=["POINTS", "radius"],
                     ScaleFactor=2.0 * part, OrientationArray=["POINTS", "No orientation array"], GlyphMode="All Points")
    if not flat:
        glyph.GlyphType.ThetaResolution = glyph.GlyphType.PhiResolution = 16
    if flat:
        glyph.GlyphType.Resolution, glyph.GlyphType.Height = 24, 1e-4
        glyph.GlyphTransform.Rotate = [90.0, 0.0, 0.0]
    return named(glyph, name)


def plain(source, view, rgb, lift, width=None):
    """Shows it in one colour; in two dimensions lifted a little before what lies behind."""
    display = pv.Show(source, view)
    display.ColorArrayName = [None, ""]  # pv.ColorBy fails where there is nothing to be seen
    display.AmbientColor = display.DiffuseColor = rgb
    display.Position = [0.0, 0.0, lift]
    if lift:  # flat: no light
        display.Ambient, display.Diffuse = 1.0, 0.0
    if width:
        display.LineWidth = width
    return display


def show_balls(view, flat, bounds, cell, name, words, rgb):
    """Discs with rims, or spheres, of a block of centres and radii."""
    balls = block(name)
    if balls:
        if flat:
            plain(glyphs(balls, flat, 1.0, f"rims of {words}"), view, DARK, 0.2 * cell)
        whole = glyphs(balls, flat, 0.9 if flat else 1.0, words)
        cut = whole if flat or bounds is None else named(behind(whole, flat, bounds), f"{words} behind the plane")
        display = plain(cut, view, rgb, 0.3 * cell * flat)
        display.Opacity = 0.35 if not flat and bounds is None and block("bonds") else 1.0  # bonds lie inside of grains


def show_obstacles(view, flat, bounds, cell, fluid, covered):
    """What does not move by the flow: walls where they are, round ones, images, and the plane's part of all solids."""
    if covered:
        display = plain(covered, view, GREY, 0.0)
        display.Ambient, display.Diffuse = 1.0, 0.0
    if fluid.CellData.GetArray("image_fraction"):
        whole = half_covered(fluid, "image_fraction", True, "image")
        name = "image behind the plane" if bounds else "image whole"
        display = plain(named(behind(whole, flat, bounds), name), view, STONE, 0.05 * cell * flat)
        display.SetRepresentationType("Surface")
    walls = block("walls")
    if walls:
        display = plain(named(behind(walls, flat, bounds), "walls behind the plane" if bounds else "walls whole"), view,
                        DARK if flat else STONE, 0.35 * cell * flat, 2.0)
        display.Opacity = 1.0 if bounds else 0.4
    show_balls(view, flat, bounds, cell, "round_obstacles", "round obstacles", STONE)


def show_solids(view, flat, bounds, cell, broken):
    show_balls(view, flat, bounds, cell, "particles", "grains", GREY)
    for name, rgb, visible in (("bonds", GREEN, True), ("broken_bonds", RED, broken)):
        bonds = block(name)
        if bonds:
            plain(behind(bonds, flat, bounds), view, rgb, 0.4 * cell * flat, 2.0).Visibility = int(visible)


def beside(view, fluid, cell, broken):
    """A second view of three dimensions: all solids whole."""
    other = pv.CreateRenderView()
    pv.AssignViewToLayout(view=other, layout=pv.GetLayout(view), hint=0)
    white(other)
    show_obstacles(other, False, None, cell, fluid, None)
    show_solids(other, False, None, cell, broken)
    frame(other, fluid)
    return other


def white(view):
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.OrientationAxesVisibility = 0


def frame(view, fluid):
    box = pv.Show(named(pv.Outline(Input=fluid), "box"), view)
    box.AmbientColor = box.DiffuseColor = [0.3, 0.3, 0.3]


def look(view, flat, bounds):
    """The camera: from above onto the plane, or at an angle from the front."""
    size = [bounds[k + 1] - bounds[k] for k in (0, 2, 4)]
    centre = [0.5 * (bounds[k] + bounds[k + 1]) for k in (0, 2, 4)]
    away = [0.0, 0.0, 1.0] if flat else [-0.35, -1.0, 0.35]
    across, up = (size[0], size[1]) if flat else (1.05 * size[0] + 0.4 * size[1], size[2] + 0.4 * size[1])
    longest = max(across, up)
    view.ViewSize = [int(PIXELS * max(0.45, across / longest)) + 140, int(PIXELS * max(0.45, up / longest))]
    view.CameraFocalPoint = centre
    view.CameraPosition = [c + 3.0 * sum(size) * a for c, a in zip(centre, away)]
    view.CameraViewUp = [0, 1, 0] if flat else [0, 0, 1]
    view.CameraParallelProjection = 1
    wide = (across + 140 / PIXELS * longest) * view.ViewSize[1] / view.ViewSize[0]
    view.CameraParallelScale = 0.53 * max(up, wide)


def main():
    args = arguments()
    need_screen()
    view = pv.GetActiveViewOrCreate("RenderView")
    white(view)
    fluid = block("fluid")
    if fluid.CellData.GetArray(args.field) is None:
        sys.exit(f"view | error | the fields of this run have no {args.field}; a scene's output.viscosity = true writes it")
    times = list(fluid.TimestepValues) or [0.0]
    bounds = fluid.GetDataInformation().GetBounds()
    cells = fluid.GetDataInformation().GetExtent()
    flat = cells[5] - cells[4] == 1
    largest = highest(fluid, args.field, times)
    shown, covered = fluid_and_solids(fluid, flat, bounds)
    display = pv.Show(shown, view)
    display.SetRepresentationType("Surface")
    display.Ambient, display.Diffuse = 1.0, 0.0  # in the light its colours would not be those of the bar
    colour(display, view, fluid, args.field, largest)
    cell = (bounds[1] - bounds[0]) / (cells[1] - cells[0])
    show_obstacles(view, flat, bounds, cell, fluid, covered)
    show_solids(view, flat, bounds, cell, args.broken)
    frame(view, fluid)
    label = pv.Show(pv.AnnotateTimeFilter(Input=fluid, Format="t = {time:.4g} s"), view)
    label.Color, label.FontSize, label.WindowLocation = [0, 0, 0], 14, "Lower Right Corner"
    solids = fluid.CellData.GetArray("solid_fraction") is not None
    views = [view] if flat or not solids else [view, beside(view, fluid, cell, args.broken)]
    for each in views:
        look(each, flat, bounds)
    scene = pv.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    scene.AnimationTime = times[-1] if args.time is None else min(times, key=lambda t: abs(t - args.time))
    if paraview.fromGUI:
        pv.RenderAllViews()
        return
    size = [len(views) * view.ViewSize[0], view.ViewSize[1]]
    pv.GetLayout(view).SetSize(*size)
    pv.SaveScreenshot(args.out, pv.GetLayout(view), ImageResolution=size)
    print(f"view | picture {args.out}")


main()
