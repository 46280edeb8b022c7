#!/usr/bin/env python3
"""Reflectance and transmittance of slabs, by adding and doubling (van de Hulst 1980): writes slabs.csv and presets.csv.

A slab of optical thickness tau scatters with the albedo and the Henyey-Greenstein function of mean cosine g; nothing is
reflected at its faces. It is lit from one side by the same radiance from all directions. The columns reflected and
transmitted are the radiances that leave it along its normal, over that; by reciprocity they are the shares of a beam
along the normal that a slab reflects and transmits, unscattered light included.
"""

import numpy as np

CASES = [
    (1.0, 0.0, 2.0), (1.0, 0.75, 2.0), (1.0, 0.7, 20.0), (1.0, 0.0, 16.0), (1.0, 0.9, 64.0),
    (0.9, 0.75, 2.0), (0.99, 0.7, 20.0), (0.9, 0.0, 256.0),
]

# Scattering and absorption per metre in three channels, g, and the thickness in metres.
PRESETS = {
    "milk": ([8947.0, 11260.0, 13230.0], [1.1, 2.4, 14.0], 0.715, 0.005),
    "wax": ([1500.0, 1500.0, 1500.0], [30.0, 100.0, 200.0], 0.8, 0.005),
}


def radau(n):
    """Nodes and weights on (0, 1] that include 1: exact for polynomials of degree 2 n - 2."""
    # Golub and Welsch, with the last diagonal entry chosen so that 1 is a node of [-1, 1].
    k = np.arange(1, n)
    beta = k**2 / (4.0 * k**2 - 1.0)
    # p(1) / q(1) of the last two monic Legendre polynomials, by their recurrence.
    ratio = 1.0
    for b in beta[:-1]:
        ratio = 1.0 / (1.0 - b * ratio)
    diagonal = np.zeros(n)
    diagonal[-1] = 1.0 - beta[-1] * ratio
    nodes, vectors = np.linalg.eigh(np.diag(diagonal) + np.diag(np.sqrt(beta), 1) + np.diag(np.sqrt(beta), -1))
    return (nodes + 1.0) / 2.0, vectors[0] ** 2


def slab(albedo, g, tau, n=96):
    mu, weight = radau(n)
    legendre = np.polynomial.legendre.legvander(mu, n)
    order = np.arange(n + 1)
    same = (legendre * (2 * order + 1) * g**order) @ legendre.T
    other = (legendre * (2 * order + 1) * (-g) ** order) @ legendre.T
    # d/dtau of the radiances downwards and upwards.
    one = np.eye(n)
    direct = (albedo / 2 * same * weight - one) / mu[:, None]
    crossed = albedo / 2 * other * weight / mu[:, None]
    doublings = int(np.ceil(np.log2(tau / (0.2 * mu.min()))))
    generator = np.block([[direct, crossed], [-crossed, -direct]]) * (tau / 2**doublings)
    step, term = np.eye(2 * n), np.eye(2 * n)
    for power in range(1, 24):
        term = term @ generator / power
        step = step + term
    reflected = -np.linalg.solve(step[n:, n:], step[n:, :n])
    transmitted = step[:n, :n] + step[:n, n:] @ reflected
    for _ in range(doublings):
        between = np.linalg.solve(one - reflected @ reflected, transmitted)
        reflected, transmitted = reflected + transmitted @ reflected @ between, transmitted @ between
    return reflected[-1].sum(), transmitted[-1].sum()


def half_space(albedo):
    """Share of a beam along the normal that a half space reflects where scattering is isotropic: Chandrasekhar's H."""
    mu, weight = radau(64)
    h = np.ones(64)
    for _ in range(200):
        h = 1.0 / (np.sqrt(1.0 - albedo) + albedo / 2 * ((weight * mu * h) / (mu[:, None] + mu)).sum(axis=1))
    return 1.0 - np.sqrt(1.0 - albedo) * h[-1]


def check():
    """A value of van de Hulst's, table 35; one of Chandrasekhar's; nothing is lost where nothing is absorbed."""
    reflected, transmitted = slab(0.9, 0.75, 2.0)
    assert abs(reflected - 0.09739) < 1e-5 and abs(transmitted - 0.66096) < 1e-5, (reflected, transmitted)
    reflected, _ = slab(0.9, 0.0, 256.0)
    assert abs(reflected - half_space(0.9)) < 1e-5, (reflected, half_space(0.9))
    for case in CASES[:5]:
        assert abs(sum(slab(*case)) - 1.0) < 1e-6, (case, slab(*case))


if __name__ == "__main__":
    check()
    with open(__file__.replace(".py", ".csv"), "w") as table:
        table.write("albedo,g,tau,reflected,transmitted\n")
        for case in CASES:
            table.write("%g,%g,%g,%.6f,%.6f\n" % (case + slab(*case)))
    with open(__file__.replace("slabs.py", "presets.csv"), "w") as table:
        table.write("preset,channel,reflected,transmitted\n")
        for name, (scattering, absorption, g, thickness) in PRESETS.items():
            for channel, (s, a) in enumerate(zip(scattering, absorption)):
                table.write("%s,%d,%.6f,%.6f\n" % ((name, channel) + slab(s / (s + a), g, thickness * (s + a))))
