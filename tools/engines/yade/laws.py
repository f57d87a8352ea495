# SPDX-License-Identifier: GPL-2.0-or-later
"""YADE's contact laws as the engine uses them: variables of the scene that set them are in README.md of this folder."""

import math

import bplbm_solid
import numpy as np


class Springs:
    """Law2_ScGeom_ViscElPhys_Basic: F_n = k δ - γ v_n; where the scene says `friction`, tangential springs as stiff."""

    reach, damping = 1.0, 0.0

    def __init__(self, grains):
        number, y = grains.fluid.number, grains.yade
        self.y = y
        k = number("contact_stiffness")
        gamma = 2 * number("damping_ratio", 0.5) * math.sqrt(k * float(grains.ball["mass"]))
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
