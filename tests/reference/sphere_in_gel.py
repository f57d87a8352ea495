"""Drag of a sphere in the middle of a hollow one at rest, in a fluid whose viscosity depends on the shear rate: a variational
solution, with which docs/viscosity.md and tests/physics/viscosity_test.cpp compare.

Among fields without divergence creeping flow has the least potential ∫∫ η dγ̇²/2 dV. The stream function is a sum of
Legendre modes (odd ones: fore and aft are alike) with quartic splines of ln r; each step solves the linear problem with the
viscosity of the last. The drag is dissipation over velocity. In a Newtonian fluid it is 6πKRU λ-corrected to five digits
[Happel and Brenner 1965]: 2.1049 at four radii, 1.0023 at a thousand. Far from the sphere the velocity falls as r^(1-2/n):
with n = 1.5 walls at 10³, 10⁵ and 10⁷ radii make the drag 0.3221, 0.2751, 0.2664, so thickening fluids are computed at 10⁹.

Usage: sphere_in_gel.py (needs numpy and scipy; ten minutes)
"""

import numpy as np
from numpy.polynomial.legendre import Legendre, leggauss
from scipy.interpolate import BSpline

DEGREE = 4


class Sphere:
    """Radius 1, velocity 1, in a hollow sphere of a radius."""

    def __init__(self, outer, elements, modes, angles, grading=1.0):
        s, weight, values, knots = splines(np.log(outer), elements, grading)
        r, x, w = np.exp(s)[:, None], *half_gauss(angles)
        self.count, self.modes = values[0].shape[1], modes
        self.strain = [np.empty((len(s) * len(x), self.count * modes)) for _ in range(4)]
        for mode in range(modes):
            for whole, part in zip(self.strain, strain_rates(2 * mode + 1, r, x, values), strict=True):
                whole[:, mode * self.count:(mode + 1) * self.count] = part
        self.weight = ((weight * np.exp(s) ** 3)[:, None] * w).ravel() * 2 * np.pi
        self.start, self.free = self.walls(DEGREE / (knots[DEGREE + 1] - knots[1]))

    def walls(self, slope):
        """No slip: the radial mode and its derivative at both spheres are the first and the last two coefficients."""
        start, free = np.zeros(self.count * self.modes), np.ones(self.count * self.modes, bool)
        for mode in range(self.modes):
            first = mode * self.count
            free[[first, first + 1, first + self.count - 2, first + self.count - 1]] = False
        start[:2] = 1.0, 1.0 + 2.0 / slope  # r² cos θ
        return start, free

    def shear_rate(self, c):
        rr, tt, pp, rt = (e @ c for e in self.strain)
        return np.sqrt(2 * (rr**2 + tt**2 + pp**2 + 2 * rt**2))

    def drag(self, viscosity, c=None, tolerance=1e-6, most=100):
        """Drag with viscosity(γ̇), and the coefficients, with which a similar fluid may begin."""
        rate, last = np.full(self.weight.shape, 0.5) if c is None else self.shear_rate(c), None
        for _ in range(most):
            factor, matrix = 2 * viscosity(rate) * self.weight, 0
            for e, times in zip(self.strain, (1, 1, 1, 2), strict=True):
                matrix = matrix + (e * (times * factor)[:, None]).T @ e
            c = self.start.copy()
            c[self.free] = np.linalg.solve(matrix[np.ix_(self.free, self.free)], -(matrix @ self.start)[self.free])
            rate = self.shear_rate(c)
            drag = np.sum(self.weight * viscosity(rate) * rate**2)
            if last is not None and abs(drag / last - 1) < tolerance:
                break
            last = drag
        return drag, c


def splines(length, elements, grading):
    """Gauss points, weights, the splines' values and first two derivatives there, and knots; finer at the sphere."""
    t = np.linspace(0, 1, elements + 1)
    borders = length * (np.exp(grading * t) - 1) / (np.exp(grading) - 1)
    borders[-1] = length  # round-off may put it beyond the knots at the end
    knots = np.r_[[0] * DEGREE, borders, [length] * DEGREE]
    x, w = leggauss(DEGREE + 2)
    half, middle = np.diff(borders)[:, None] / 2, (borders[1:] + borders[:-1])[:, None] / 2
    s, weight = (middle + half * x).ravel(), (half * w).ravel()
    base = [BSpline(knots, row, DEGREE) for row in np.eye(len(knots) - DEGREE - 1)]
    return s, weight, [np.array([(b.derivative(d) if d else b)(s) for b in base]).T for d in range(3)], knots


def half_gauss(points):
    """Of cos θ from 0 to 1, for both halves."""
    x, w = leggauss(2 * points)
    return x[x > 0], 2 * w[x > 0]


def strain_rates(k, r, x, values):
    """Of u_r = F P_k, u_θ = G dP_k/dθ with r² F a spline of ln r and G from the divergence: rr, θθ, φφ, rθ."""
    h, first, second = values
    p, p1, p2 = (Legendre.basis(k).deriv(d)(x) if d else Legendre.basis(k)(x) for d in range(3))
    sine = np.sqrt(1 - x * x)
    f, df, hr, hrr = h / r**2, (first - 2 * h) / r**3, first / r, (second - first) / r**2
    g, dg = hr / (k * (k + 1) * r), (hrr - hr / r) / (k * (k + 1) * r)
    both = lambda a, b: np.einsum("ij,l->ilj", a, b).reshape(len(a) * len(b), -1)  # noqa: E731
    return (both(df, p), both(g / r, sine**2 * p2 - x * p1) + both(f / r, p), both(f / r, p) + both(g / r, -x * p1),
            both(0.5 * (dg - g / r + f / r), -sine * p1))


def main():
    for outer, elements in ((4.0, 20), (1000.0, 40)):
        sphere, c = Sphere(outer, elements, 8, 26), None
        for n in (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3):
            drag, c = sphere.drag(lambda rate, n=n: np.maximum(rate, 1e-12) ** (n - 1), c)
            print(f"outer radius {outer:g}, n {n:g}: F/(3π K D² (U/D)ⁿ) = {drag / (12 * np.pi * 2**-n):.4f}", flush=True)
    for outer, elements, modes, angles in ((4.0, 20, 8, 26), (1e9, 70, 6, 20)):
        sphere, c = Sphere(outer, elements, modes, angles), None
        for n in (1.0, 1.2, 1.35, 1.5):
            drag, c = sphere.drag(lambda rate, n=n: np.maximum(rate, 1e-300) ** (n - 1), c)
            print(f"outer radius {outer:g}, n {n:g}: F/(3π K D² (U/D)ⁿ) = {drag / (12 * np.pi * 2**-n):.4f}", flush=True)
    sphere, c = Sphere(4.0, 30, 12, 32, 2.0), None
    for bingham in (30.0, 300.0, 1600.0):  # σ_y D/(K U); bi-viscosity, thirty times the viscosity at U/D
        stress = bingham / 2
        drag, c = sphere.drag(lambda rate, b=bingham, t=stress: np.minimum(1 + t / np.maximum(rate, 1e-12), 30 * (1 + b)), c, 1e-4)
        print(f"Bingham number {bingham:g}: σ_y/(Δρ g D) = {np.pi / 6 * 4 * stress / drag:.4f}", flush=True)


if __name__ == "__main__":
    main()
