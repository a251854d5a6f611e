#!/usr/bin/env python3
"""Prints the coefficients of trigonometry-inl.h and the largest relative error of each function for exact arithmetic.

Each series is interpolated at the Chebyshev nodes of its range in 60 decimal digits, which comes
close to the minimax polynomial, and its coefficients are then rounded to double.
"""
from decimal import Decimal, getcontext
from fractions import Fraction

getcontext().prec = 60
ONE = Decimal(1)


def series(term, z):
    """Sum of term(k) z^k until it no longer matters."""
    total, k, power = Decimal(0), 0, ONE
    while True:
        add = term(k) * power
        total += add
        if k > 3 and abs(add) < Decimal(10) ** -55:
            return total
        k, power = k + 1, power * z


def machin_arctan(n):
    return series(lambda k: (-ONE) ** k / (n ** (2 * k + 1) * (2 * k + 1)), ONE)


PI = 16 * machin_arctan(5) - 4 * machin_arctan(239)


def factorial(n):
    return Decimal(1) if n < 2 else n * factorial(n - 1)


def cosine(x):
    return series(lambda k: (-ONE) ** k / factorial(2 * k), x * x)


def interpolated(f, low, high, degree):
    """Monomial coefficients of the polynomial through f at the Chebyshev nodes, lowest power first."""
    n = degree + 1
    nodes = [(low + high) / 2 + (high - low) / 2 * cosine(PI * (2 * k + 1) / (2 * n)) for k in range(n)]
    divided = [f(x) for x in nodes]
    for order in range(1, n):
        for k in range(n - 1, order - 1, -1):
            divided[k] = (divided[k] - divided[k - 1]) / (nodes[k] - nodes[k - order])
    result = [Decimal(0)] * n
    for k in range(n - 1, -1, -1):  # Horner's scheme on Newton's form: result = result * (z - node) + divided.
        result = [(result[j - 1] if j else Decimal(0)) - nodes[k] * result[j] for j in range(n)]
        result[0] += divided[k]
    return result


def report(name, whole, lead, lead_low, high, degree):
    """whole(z) = lead + lead_low + z P(z): prints P."""
    tail = lambda z: (whole(z) - lead - lead_low) / z
    p = [float(c) for c in interpolated(tail, Decimal(0), high, degree)]
    exact = [Decimal(c) for c in p]
    value = lambda z: lead + lead_low + z * sum(c * z**k for k, c in enumerate(exact))
    points = [high * k / 400 for k in range(1, 401)]
    error = max(abs(value(z) / whole(z) - 1) for z in points)
    print(f"{name}: {float(lead)!r} + {float(lead_low)!r} + z P(z), z in [0, {float(high):.6f}],"
          f" error {float(error):.1e}")
    print("  " + ", ".join(repr(c) for c in p))


def main():
    def split(x):
        head = Decimal(float(x))
        return head, Decimal(float(x - head))

    sixteenth = ONE / 16
    report("sin(pi r) / r", lambda z: series(lambda k: (-ONE) ** k * PI ** (2 * k + 1) / factorial(2 * k + 1), z),
           *split(PI), sixteenth, 5)
    report("cos(pi r)", lambda z: series(lambda k: (-ONE) ** k * PI ** (2 * k) / factorial(2 * k), z), ONE, Decimal(0),
           sixteenth, 6)
    edge = Decimal(5) / 12
    report("atan(q) / (pi q)", lambda z: series(lambda k: (-ONE) ** k / (2 * k + 1) / PI, z), *split(1 / PI),
           edge * edge, 10)


if __name__ == "__main__":
    main()
