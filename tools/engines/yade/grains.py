# SPDX-License-Identifier: GPL-2.0-or-later
"""Discs or spheres of one size as bodies of YADE."""

import bplbm_solid
import numpy as np
from laws import Bonds, Springs


class Grains:
    """Particles of the fluid's scene: numbers on the wire and ids in YADE."""

    records = 1  # on the wire, of each body

    def __init__(self, fluid, yade):
        self.fluid, self.yade, self.O = fluid, yade, yade.O
        self.dimension = fluid.fluid.dimension
        self.lo, self.hi = fluid.vector("{}_lo"), fluid.vector("{}_hi")
        self.gravity = fluid.number("gravity") * fluid.vector("gravity_{}")
        self.periodic = np.array([a >= self.dimension or fluid.text(f"boundary_{'xyz'[a]}") == "p" for a in range(3)])
        self.walls = [a < self.dimension and fluid.number(f"walls_{'xyz'[a]}") != 0 for a in range(3)]
        self.r, self.density = fluid.number("diameter_max") / 2, fluid.number("density_max")
        self.ball = (bplbm_solid.disc(0, self.r, self.density, fluid.number("depth")) if self.dimension == 2
                     else bplbm_solid.sphere(0, self.r, self.density))
        self.measure()
        self.dt, self.substeps = fluid.number("solid_step"), int(fluid.number("substeps"))
        self.bodies, self.epochs, self.left = {}, {}, 0  # number -> id in YADE, interval of its insertion
        self.laws = Bonds(self) if fluid.number("bonded", 0) else Springs(self)
        self.material = self.O.materials.append(self.laws.material)
        self.load = {}  # number -> force and torque [2][3] that act now
        self.fresh = set()  # numbers whose velocities are still those that the scene gave
        self._build()

    def measure(self):
        """Mass, inertia and radii of a body, and what it is on the wire."""
        if self.fluid.number("diameter_min", 2 * self.r) != 2 * self.r:
            raise bplbm_solid.SolidError("the YADE engine has particles of one size: give particles.diameter one value", 2)
        self.mass, self.inertia = float(self.ball["mass"]), float(self.ball["inertia"])
        self.radii, self.shapes_of_one = (self.r, self.r), self.ball.reshape(1)

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
                                             verletDist=0.1 * self.radii[0]),
                     y.InteractionLoop(*self.laws.functors()),
                     y.PyRunner(command="exchange()", iterPeriod=self.substeps, initRun=True),
                     y.NewtonIntegrator(gravity=tuple(self.gravity), damping=self.laws.damping)]

    # ---- coming and going --------------------------------------------------------------------------------------------------

    def append(self, place):
        """@return  the id in YADE of a new body"""
        body = self.O.bodies.append(self.yade.utils.sphere(tuple(map(float, place)), self.r, material=self.material))
        state = self.O.bodies[body].state
        state.mass, state.inertia = self.mass, (self.inertia,) * 3
        return body

    def insert(self, number, place, velocity, epoch=0):
        body = self.append(place)
        state = self.O.bodies[body].state
        state.vel = tuple(map(float, velocity))
        if self.dimension == 2:
            state.blockedDOFs = "zXY"
        self.bodies[number], self.epochs[number] = body, epoch
        self._apply(number, np.zeros((2, 3)))

    def erase(self, body):
        self.O.bodies.erase(body)

    def remove(self, number):
        self._apply(number, np.zeros((2, 3)))  # YADE gives the id, with what acts on it, to the next body
        self.erase(self.bodies.pop(number))
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
                            self.fluid.interval)
            i += 1

    def remove_outside(self):
        for number, body in list(self.bodies.items()):
            x = self.O.bodies[body].state.pos
            if any(not self.periodic[a] and not self.lo[a] <= x[a] <= self.hi[a] for a in range(self.dimension)):
                self.remove(number)
                self.left += 1

    # ---- velocities and loads ----------------------------------------------------------------------------------------------
    # YADE's velocities are those of half a step before. Its scheme is velocity Verlet all the same: an exchange adds the
    # half-step of the forces that acted (contacts of now, the load of before), and takes that of the new load away.

    def acting(self, body):
        """Force and torque [2][3] of contacts and load, without the weight."""
        return np.array([self.O.forces.f(body), self.O.forces.t(body)])

    def velocities(self, body, kick):
        """Velocity and angular velocity after an impulse and its moment [2][3]."""
        state = self.O.bodies[body].state
        return np.array(state.vel) + kick[0] / self.mass, np.array(state.angVel) + kick[1] / self.inertia

    def kick(self, body, kick):
        """Gives a body an impulse and its moment [2][3]."""
        state = self.O.bodies[body].state
        state.vel, state.angVel = map(tuple, self.velocities(body, kick))

    def _half_step(self, body):
        return self.dt / 2 * (self.acting(body) + [self.mass * self.gravity, np.zeros(3)])

    def take(self, loads):
        """The new loads, and the velocities of half a step before them."""
        for (number, body), load in zip(self.bodies.items(), loads[::self.records]):
            new = np.array([load["force"], load["torque"]])
            if number in self.fresh:  # velocities of now
                self.kick(body, -self._half_step(body))
            self.kick(body, self.dt / 2 * (self.load[number] - new))
            self._apply(number, new)

    def _apply(self, number, load):
        self.load[number] = load
        self.O.forces.setPermF(self.bodies[number], tuple(load[0]))
        self.O.forces.setPermT(self.bodies[number], tuple(load[1]))

    # ---- what goes to the fluid --------------------------------------------------------------------------------------------

    def parts(self, body):
        """Ids in YADE of all that has a record, in their order."""
        return [body]

    def states(self):
        self.fresh = {number for number in self.bodies if self.epochs[number] == self.fluid.interval}
        found = np.zeros(self.records * len(self.bodies), bplbm_solid.STATE)
        found["id"] = self.shapes()["id"]
        records = iter(found)
        for number, body in self.bodies.items():
            kick = np.zeros((2, 3)) if number in self.fresh else self._half_step(body)
            v, omega = self.velocities(body, kick)
            centre = np.array(self.O.bodies[body].state.pos)
            for part in self.parts(body):
                s, x = next(records), np.array(self.O.bodies[part].state.pos)
                s["v"], s["omega"] = v + np.cross(omega, x - centre), omega
                s["x"] = np.where(self.periodic, self.lo + np.mod(x - self.lo, self.hi - self.lo), x)
                if self.dimension == 2:
                    s["x"][2] = s["v"][2] = s["omega"][0] = s["omega"][1] = 0
        return found

    def shapes(self):
        found = np.tile(self.shapes_of_one, len(self.bodies))
        found["id"] = np.repeat(list(self.bodies), self.records)
        found["epoch"] = np.repeat([self.epochs[number] for number in self.bodies], self.records)
        return found

    # ---- checkpoints -------------------------------------------------------------------------------------------------------

    def memory(self):
        """What the states lack for going on to the bit: YADE's own places and velocities, and the loads."""
        parts = [self.O.bodies[part].state for body in self.bodies.values() for part in self.parts(body)]
        return {"positions": np.array([[*s.pos] for s in parts]).reshape(-1, 3),
                "velocities": np.array([[*s.vel, *s.angVel] for s in parts]).reshape(-1, 6),
                "loads": np.array(list(self.load.values())).reshape(-1, 6), "epochs": np.array(list(self.epochs.values()))}

    def restore(self, states, memory):
        rows = zip(memory["positions"], memory["velocities"])
        for s, load, epoch in zip(states[::self.records], memory["loads"], memory["epochs"]):
            number = int(s["id"])
            self.insert(number, s["x"], s["v"], int(epoch))
            self._apply(number, load.reshape(2, 3))
            for part in self.parts(self.bodies[number]):
                state, (x, v) = self.O.bodies[part].state, next(rows)
                state.pos, state.vel, state.angVel = tuple(x), tuple(v[:3]), tuple(v[3:])
