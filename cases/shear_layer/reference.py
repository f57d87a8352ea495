"""The reference of this scene: the same flow, incompressible, by a pseudo-spectral method (vorticity, Fourier modes cut at
two thirds, fourth-order Runge–Kutta with the viscosity exact). Usage: reference.py [MODES], 512 by default: a quarter of
an hour. It shares nothing with lbm."""

import sys

import numpy as np

RE, KAPPA, PERTURBATION, END = 1e4, 80.0, 0.05, 1.5


def main(n):
    x = (np.arange(n) + 0.5) / n
    x, y = np.meshgrid(x, x)
    u = np.tanh(KAPPA * np.where(y <= 0.5, y - 0.25, 0.75 - y))
    v = PERTURBATION * np.sin(2 * np.pi * (x + 0.25))
    kx = 2 * np.pi * np.arange(n // 2 + 1)[None, :]
    ky = 2 * np.pi * np.fft.fftfreq(n, 1 / n)[:, None]
    k2 = kx**2 + ky**2
    per_k2 = np.divide(1.0, k2, out=np.zeros_like(k2), where=k2 > 0)
    kept = ((np.abs(kx) < 2 / 3 * np.pi * n) & (np.abs(ky) < 2 / 3 * np.pi * n)).astype(float)

    def velocity(w):
        return np.fft.irfft2(1j * ky * w * per_k2), np.fft.irfft2(-1j * kx * w * per_k2)

    def advection(w):
        u, v = velocity(w)
        return -kept * np.fft.rfft2(u * np.fft.irfft2(1j * kx * w) + v * np.fft.irfft2(1j * ky * w))

    w = kept * (1j * kx * np.fft.rfft2(v) - 1j * ky * np.fft.rfft2(u))
    steps = int(np.ceil(END * n * 1.5 / 0.4))  # a Courant number of 0.4 at a speed of 1.5
    dt = END / steps
    half = np.exp(-k2 * dt / 2 / RE)
    whole = half * half
    energy = np.mean(u**2 + v**2)
    for _ in range(steps):
        a = dt * advection(w)
        b = dt * advection(half * (w + a / 2))
        c = dt * advection(half * w + b / 2)
        d = dt * advection(whole * w + half * c)
        w = whole * w + (whole * a + 2 * half * (b + c) + d) / 6
    u, v = velocity(w)
    print(f"{n} modes: largest speed {np.hypot(u, v).max():.5f} U, energy {np.mean(u**2 + v**2) / energy:.6f} of that at the start")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 512)
