"""What a drawing of a scene says of it, and where its sides lie."""

import numpy as np

COLOR = {"pressure": "tab:blue", "velocity": "tab:green", "moving_wall": "tab:orange", "outflow": "tab:purple"}


def side_line(side, box, start, end):
    """Ends of a part of a side: x of both, y of both."""
    lx, ly = box
    return {"left": ([0, 0], [start, end]), "right": ([lx, lx], [start, end]),
            "bottom": ([start, end], [0, 0]), "top": ([start, end], [ly, ly])}[side]


def words(boundary):
    """A boundary condition in a few words."""
    kind = boundary["kind"].replace("_", " ")
    if "pressure" in boundary:
        pressure = boundary["pressure"]
        return f"{kind} {pressure / 1e3:g} kPa" if abs(pressure) >= 1e3 else f"{kind} {pressure:g} Pa" if pressure else f"{kind} 0"
    if "velocity" in boundary:
        return f"{kind} {np.linalg.norm(boundary['velocity']):g} m/s {boundary.get('profile', '')}".rstrip()
    return f"{kind} 0" if kind == "pressure" else kind


def motion_text(obstacle, dimension):
    """How an obstacle moves, in a few words; none for one that stands."""
    kind = obstacle.get("motion")
    if kind is None and "angular_velocity" not in obstacle:
        return ""
    where = " on its surface" if obstacle.get("surface_only") else ""
    if kind in ("rotation", None):
        speed = obstacle["angular_velocity"]
        if dimension == 2:
            return f"{abs(speed):g} rad/s {'↺' if speed > 0 else '↻'}{where}"
        axis = obstacle.get("axis", [0, 0, 1])
        seen = -speed * axis[1]  # along y, with x to the right and z upwards: y points away from the reader
        sense = " ↺" if seen > 0 else " ↻" if seen < 0 else ""
        return f"{speed:g} rad/s{sense} about ({', '.join(f'{v:g}' for v in axis)}){where}"
    if kind == "linear":
        return f"({', '.join(f'{v:g}' for v in obstacle['velocity'])}) m/s{where}"
    if kind == "oscillation":
        return f"oscillates at {obstacle['frequency']:g} Hz{where}"
    return f"moves as {obstacle['motion_table']}{where}"


def viscosity_text(fluid):
    """ν, or the law that it follows."""
    law = fluid.get("viscosity", {})
    model = law.get("model", "newtonian")
    if "kinematic_viscosity" in fluid:
        return f"ν = {fluid['kinematic_viscosity']:g} m²/s" + (", Smagorinsky" if model == "smagorinsky" else "")
    named = {"consistency": "K = {:g}" + (" Pa s" if model == "bingham" else " Pa sⁿ"), "index": "n = {:g}",
             "yield_stress": "σ_y = {:g} Pa", "time_constant": "λ = {:g} s"}
    return ", ".join([model.replace("_", " "), *(text.format(law[key]) for key, text in named.items() if key in law)])


def drive_text(scene):
    """Lines on the fluid, what drives it, and the particles."""
    fluid, box = scene["fluid"], scene["box"]
    parts = [f"ρ = {fluid['density']:g} kg/m³, {viscosity_text(fluid)}"]
    if any(fluid.get("gravity", [])):
        parts.append(f"g = {np.linalg.norm(fluid['gravity']):g} m/s² ↓")
    if any(fluid.get("body_force", [])):
        parts.append(f"body force {np.linalg.norm(fluid['body_force']):g} m/s² →")
    if "flow_rate" in fluid:
        parts.append(f"flow {fluid['flow_rate']:g} m³/s →")
    if any(box.get("pressure_jump", [])):
        parts.append(f"pressure jump {np.max(np.abs(box['pressure_jump'])):g} Pa")
    if "particles" in scene:
        d = np.atleast_1d(scene["particles"]["diameter"]) * 1e3
        what = "discs" if len(box["size"]) == 2 else "spheres"
        parts.append(f"{what} {' … '.join(f'{v:g}' for v in d)} mm, ρ_s = {np.max(scene['particles']['density']):g} kg/m³")
    return "\n".join(parts)
