#!/usr/bin/env python3
"""Prints the frequencies of bodies that have a closed form, as the tables of tests/truth/things give them.

usage: closed_forms.py

Only Python's own library is used, and nothing of Ringdown's. Each function names its source.
"""
import math


def roots(f, low, high, steps, count):
    """The first `count` zeros of f between low and high, by sign changes on a grid and bisection. Poles are left out."""
    found, before = [], f(low)
    for i in range(1, steps + 1):
        x = low + (high - low) * i / steps
        now = f(x)
        if before * now < 0:
            a, b, fa = low + (high - low) * (i - 1) / steps, x, before
            for _ in range(200):
                c = 0.5 * (a + b)
                fc = f(c)
                if fa * fc <= 0:
                    b = c
                else:
                    a, fa = c, fc
            if abs(f(0.5 * (a + b))) <= max(abs(before), abs(now)):
                found.append(0.5 * (a + b))
        before = now
        if len(found) == count:
            break
    return found


def spherical_j(l, x):
    """The spherical Bessel function, by its power series; good to 1e-12 below x = 15."""
    term, total = x**l / math.prod(range(1, 2 * l + 2, 2)), 0.0
    for k in range(1, 200):
        total += term
        term *= -0.5 * x * x / (k * (2 * l + 2 * k + 1))
    return total


def sphere(nu, e, rho, radius, count):
    """A solid sphere's modes [Lamb, Proc. London Math. Soc. 13, 1882; Sato & Usami, Geophys. Mag. 31, 1962]: spheroidal ones
    (breathing too) and torsional ones, with how many of each there are. [Hz]"""
    mu = e / (2 * (1 + nu))
    shear = math.sqrt(mu / rho)
    ratio = math.sqrt((1 - 2 * nu) / (2 - 2 * nu))  # of the two speeds of waves
    modes = []

    def torsional(l):
        return lambda x: (l - 1) * spherical_j(l, x) - x * spherical_j(l + 1, x)

    def spheroidal(l):
        def determinant(y):
            x = y * ratio
            jx, jx1, jy, jy1 = spherical_j(l, x), spherical_j(l + 1, x), spherical_j(l, y), spherical_j(l + 1, y)
            # Normal and tangential traction of curl-free and divergence-free parts, over 2 mu / a^2.
            a11 = (l * (l - 1) - 0.5 * y * y) * jx + 2 * x * jx1
            a12 = l * (l + 1) * ((l - 1) * jy - y * jy1)
            a21 = (l - 1) * jx - x * jx1
            a22 = (l * l - 1 - 0.5 * y * y) * jy + y * jy1
            return a11 * a22 - a12 * a21

        return determinant

    for l in range(1, 8):
        if l > 1:
            modes += [(y, 2 * l + 1, f"T{l}") for y in roots(torsional(l), 0.5, 9, 900, 2)]
        modes += [(y, 2 * l + 1, f"S{l}") for y in roots(spheroidal(l), 0.5, 9, 900, 3)]
    breathing = lambda y: (lambda x: (0.5 * y * y) * spherical_j(0, x) - 2 * x * spherical_j(1, x))(y * ratio)
    modes += [(y, 1, "S0") for y in roots(breathing, 0.5, 9, 900, 2)]
    return [(y * shear / (2 * math.pi * radius), n, name) for y, n, name in sorted(modes)[:count]]


def bessel(n, x, sign):
    """J_n (sign -1) or I_n (sign 1)."""
    term, total = (0.5 * x) ** n / math.factorial(n), 0.0
    for k in range(1, 120):
        total += term
        term *= sign * 0.25 * x * x / (k * (n + k))
    return total


def circular_plate(nu, e, rho, radius, thickness, count):
    """A thin free disc [Kirchhoff, J. reine angew. Math. 40, 1850; Leissa, Vibration of Plates, NASA SP-160, 1969, eq. 2.13]."""

    def parts(n, x, sign):  # the function and its slope
        f = lambda m: bessel(m, x, sign)
        return f(n), 0.5 * (f(n - 1) + sign * f(n + 1)) if n else sign * f(1)

    def free_edge(n):
        def determinant(x):
            j, dj = parts(n, x, -1)
            i, di = parts(n, x, 1)
            # Moment and Kirchhoff's shear at the edge, each for J_n and for I_n.
            m = lambda w, dw, s: s * x * x * w - (1 - nu) * (x * dw - n * n * w)
            v = lambda w, dw, s: s * x**3 * dw - (1 - nu) * n * n * (x * dw - w)
            return m(j, dj, -1) * v(i, di, 1) - m(i, di, 1) * v(j, dj, -1)

        return determinant

    stiffness = e * thickness**3 / (12 * (1 - nu * nu))
    per_lambda = math.sqrt(stiffness / (rho * thickness)) / (2 * math.pi * radius**2)
    modes = []
    for n in range(0, 9):
        found = roots(free_edge(n), 1.0, 12, 4400, 3)
        modes += [(x * x, 2 if n else 1, f"({n},{k})") for k, x in enumerate(found, 1 if n < 2 else 0)]
    return [(x2 * per_lambda, many, name) for x2, many, name in sorted(modes)[:count]]


def ring(nu, e, rho, radius, section_radius, count):
    """A thin ring of round section: in its plane [Hoppe, J. reine angew. Math. 73, 1871] and out of it [Michell, Messenger of
    Math. 19, 1889]; Love, Mathematical Theory of Elasticity, art. 293."""
    unit = math.sqrt(e * section_radius**2 / (4 * rho * radius**4)) / (2 * math.pi)
    modes = []
    for n in range(2, 9):
        modes.append((unit * n * (n * n - 1) / math.sqrt(n * n + 1 + nu), 2, f"out of its plane, {n}"))
        modes.append((unit * n * (n * n - 1) / math.sqrt(n * n + 1), 2, f"in its plane, {n}"))
    return sorted(modes)[:count]


def tube(nu, e, rho, length, outer, inner, count):
    """A free tube: bending as a beam with shear and rotary inertia [Timoshenko, Phil. Mag. 41, 1921], Cowper's shear
    coefficient of a hollow circle [J. Appl. Mech. 33, 1966]; torsion; both ends free."""
    area = math.pi * (outer**2 - inner**2)
    inertia = math.pi / 4 * (outer**4 - inner**4)
    m2 = (inner / outer) ** 2
    kappa = 6 * (1 + nu) * (1 + m2) ** 2 / ((7 + 6 * nu) * (1 + m2) ** 2 + (20 + 12 * nu) * m2)
    shear = kappa * area * e / (2 * (1 + nu))
    r2, s2 = inertia / (area * length**2), e * inertia / (shear * length**2)

    def determinant(omega):
        b2 = rho * area * length**4 * omega**2 / (e * inertia)
        b, root = math.sqrt(b2), math.sqrt((r2 - s2) ** 2 + 4 / b2)
        alpha, beta = (math.sqrt(0.5 * (sign * (r2 + s2) + root)) for sign in (-1, 1))
        x, y = b * alpha, b * beta
        # Huang, J. Appl. Mech. 28, 1961, eq. for free-free ends, over cosh.
        factor = b / math.sqrt(1 - b2 * r2 * s2) * (b2 * r2 * (r2 - s2) ** 2 + 3 * r2 - s2)
        return 2 / math.cosh(x) - 2 * math.cos(y) + factor * math.tanh(x) * math.sin(y)

    speed = math.sqrt(e * inertia / (rho * area)) / length**2
    modes = [(w / (2 * math.pi), 2, f"bending {n + 1}") for n, w in
             enumerate(roots(determinant, 8 * speed, 900 * speed, 60000, 9))]
    modes += [(n * math.sqrt(e / (2 * (1 + nu) * rho)) / (2 * length), 1, f"torsion {n}") for n in (1, 2, 3)]
    modes += [(n * math.sqrt(e / rho) / (2 * length) * (1 - (n * math.pi * nu / length) ** 2 * (outer**2 + inner**2) / 4), 1,
               f"length {n}") for n in (1, 2)]
    return sorted(modes)[:count]


def hemisphere(count):
    """Ratios of a thin hemispherical bowl's frequencies when it bends without stretching [Rayleigh, Proc. London Math. Soc. 13,
    1881; Theory of Sound, art. 235c]."""

    def integral(f, n=20000):
        return sum(f((i + 0.5) * 0.5 * math.pi / n) for i in range(n)) * 0.5 * math.pi / n

    squares = []
    for s in range(2, 2 + count):
        bending = (s**3 - s) ** 2 * integral(lambda t: math.tan(t / 2) ** (2 * s) / math.sin(t) ** 3 if t > 0 else 0)
        motion = integral(lambda t: math.tan(t / 2) ** (2 * s) * math.sin(t) * ((s + math.cos(t)) ** 2 + 2 * math.sin(t) ** 2))
        squares.append(bending / motion)
    return [(math.sqrt(x / squares[0]), 2, f"{n} waves round the rim") for n, x in enumerate(squares, 2)]


BODIES = {
    "steel-sphere": sphere(0.3, 200e9, 7800, 0.05, 8),
    "rubber-sphere": sphere(0.495, 5e6, 1100, 0.05, 8),
    "thin-disc": circular_plate(0.33, 70e9, 2700, 0.1, 0.001, 8),
    "thin-ring": ring(0.3, 200e9, 7800, 0.12, 0.002, 8),
    "chime-tube": tube(0.34, 105e9, 8500, 1.2, 0.016, 0.0145, 8),
    "thin-bowl": hemisphere(4),
}

if __name__ == "__main__":
    for body, modes in BODIES.items():
        print(body)
        for frequency, many, name in modes:
            print(f"  [{frequency:.6g}, {many}, \"{name}\"],")
