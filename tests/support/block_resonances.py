"""Resonances of a free block of any elastic solid by Rayleigh and Ritz: no mesh, and no code of Ringdown."""
import numpy as np


def derivative(order):
    """p' of the orthonormal Legendre polynomials on [-1, 1], as a sum of these."""
    slopes = np.zeros((order + 1, order + 1))
    for n in range(1, order + 1):
        for m in range(n - 1, -1, -2):
            slopes[m, n] = np.sqrt((2 * m + 1.0) * (2 * n + 1.0))
    return slopes


def resonances_hz(sizes_m, density_kg_m3, stiffness_pa, count, order=11):
    """The lowest `count` resonances. `stiffness_pa` is 6 x 6, in the order 11 22 33 23 13 12.

    All displacements that are polynomials of a total degree up to `order` (Visscher, Migliori, Bell & Reinert, J. Acoust. Soc.
    Am. 90, 1991), in orthonormal Legendre polynomials. Derivatives of these are again such polynomials, so that integrals of
    products of strains are products of the matrices of derivatives.
    """
    powers = [(i, j, k) for i in range(order + 1) for j in range(order + 1 - i) for k in range(order + 1 - i - j)]
    place = {power: n for n, power in enumerate(powers)}
    slopes = derivative(order)
    gradients = []
    for axis in range(3):
        matrix = np.zeros((len(powers), len(powers)))
        for power, column in place.items():
            for lower in range(power[axis]):
                to = list(power)
                to[axis] = lower
                matrix[place[tuple(to)], column] = slopes[lower, power[axis]] * 2 / sizes_m[axis]
        gradients.append(matrix)
    voigt = {(0, 0): 0, (1, 1): 1, (2, 2): 2, (1, 2): 3, (0, 2): 4, (0, 1): 5}
    number = lambda i, j: voigt[(min(i, j), max(i, j))]
    products = [[a.T @ b for b in gradients] for a in gradients]
    size = len(powers)
    whole = np.zeros((3 * size, 3 * size))
    for i in range(3):
        for k in range(3):
            whole[i * size : (i + 1) * size, k * size : (k + 1) * size] = sum(
                stiffness_pa[number(i, j)][number(k, l)] * products[j][l]
                for j in range(3) for l in range(3) if stiffness_pa[number(i, j)][number(k, l)] != 0)
    squares = np.linalg.eigvalsh(0.5 * (whole + whole.T) / density_kg_m3)
    return np.sqrt(squares[6 : 6 + count]) / (2 * np.pi)  # the lowest six are the motions of a rigid body


def isotropic(young_pa, nu):
    return orthotropic([young_pa] * 3, [nu] * 3, [young_pa / (2 * (1 + nu))] * 3)


def cubic(c11, c12, c44):
    matrix = np.diag([c11, c11, c11, c44, c44, c44]).astype(float)
    matrix[:3, :3] += c12 * (1 - np.eye(3))
    return matrix


def orthotropic(young_pa, nu, shear_pa):
    """Of E1 E2 E3, nu12 nu13 nu23 and G12 G13 G23."""
    compliance = np.zeros((6, 6))
    for i in range(3):
        compliance[i, i] = 1 / young_pa[i]
    for (i, j), ratio in zip(((0, 1), (0, 2), (1, 2)), nu):
        compliance[i, j] = compliance[j, i] = -ratio / young_pa[i]
    for row, modulus in zip((5, 4, 3), shear_pa):
        compliance[row, row] = 1 / modulus
    return np.linalg.inv(compliance)
