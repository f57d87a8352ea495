# SPDX-License-Identifier: GPL-2.0-or-later
"""Equal clumps of discs or spheres as YADE's own clumps: one at each of the scene's places.

    [particles.variables]
    clump = "-0.001,0,0,0.002:0.001,0,0,0.002"      # x, y, z of each sphere about any point, and its radius [m]
"""

import bplbm_solid
import numpy as np
from grains import Grains

NEXT_SPHERE = 1_000_000  # what the numbers of a clump's spheres are apart


def parts_in(fluid):
    """Places and radius [n][4] of the spheres of a clump."""
    text, most = fluid.text("clump"), np.max(fluid.vector("{}_hi") - fluid.vector("{}_lo"))
    try:
        parts = np.array([[float(n) for n in part.split(",")] for part in text.split(":")]).reshape(-1, 4)
        if np.all(np.abs(parts) <= most) and np.all(parts[:, 3] > 0):
            return parts
    except ValueError:
        pass
    raise bplbm_solid.SolidError(f"the variable 'clump' = '{text}' is no list of x,y,z,r:x,y,z,r… with radii above 0, in a "
                                 "clump no larger than the box; correct [particles.variables]", bplbm_solid.errors.BAD_INPUT)


class Clumps(Grains):
    """A body is a clump of YADE; its spheres have records as well.

    YADE would count what overlaps twice, or sample it. So the spheres weigh nothing, and one more member of each clump
    that has no surface, at the centre of the union, has all of its mass and inertia."""

    def measure(self):
        parts = parts_in(self.fluid)
        if self.dimension == 2:
            parts[:, 2] = 0
        depth = self.fluid.number("depth") if self.dimension == 2 else 1.0
        clump = bplbm_solid.Clump(0, parts[:, :3], parts[:, 3], self.density, dimension=self.dimension, depth=depth,
                                  spheres=range(1, len(parts) + 1))
        self.mass, self.shapes_of_one, self.records = clump.mass, clump.shapes, len(parts) + 1
        self.principal, axes = np.linalg.eigh(clump.inertia)  # in two dimensions the last axis is z
        axes[:, 0] *= np.linalg.det(axes)
        self.turn, self.arms = axes, clump.arms @ axes
        self.inertia = self.principal[2]  # in two dimensions
        self.radii = parts[:, 3].min(), parts[:, 3].max()
        self.members = {}  # id of a clump -> those of its spheres
        if self.fluid.number("bonded", 0):
            raise bplbm_solid.SolidError("the YADE engine bonds grains, not clumps: leave 'bonded' or 'clump' out of "
                                         "[particles.variables]", bplbm_solid.errors.BAD_INPUT)

    def append(self, place):
        """YADE finds the principal axes itself; it is given the clump in these, at the origin, so that it finds them
        without an error, and then the clump is put where it belongs."""
        O, y = self.O, self.yade
        O.materials[self.material].density = 0.0
        heavy = y.utils.box((0, 0, 0), (self.radii[0],) * 3, material=self.material)
        heavy.bounded = False
        heavy.state.mass, heavy.state.inertia = self.mass, tuple(self.principal)
        spheres = [y.utils.sphere(tuple(arm), r, material=self.material)
                   for arm, r in zip(self.arms, self.shapes_of_one["radius"][1:])]
        clump, members = O.bodies.appendClumped([*spheres, heavy])
        self.members[clump] = members[:-1]
        body = O.bodies[clump]
        body.state.mass, body.state.inertia = self.mass, tuple(self.principal)
        body.aspherical = self.dimension == 3
        body.state.ori = y.Quaternion(y.Matrix3(*self.turn.ravel()))
        self._move(clump, place)
        return clump

    def _move(self, clump, place):
        state = self.O.bodies[clump].state
        state.pos = tuple(map(float, place))
        for member, arm in zip(self.members[clump], self.arms):
            self.O.bodies[member].state.pos = state.pos + state.ori * self.yade.Vector3(*arm)

    def insert(self, number, place, velocity, epoch=0):
        super().insert(number, place, velocity, epoch)
        for member in self.members[self.bodies[number]]:
            self.O.bodies[member].state.vel = tuple(map(float, velocity))

    def erase(self, body):
        del self.members[body]
        self.O.bodies.erase(body, True)  # its members, too

    def acting(self, body):
        """YADE adds the forces on members to the clump's only where it moves it."""
        total, centre = super().acting(body), np.array(self.O.bodies[body].state.pos)
        for member in self.members[body]:
            force, torque = super().acting(member)
            arm = np.array(self.O.bodies[member].state.pos) - centre
            total += [force, torque + np.cross(arm, force)]
        return total

    def velocities(self, body, kick):
        """In space YADE goes by the angular momentum."""
        if self.dimension == 2:
            return super().velocities(body, kick)
        state = self.O.bodies[body].state
        turn = np.array([state.ori * self.yade.Vector3(*axis) for axis in np.eye(3)]).T
        momentum = np.array(state.angMom) + kick[1]
        return np.array(state.vel) + kick[0] / self.mass, turn @ (turn.T @ momentum / self.principal)

    def kick(self, body, kick):
        super().kick(body, kick)
        state = self.O.bodies[body].state
        state.angMom = tuple(np.array(state.angMom) + kick[1])

    def parts(self, body):
        return [body, *self.members[body]]

    def shapes(self):
        found = super().shapes()
        sphere = np.tile(np.arange(self.records), len(self.bodies))
        found["carrier"] = np.where(sphere > 0, found["id"], -1)
        found["id"] += NEXT_SPHERE * sphere
        return found

    def memory(self):
        states = [self.O.bodies[body].state for body in self.bodies.values()]
        return dict(super().memory(), turns=np.array([[*s.ori, *s.angMom] for s in states]).reshape(-1, 7))

    def restore(self, states, memory):
        super().restore(states, memory)
        for body, row in zip(self.bodies.values(), memory["turns"]):
            state = self.O.bodies[body].state
            state.ori, state.angMom = self.yade.Quaternion(*row[[3, 0, 1, 2]]), tuple(row[4:])
