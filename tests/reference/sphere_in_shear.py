"""Fall of a sphere across the shear of a fluid whose viscosity depends on the shear rate: a variational solution, with which
the scenes mud_settling and proppant_in_gel compare. It shares only its splines with sphere_in_gel.py.

The sphere has radius 1 and velocity V e_z, and turns with the fluid, so that in its frame simple shear at the rate γ̇ is the
pure strain γ̇/2 (x, -y, 0), held on the surface of a hollow sphere around. Among fields without divergence creeping flow has
the least ∫∫ η dγ̇²/2 dV. What the sphere adds to the strain is a sum of poloidal and toroidal fields, spherical harmonics
that are even in x and y times quartic splines of ln r. Each step solves the linear problem with the viscosity of the last.
The force is what the residual does on the sphere's own velocity. In a Newtonian fluid the drag is Stokes' times
(1-λ⁵)/(1 - 9λ/4 + 5λ³/2 - 9λ⁵/4 + λ⁶), λ the ratio of the radii [Happel and Brenner 1965], which is printed beside it.

Usage: sphere_in_shear.py [RADIUS [ELEMENTS DEGREE]] (of the hollow sphere, 8; 16 elements, harmonics up to 8; needs numpy and
scipy; five minutes)
"""

import sys

import numpy as np
from numpy.polynomial.legendre import Legendre, leggauss
from sphere_in_gel import DEGREE, splines

TWICE = np.array([1, 1, 1, 2, 2, 2.0])  # of the components rr, θθ, φφ, rθ, rφ, θφ in e : e


class Harmonic:
    """s^m P_l^(m)(cos θ) / P_l^(m)(1) times cos mφ, or sin mφ where `turned`; s = sin θ. Values and derivatives at a grid."""

    def __init__(self, l, m, theta, phi, turned=False):  # noqa: E741
        x, s = np.cos(theta), np.sin(theta)
        p, dp = (Legendre.basis(l).deriv(k)(x) if k else Legendre.basis(l)(x) for k in (m, m + 1))
        one = Legendre.basis(l).deriv(m)(1.0) if m else 1.0
        value, first = s**m * p / one, (m * s ** (m - 1) * x * p if m else 0.0) / one - s ** (m + 1) * dp / one
        second = -x / s * first - (l * (l + 1) - m * m / s**2) * value
        along, across = np.cos(m * phi), -m * np.sin(m * phi)
        if turned:
            along, across = np.sin(m * phi), m * np.cos(m * phi)
        self.y, self.t, self.tt = np.outer(value, along), np.outer(first, along), np.outer(second, along)
        self.f = np.outer(value / s, across)  # ∂φ over s
        self.t_of_f = np.outer(first / s - value * x / s**2, across)
        self.cot_t, self.ff = np.outer(x / s * first, along), np.outer(value / s**2, -m * m * along)


def poloidal(h, degree, values):
    """Strain times r of u_r = F Y, u along the sphere = G grad Y, with G from the divergence."""
    f, df, ddf = values
    g, dg = (df + 2 * f) / (degree * (degree + 1)), (ddf + 2 * df) / (degree * (degree + 1))
    bend = 0.5 * (dg - g + f)
    return [[(df, h.y)], [(g, h.tt), (f, h.y)], [(g, h.ff + h.cot_t), (f, h.y)], [(bend, h.t)], [(bend, h.f)], [(g, h.t_of_f)]]


def toroidal(h, values):
    """Strain times r of u = H e_r × grad Z."""
    f, df, _ = values
    return [[], [(f, h.t_of_f)], [(-f, h.t_of_f)], [(0.5 * (df - f), h.f)], [(-0.5 * (df - f), h.t)],
            [(0.5 * f, h.ff - h.tt + h.cot_t)]]


class ShearedSphere:
    """Radius 1, in a hollow sphere of a radius, whose surface strains as the fluid far away does."""

    def __init__(self, outer, elements, degree, grading=1.0):
        x, wx = leggauss(2 * degree + 6)
        y, wy = leggauss(degree + 4)
        theta, phi = np.arccos(x), np.pi / 4 * (y + 1)  # a quarter turn: the field is even in x and y
        s, weight, values, knots = splines(np.log(outer), elements, grading)
        modes = [(kind, l, m) for l in range(1, degree + 1) for m in range(0, l + 1, 2)  # noqa: E741
                 for kind in ("poloidal", "toroidal") if m or kind == "poloidal"]
        self.count, self.size, self.elements = values[0].shape[1], values[0].shape[1] * len(modes), []
        harmonics = [Harmonic(l, m, theta, phi, kind == "toroidal") for kind, l, m in modes]
        self.far = far_strain(theta, phi)
        points, width = DEGREE + 2, DEGREE + 1
        for e in range(elements):
            rows, columns = slice(e * points, (e + 1) * points), slice(e, e + width)
            local, r = [v[rows, columns] for v in values], np.exp(s[rows])
            blocks = []
            for (kind, l, _), h in zip(modes, harmonics, strict=True):  # noqa: E741
                terms = poloidal(h, l, local) if kind == "poloidal" else toroidal(h, local)
                blocks.append(np.array([sum((np.einsum("ri,tp->rtpi", a / r[:, None], b) for a, b in component),
                                            np.zeros((points, len(theta), len(phi), width))) for component in terms]))
            strain = np.concatenate(blocks, axis=-1).reshape(6, -1, width * len(modes))
            place = np.concatenate([e + np.arange(width) + self.count * k for k in range(len(modes))])
            volume = np.einsum("r,t,p->rtp", weight[rows] * r**3, wx, wy * np.pi).ravel()
            self.elements.append((strain, place, volume, np.tile(self.far, points)))
        self.walls(modes, DEGREE / (knots[DEGREE + 1] - knots[1]))

    def walls(self, modes, slope):
        """No slip: values of F and its derivative at both spheres, or of H, are the outermost coefficients."""
        self.free, self.fall, self.still = np.ones(self.size, bool), np.zeros(self.size), np.zeros(self.size)
        for k, (kind, l, m) in enumerate(modes):  # noqa: E741
            first, last = k * self.count, (k + 1) * self.count - 1
            self.free[[first, last]] = False
            if kind == "toroidal":
                continue
            self.free[[first + 1, last - 1]] = False
            if (l, m) == (1, 0):
                self.fall[[first, first + 1]] = 1.0  # u = e_z
            if (l, m) == (2, 2):
                self.still[[first, first + 1]] = -0.5, -0.5 * (1 + 1 / slope)  # u takes the far strain off

    def residual(self, c, shear, viscosity):
        """∂(power)/∂c, and the matrix that it is linear by with the viscosity as it is."""
        matrix, residual = np.zeros((self.size, self.size)), np.zeros(self.size)
        for strain, place, volume, far in self.elements:
            e = strain @ c[place] + shear * far
            factor = 2 * viscosity(np.sqrt(2 * TWICE @ e**2)) * volume
            tested = strain * (TWICE[:, None] * factor)[:, :, None]
            matrix[np.ix_(place, place)] += np.tensordot(strain, tested, ((0, 1), (0, 1)))
            residual[place] += np.tensordot(e, tested, ((0, 1), (0, 1)))
        return residual, matrix

    def force(self, velocity, shear, viscosity, c=None, tolerance=1e-5, most=60):
        """That holds a velocity across a shear, and the coefficients, with which a similar fall may begin."""
        first, last = c is None, None
        c = np.zeros(self.size) if first else c.copy()
        c[~self.free] = (velocity * self.fall + shear * self.still)[~self.free]
        for step in range(most):
            residual, matrix = self.residual(c, shear, np.ones_like if first and step == 0 else viscosity)
            now = self.fall @ residual
            if last is not None and step > 2 and abs(now / last - 1) < tolerance:
                return now, c
            last = now
            c[self.free] -= np.linalg.solve(matrix[np.ix_(self.free, self.free)], residual[self.free])
        raise RuntimeError(f"no steady force after {most} steps: {last:g}, then {now:g}")


def far_strain(theta, phi):
    """Of ½ (x, -y, 0), in spherical components."""
    s, x, two = np.sin(theta)[:, None], np.cos(theta)[:, None], 2 * phi[None]
    along, across = np.cos(two), np.sin(two)
    return 0.5 * np.array([s**2 * along, x**2 * along, -along + 0 * x, s * x * along, -s * across, -x * across]).reshape(6, -1)


def over_novotny(speed, force, index):
    """A fall [D γ̇] over what Stokes' law with the viscosity at √(γ̇² + (V/D)²) says at its force [of the Newtonian drag]."""
    estimate = speed
    for _ in range(300):
        estimate = 0.5 * (estimate + force * (1 + estimate**2) ** ((1 - index) / 2))
    return speed / estimate


def main():
    outer = float(sys.argv[1]) if len(sys.argv) > 1 else 8.0
    sphere = ShearedSphere(outer, *(int(v) for v in (sys.argv[2:4] or (16, 8))))
    ratio = 1 / outer
    exact = (1 - ratio**5) / (1 - 9 / 4 * ratio + 5 / 2 * ratio**3 - 9 / 4 * ratio**5 + ratio**6)
    drag = sphere.force(0.1, 1.0, np.ones_like)[0] / 0.1
    print(f"hollow sphere of {outer:g} radii; Newtonian drag over Stokes' {drag / (6 * np.pi):.5f}, exact {exact:.5f}", flush=True)
    part = 0.15 / (0.15 + 13.7 / 15)  # the plastic viscosity of the mud of cases/mud_settling, of its apparent one
    c = None
    for speed in (0.03, 0.06, 0.13, 0.26):  # V/(D γ̇); the diameter is 2
        force, c = sphere.force(2 * speed, 1.0, lambda rate: np.minimum(part + (1 - part) / np.maximum(rate, 1e-9), 50), c)
        print(f"mud, V/(D γ̇) {speed:g}: velocity over that in oil of the apparent viscosity {drag * 2 * speed / force:.4f}", flush=True)
    index, c = 0.5, None
    for speed in (0.02, 0.05, 0.1, 0.2, 0.4, 0.8):
        force, c = sphere.force(2 * speed, 1.0, lambda rate: np.maximum(rate, 1e-3) ** (index - 1), c)
        print(f"gel of n {index:g}, V/(D γ̇) {speed:g}: velocity over Novotny's estimate at the same weight "
              f"{over_novotny(speed, force / (2 * drag), index):.4f}", flush=True)


if __name__ == "__main__":
    main()
