# SPDX-License-Identifier: GPL-2.0-or-later
"""YADE as the solid: discs or spheres of one size between walls or in a periodic box, with YADE's own contact laws.

    mpirun -np 1 lbm scene.toml : -np 1 /usr/bin/python3 tools/engines/yade/engine.py
    tools/run SCENE --engine yade

It imports YADE as a module. (`yade -x engine.py` under mpirun would end in collective calls of YADE's own over all ranks of
the job, the fluid's included, and takes the script's arguments for its own.) Laws and variables: README.md of this folder.
"""

import math
import os
import pathlib
import sys

import numpy as np
from mpi4py import MPI  # noqa: F401  before YADE, which imports it, too

sys.path.append(str(pathlib.Path(__file__).resolve().parents[3] / "protocol" / "python"))  # where it is not installed
import bplbm_solid  # noqa: E402


def import_yade():
    """Debian's YADE is no module that Python finds. @throws SolidError"""
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # or else each step waits for as many threads as the machine has cores
    prefix = pathlib.Path(os.environ.get("YADE_PREFIX", "/usr"))
    for found in sorted(prefix.glob("lib*/**/yade*/py/yade/__init__.py")):
        sys.path.insert(1, str(found.parents[1]))
        break
    try:
        import yade
    except ImportError as error:
        raise bplbm_solid.SolidError(f"YADE cannot be imported ({error}); apt-get install yade, or set YADE_PREFIX", 2) from error
    return yade


class Grains:
    """Particles of the fluid's scene as bodies of YADE: numbers on the wire and ids in YADE."""

    def __init__(self, fluid, yade):
        self.fluid, self.yade, self.O = fluid, yade, yade.O
        self.dimension = fluid.fluid.dimension
        self.lo, self.hi = fluid.vector("{}_lo"), fluid.vector("{}_hi")
        self.gravity = fluid.number("gravity") * fluid.vector("gravity_{}")
        self.periodic = np.array([a >= self.dimension or fluid.text(f"boundary_{'xyz'[a]}") == "p" for a in range(3)])
        self.walls = [a < self.dimension and fluid.number(f"walls_{'xyz'[a]}") != 0 for a in range(3)]
        self.r, self.density = fluid.number("diameter_max") / 2, fluid.number("density_max")
        if fluid.number("diameter_min", 2 * self.r) != 2 * self.r:
            raise bplbm_solid.SolidError("the YADE engine has particles of one size: give particles.diameter one value", 2)
        self.ball = (bplbm_solid.disc(0, self.r, self.density, fluid.number("depth")) if self.dimension == 2
                     else bplbm_solid.sphere(0, self.r, self.density))
        self.mass, self.inertia = float(self.ball["mass"]), float(self.ball["inertia"])
        self.dt, self.substeps = fluid.number("solid_step"), int(fluid.number("substeps"))
        self.bodies, self.epochs, self.left = {}, {}, 0  # number -> id in YADE, interval of its insertion
        self.laws = Bonds(self) if fluid.number("bonded", 0) else Springs(self)
        self.material = self.O.materials.append(self.laws.material)
        self.load = {}  # number -> force and torque [2][3] that act now
        self._build()

    def _build(self):
        O, y = self.O, self.yade
        if self.periodic[:self.dimension].any():
            if not self.periodic.all():
                raise bplbm_solid.SolidError("YADE's boxes are periodic along all axes or none; change the scene's box.sides", 2)
            O.periodic = True
            size = self.hi - self.lo
            size[self.dimension:] = max(size)  # YADE's cell holds whole balls
            O.cell.setBox(*map(float, size))
        for axis in (a for a in range(3) if self.walls[a]):
            for place in (self.lo[axis], self.hi[axis]):
                O.bodies.append(y.utils.wall(float(place), axis, material=self.material))
        O.dt = self.dt
        O.engines = [y.ForceResetter(),
                     y.InsertionSortCollider([y.Bo1_Sphere_Aabb(aabbEnlargeFactor=self.laws.reach), y.Bo1_Wall_Aabb()],
                                             verletDist=0.1 * self.r),
                     y.InteractionLoop(*self.laws.functors()),
                     y.PyRunner(command="exchange()", iterPeriod=self.substeps, initRun=True),
                     y.NewtonIntegrator(gravity=tuple(self.gravity), damping=self.laws.damping)]

    def insert(self, number, place, velocity, spin=(0, 0, 0), epoch=0):
        O = self.O
        body = O.bodies.append(self.yade.utils.sphere(tuple(map(float, place)), self.r, material=self.material))
        state = O.bodies[body].state
        state.mass, state.inertia = self.mass, (self.inertia,) * 3
        state.vel, state.angVel = tuple(map(float, velocity)), tuple(map(float, spin))
        if self.dimension == 2:
            state.blockedDOFs = "zXY"
        self.bodies[number], self.epochs[number] = body, epoch
        self.load[number] = np.zeros((2, 3))
        self._apply(number)

    def remove(self, number):
        self.load[number][:] = 0
        self._apply(number)  # YADE gives the id, with what acts on it, to the next body
        self.O.bodies.erase(self.bodies.pop(number))
        del self.load[number], self.epochs[number]

    def change_by_scene(self):
        """Takes out and inserts what the scene says for this interval."""
        number = self.fluid.number
        i = 1
        while f"particle{i}_x" in self.fluid.variables:
            name = int(number(f"particle{i}_id", i))
            if number(f"particle{i}_until", -1) == self.fluid.interval and name in self.bodies:
                self.remove(name)
            if number(f"particle{i}_interval", 0) == self.fluid.interval:
                self.insert(name, self.fluid.vector(f"particle{i}_{{}}"), self.fluid.vector(f"particle{i}_v{{}}"),
                            epoch=self.fluid.interval)
            i += 1

    def remove_outside(self):
        for number, body in list(self.bodies.items()):
            x = self.O.bodies[body].state.pos
            if any(not self.periodic[a] and not self.lo[a] <= x[a] <= self.hi[a] for a in range(self.dimension)):
                self.remove(number)
                self.left += 1

    def _apply(self, number):
        force, torque = self.load[number]
        self.O.forces.setPermF(self.bodies[number], tuple(force))
        self.O.forces.setPermT(self.bodies[number], tuple(torque))

    # YADE's velocities are those of half a step before. Its scheme is velocity Verlet all the same: an exchange adds the
    # half-step of the forces that acted (contacts of now, the load of before), and takes that of the new load away again.

    def _half_steps(self, number):
        """What half a step of all that acts now adds to velocity and angular velocity."""
        body = self.bodies[number]
        force, torque = np.array(self.O.forces.f(body)), np.array(self.O.forces.t(body))
        return self.dt / 2 * (force / self.mass + self.gravity), self.dt / 2 * torque / self.inertia

    def states(self, begins):
        """@param begins  velocities are still those that the scene gave"""
        found = np.zeros(len(self.bodies), bplbm_solid.STATE)
        for s, (number, body) in zip(found, self.bodies.items()):
            state = self.O.bodies[body].state
            dv, dw = (0, 0) if begins or self.epochs[number] == self.fluid.interval > 0 else self._half_steps(number)
            s["id"], s["v"], s["omega"] = number, np.array(state.vel) + dv, np.array(state.angVel) + dw
            x = np.array(state.pos)
            s["x"] = np.where(self.periodic, self.lo + np.mod(x - self.lo, self.hi - self.lo), x)
            if self.dimension == 2:
                s["x"][2] = s["v"][2] = s["omega"][0] = s["omega"][1] = 0
        return found

    def shapes(self):
        found = np.full(len(self.bodies), self.ball)
        found["id"], found["epoch"] = list(self.bodies), [self.epochs[number] for number in self.bodies]
        return found

    def take(self, states, loads):
        """The new loads, and the velocities of half a step before them."""
        for s, load in zip(states, loads):
            number = int(s["id"])
            before = self.load[number].copy()
            self.load[number][:] = load["force"], load["torque"]
            dv, dw = self._half_steps(number)  # contacts of now and the load of before
            change = self.dt / 2 * (self.load[number] - before)
            state = self.O.bodies[self.bodies[number]].state
            state.vel = tuple(s["v"] - dv - change[0] / self.mass)
            state.angVel = tuple(s["omega"] - dw - change[1] / self.inertia)
            self._apply(number)

    def memory(self):
        """What the states lack for going on to the bit: YADE's own velocities, and the loads that acted."""
        bodies = [self.O.bodies[body].state for body in self.bodies.values()]
        return {"velocities": np.array([[*s.vel, *s.angVel] for s in bodies]).reshape(-1, 6),
                "positions": np.array([[*s.pos] for s in bodies]).reshape(-1, 3),
                "loads": np.array(list(self.load.values())).reshape(-1, 6), "epochs": np.array(list(self.epochs.values()))}

    def restore(self, states, memory):
        for s, v, x, load, epoch in zip(states, *(memory[n] for n in ("velocities", "positions", "loads", "epochs"))):
            number = int(s["id"])
            self.insert(number, x, v[:3], v[3:], int(epoch))
            self.load[number][:] = load.reshape(2, 3)
            self._apply(number)


class Springs:
    """Law2_ScGeom_ViscElPhys_Basic: F_n = k δ - γ v_n, and where the scene says `friction` tangential springs as stiff."""

    reach, damping = 1.0, 0.0

    def __init__(self, grains):
        number, y = grains.fluid.number, grains.yade
        self.y = y
        k = number("contact_stiffness")
        gamma = 2 * number("damping_ratio", 0.5) * math.sqrt(k * grains.mass)
        friction = number("friction", 0)
        self.checkpoints = friction == 0  # the springs' stretch is not kept
        # a contact takes two materials in series
        self.material = y.ViscElMat(density=grains.density, kn=2 * k, cn=2 * gamma, ks=2 * k if friction else 0, cs=0,
                                    frictionAngle=math.atan(friction))

    def functors(self):
        y = self.y
        return ([y.Ig2_Sphere_Sphere_ScGeom(), y.Ig2_Wall_Sphere_ScGeom()], [y.Ip2_ViscElMat_ViscElMat_ViscElPhys()],
                [y.Law2_ScGeom_ViscElPhys_Basic()])

    def report(self, grains):
        return bplbm_solid.Report(grains_left=grains.left)

    def begin(self, grains):
        pass


class Bonds:
    """Law2_ScGeom6D_CohFrictPhys_CohesionMoment: springs with friction, and at the start bonds across gaps of up to
    `bond_gap` (of a radius), which break at bond_strength and bond_shear_strength [N]."""

    checkpoints = False

    def __init__(self, grains):
        number, y = grains.fluid.number, grains.yade
        self.y = y
        self.stiffness = number("bond_stiffness", number("contact_stiffness"))
        self.strengths = number("bond_strength"), number("bond_shear_strength", number("bond_strength"))
        self.reach = 1 + number("bond_gap", 0.02) / 2
        self.damping = number("numerical_damping", 0.3)  # YADE's own: the law has no dashpots, and bonds would ring
        # of equal balls: kn = young × radius, ks = poisson × kn
        self.material = y.CohFrictMat(density=grains.density, young=self.stiffness / grains.r, poisson=1.0,
                                      frictionAngle=math.atan(number("friction", 0.5)), isCohesive=True, fragile=True,
                                      momentRotationLaw=False, normalCohesion=1.0, shearCohesion=1.0)
        self.intact, self.broken = {}, {1: [], 2: []}

    def functors(self):
        y = self.y
        self.touch = y.Ig2_Sphere_Sphere_ScGeom6D(interactionDetectionFactor=self.reach)
        self.make = y.Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True)
        return ([self.touch, y.Ig2_Wall_Sphere_ScGeom()], [self.make, y.Ip2_FrictMat_FrictMat_FrictPhys()],
                [y.Law2_ScGeom6D_CohFrictPhys_CohesionMoment(), y.Law2_ScGeom_FrictPhys_CundallStrack()])

    def begin(self, grains):
        """The contacts of the first step become bonds, at rest where they are; later ones do not."""
        numbers = {body: number for number, body in grains.bodies.items()}
        for i in grains.O.interactions:
            if i.isReal and i.id1 in numbers and i.id2 in numbers:
                i.phys.unp = i.geom.penetrationDepth
                i.phys.normalAdhesion, i.phys.shearAdhesion = self.strengths
                self.intact[i.id1, i.id2] = numbers[i.id1], numbers[i.id2]
        self.touch.interactionDetectionFactor = 1.0

    def report(self, grains):
        interactions = grains.O.interactions
        for pair in list(self.intact):
            there = interactions.has(*pair) and interactions[pair].isReal
            if not there or interactions[pair].phys.cohesionBroken:
                self.broken[2 if there else 1].append(self.intact.pop(pair))  # what was pulled apart touches no more
        bonds = [(*pair, 0) for pair in self.intact.values()] + [(*p, mode) for mode in (1, 2) for p in self.broken[mode]]
        counts = bplbm_solid.BondCounts(len(self.intact), len(self.broken[1]), len(self.broken[2]))
        return bplbm_solid.Report(grains.left, counts, np.array(bonds, bplbm_solid.BOND))


with bplbm_solid.Solid("yade") as fluid:
    if fluid.size > 1:
        raise bplbm_solid.SolidError("the YADE engine runs on one rank; start it with -np 1", 2)
    grains = Grains(fluid, import_yade())
    O = grains.O
    failed = []

    def exchange():
        """At the beginning of every interval, between YADE's contacts and its motion. What is raised here YADE would only
        print: it is kept, and raised again when YADE has stopped."""
        try:
            begins = O.iter == 0
            if begins:
                grains.laws.begin(grains)
            else:
                grains.remove_outside()
                grains.change_by_scene()
            states = grains.states(begins and not fluid.interval)
            loads = fluid.exchange(states, grains.shapes(), report=grains.laws.report(grains), memory=grains.memory)
            if loads is None:
                O.pause()
            else:
                grains.take(states, loads)
        except BaseException as error:  # noqa: BLE001
            failed.append(error)
            O.pause()

    if fluid.interval:
        grains.restore(*fluid.restart())
    else:
        grains.change_by_scene()
    fluid.agree(grains.lo, grains.hi, grains.periodic, grains.gravity, grains.dt, grains.substeps, len(grains.bodies),
                radius=(grains.r, grains.r), density=(grains.density, grains.density),
                walls=[wall for wall in grains.walls for _ in range(2)], checkpoints=grains.laws.checkpoints)
    O.run(-1, True)
    if failed:
        raise failed[0]
