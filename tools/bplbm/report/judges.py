"""What is asked of a hard case: judges of its runs, each returns whether it is met (None: told, not judged) and the value."""

import re

import numpy as np

from bplbm.report.cases import CASES_OF
from bplbm.report.runs import module_of
from bplbm.results import read_table


def percent(part):
    """Text of a part of one."""
    return f"{100 * part:.2g} %" if abs(part) < 1 else f"{100 * part:.0f} %"


def force_of(run, begin, end):
    """Vertical force on the disc at each step of a time [s], over its weight."""
    p, table = run.parameters, run.probes()
    weight = p["particle_density"] * np.pi / 4 * p["diameter"]**2 * p["depth"] * -p["gravity_y"]
    return table["fy"][(table["time"] > begin) & (table["time"] < end)] / weight


def noise(begin, end):
    """Change of the force on a disc from one step to the next, rms over its weight: 5 %. (What a running mean of 50
    steps takes away is twice that, since it holds the passing of whole cells, of 23 steps each.)"""
    def judge(runs):
        change = np.std(np.diff(force_of(runs[0], begin, end)))
        return bool(change <= 0.05), percent(change)
    return judge


def noises(begin, end):
    """The same of each run, told."""
    def judge(runs):
        return None, " ".join(f"{100 * np.std(np.diff(force_of(run, begin, end))):.2g}" for run in runs) + " %"
    return judge


def jump(begin, end):
    """Largest change of the force on a disc from one step to the next over its weight: 5 %."""
    def judge(runs):
        largest = np.abs(np.diff(force_of(runs[0], begin, end))).max()
        return bool(largest <= 0.05), percent(largest)
    return judge


def rest(runs):
    """Largest speed of a disc over C: 1e-10."""
    p, table = runs[0].parameters, runs[0].probes()
    speed = np.hypot(table["vx"], table["vy"]).max() * p["time_step"] / p["cell"]
    return bool(speed <= 1e-10), f"{speed:.0e}"


def gel_flow(mean, tolerance):
    """Mean velocity [m/s] of a fluid alone in a channel at the end, within a part of it."""
    def judge(runs):
        run = runs[0]
        error = run.frame(run.frames()[-1][1])["velocity"][..., 0].mean() / mean - 1
        return bool(abs(error) <= tolerance), f"{100 * error:+.2g} %"
    return judge


def held(runs):
    """A disc's speed at the end over that in a Newtonian fluid of nu_max, between walls ten diameters apart [Faxén 1946]: it creeps
    so within 10 %. That of a second one, which nothing holds, over it: at least ten."""
    first, second = (abs(run.probes()["vy"][-1]) for run in runs)
    p, wide = runs[0].parameters, runs[0].parameters["box_x"] / runs[0].parameters["diameter"]
    stress = (p["particle_density"] / p["density"] - 1) * -p["gravity_y"]
    creep = stress * p["diameter"]**2 / (16 * 7.4e-3) * (np.log(wide) - 0.9157 + 1.7244 / wide**2)
    return bool(abs(first / creep - 1) <= 0.1 and second >= 10 * first), f"{100 * (first / creep - 1):+.1f} % {second / first:.0f}×"


def overshoot(runs):
    """Of the highest pressure over that of the inlet: 10 %."""
    run = runs[0]
    over = max(np.nanmax(run.frame(name)["pressure"]) for _, name in run.frames()) / 6.0e5 - 1
    return bool(over <= 0.1), f"{100 * over:+.0f} %"


def drags(runs):
    """Errors of the array's drag [%]."""
    case = CASES_OF["array"]
    return [100 * (case.value(run, module_of(case.scene)) / case.reference - 1) for run in runs]


def flat(runs):
    """Half of the range of the drag: 1 %."""
    half = np.ptp(drags(runs)) / 2
    return bool(half <= 1.0), f"±{half:.2g} %"


def told(runs):
    return None, " ".join(f"{e:+.0f}" for e in drags(runs)) + " %"


def drift(most):
    """Of the mass in 1e5 steps."""
    def judge(runs):
        s = runs[0].summary
        lost = abs(s["mass_drift"]) * 1e5 / s["steps"]
        return bool(lost <= most), f"{lost:.0e}"
    return judge


def order(runs):
    """Distance of the ways of two discs that changed their numbers, over a diameter: 1e-10."""
    d = runs[0].parameters["diameter"]
    far = max(np.abs(runs[0].probes(a)[x] - runs[1].probes(3 - a)[x]).max() for a in (1, 2) for x in "xy") / d
    return bool(far <= 1e-10), f"{far:.0e}"


def same_way(shift=0.0):
    """Distance of the ways of a disc and of one that began a part of the period further on, over a diameter: 1e-10."""
    def judge(runs):
        p = runs[0].parameters
        a, b = (run.probes() for run in runs)
        along = b["x"] - a["x"] + shift * p["box_x"]
        far = max(np.abs(along - p["box_x"] * np.round(along / p["box_x"])).max(), np.abs(a["y"] - b["y"]).max()) / p["diameter"]
        return bool(far <= 1e-10), f"{far:.0e}"
    return judge


def alike(runs):
    """Range of the largest fall velocity over its mean: 1 %."""
    speeds = [-run.probes()["vy"].min() for run in runs]
    part = np.ptp(speeds) / np.mean(speeds)
    return bool(part <= 0.01), percent(part)


def rises(runs):
    """Velocities at the end [mm/s]."""
    return None, " ".join(f"{1e3 * run.probes()['vy'][-1]:.1f}" for run in runs) + " mm/s"


def street(runs):
    """Error of the largest drag coefficient of a vortex street after 6 s; Schäfer and Turek 2D-2."""
    time, drag, *_ = module_of("cylinder_flow").coefficients(runs[0])
    return None, f"{100 * (drag[time > 6.0].max() / 3.227393 - 1):+.1f} %"


def channel(runs):
    """Errors of the mean velocity in the middle of poiseuille, driven by 8 Pa/m [%]."""
    errors = []
    for run in runs:
        p, u = run.parameters, run.frame(run.frames()[-1][1])["velocity"][:, :, 0]
        exact = 8.0 / p["density"] * p["box_y"]**2 / (12 * p["kinematic_viscosity"])
        errors.append(100 * (u[:, u.shape[1] // 2].mean() / exact - 1))
    return None, " ".join(f"{e:+.1f}" for e in errors) + " %"


def warned(runs):
    """Largest speed of the fluid over C, of a run that must be warned of once it is above 0.1."""
    said = (runs[0].folder / "lbm.log").read_text().count("above 0.1: compressibility error")
    return said == 1, f"{runs[0].summary['ma_paper']:.2g} C"


# ---- bonds ---------------------------------------------------------------------------------------------------------


def discs_of(run):
    """What tests/hard/bond_burst writes at the beginning of each interval: [interval][disc][column] of its dump."""
    frames = (run.folder / "discs.txt").read_text().split("ITEM: TIMESTEP\n")[1:]
    return np.array([[line.split() for line in frame.splitlines()[8:]] for frame in frames], float)


def energies_of(run):
    """Of the bonds and contacts, from the ledger [interval]."""
    log = (run.folder / "liggghts.log").read_text()
    lines = re.findall(r"^ +\d+(?: +[-\d.e+]+){6} *$", log, re.MULTILINE)
    return np.array([line.split() for line in lines], float)[:, 2:].sum(axis=1)


def burst(runs):
    """A block of bonded discs that flies apart: change of the discs' momentum and the fluid's impulses on them, over
    all that they had, 1e-12 (bonds and contacts act on both sides alike); change of all energies and the fluid's work,
    over what they had, 1 %."""
    discs, dt = discs_of(runs[0]), runs[0].parameters["interval"]
    mass, radius, x, v = discs[..., 1], discs[..., 2], discs[..., 3:5], discs[..., 5:7]
    spin, force, torque = discs[..., 7], discs[..., 8:10], discs[..., 10]
    momentum, impulses = (mass[..., None] * v).sum(axis=1), dt * force[:-1].sum(axis=1).cumsum(axis=0)
    rest = np.abs(momentum[1:] - momentum[0] - impulses).max() / (mass[0, :, None] * np.abs(v[0])).sum()
    work = (force[:-1] * (x[1:] - x[:-1])).sum(axis=(1, 2)) + (torque[:-1] * (spin[:-1] + spin[1:])).sum(axis=1) * dt / 2
    energy = (mass * (v**2).sum(axis=2) / 2 + mass * radius**2 * spin**2 / 4).sum(axis=1) + energies_of(runs[0])
    open_ledger = np.abs(energy[1:] - energy[0] - work.cumsum()).max() / energy[0]
    return bool(rest <= 1e-12 and open_ledger <= 0.01), f"{rest:.0e} {percent(open_ledger)}"


def breaks_alike(runs):
    """Range of the times at which the only bond breaks over their mean: 1 %."""
    times = [read_table(run.folder / "breaks.csv").get("time", np.zeros(0)) for run in runs]
    if any(len(t) != 1 for t in times):
        return False, "no break"
    part = np.ptp(times) / np.mean(times)
    return bool(part <= 0.01), percent(part)


# ---- single steps of the fluid: of the values of step_report ---------------------------------------------------------


def at_most(**limits):
    """Each of some values."""
    def judge(values):
        return all(values[key] <= limit for key, limit in limits.items()), " ".join(f"{values[key]:.0e}" for key in limits)
    judge.keys = tuple(limits)
    return judge


def carried(values):
    """Drag in a frame that moves at 0.02, 0.05 and 0.1 C against one at rest: 1 %; BGK and TRT, whose equilibrium is of
    second order, 1.5 % at 0.05 and 6 % at 0.1."""
    limits = (0.01, 0.015, 0.06) if values["collision"] in ("bgk", "trt") else (0.01, 0.01, 0.01)
    met = all(abs(part) <= limit for part, limit in zip(values["drift"], limits, strict=True))
    return met, " ".join(f"{100 * part:+.1f}" for part in values["drift"]) + " %"


carried.keys = ("drift",)
