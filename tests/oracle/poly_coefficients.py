"""Derive the polynomial coefficients of `crates/taotie-engine/src/math/poly.rs`.

Weighted minimax approximation by the Remez exchange algorithm in 50-digit arithmetic. Two polynomials:

    exp   e^r      ~ 1 + r + r^2 Q(r)          |r| <= ln(2)/2
    log   ln(1+u)  ~ u - u^2/2 + u^3 P(u)      sqrt(1/2) - 1 <= u <= sqrt(2) - 1

Each minimises the largest *relative* error of the left side; the low terms are fixed so that they can be
computed exactly. Run it to print the coefficients and the error reached:

    python tests/oracle/poly_coefficients.py
"""

from mpmath import exp, fabs, log, lu_solve, matrix, mp, mpf, pi, cos, sqrt

mp.dps = 50
GRID = 3000
ROUNDS = 30


def horner(coefficients, x):
    """Value of sum c_i x^i."""
    value = mpf(0)
    for c in reversed(coefficients):
        value = value * x + c
    return value


def level(target, weight, points):
    """Coefficients c and level e with weight (c(x) - target) = (-1)^i e at the given points."""
    n = len(points)
    a, b = matrix(n, n), matrix(n, 1)
    for i, x in enumerate(points):
        for j in range(n - 1):
            a[i, j] = x**j
        a[i, n - 1] = mpf((-1) ** i) / weight(x)
        b[i] = target(x)
    solution = lu_solve(a, b)
    return [solution[i] for i in range(n - 1)]


def extrema(error, low, high, count):
    """The `count` largest alternating extrema of the error on a grid."""
    xs = [low + (high - low) * i / GRID for i in range(GRID + 1)]
    es = [error(x) for x in xs]
    runs = []  # the largest error of each stretch of one sign
    for x, e in zip(xs, es):
        if e == 0:
            continue
        if runs and (runs[-1][1] > 0) == (e > 0):
            if fabs(e) > fabs(runs[-1][1]):
                runs[-1] = (x, e)
        else:
            runs.append((x, e))
    while len(runs) > count:  # drop the weaker end: the signs still alternate
        runs.pop(0 if fabs(runs[0][1]) < fabs(runs[-1][1]) else -1)
    return [x for x, _ in runs], max(fabs(e) for e in es)


def remez(target, weight, low, high, degree):
    """Minimax coefficients (lowest power first) and the largest weighted error."""
    count = degree + 2
    points = [(low + high) / 2 - (high - low) / 2 * cos(pi * (2 * i + 1) / (2 * count)) for i in range(count)]
    best = None
    for _ in range(ROUNDS):
        c = level(target, weight, points)
        points, worst = extrema(lambda x: weight(x) * (horner(c, x) - target(x)), low, high, count)
        if best is None or worst < best[1]:
            best = (c, worst)
        if len(points) < count:
            break
    return best


def series(terms, x):
    """sum terms(i) x^i, for small arguments at which the closed form loses precision."""
    return sum(terms(i) * x**i for i in range(12))


def exp_target(r):
    if fabs(r) < mpf("1e-6"):
        return series(lambda i: 1 / mp.factorial(i + 2), r)
    return (exp(r) - 1 - r) / r**2


def log_target(u):
    if fabs(u) < mpf("1e-6"):
        return series(lambda i: mpf((-1) ** i) / (i + 3), u)
    return (log(1 + u) - u + u**2 / 2) / u**3


def log_weight(u):
    if fabs(u) < mpf("1e-20"):
        return mpf("1e-40")
    return u**3 / log(1 + u)


def show(name, degree, result):
    coefficients, worst = result
    print(f"{name}: degree {degree}, relative error {mp.nstr(worst, 3)} = 2^{mp.nstr(log(worst, 2), 4)}")
    for c in coefficients:
        print(f"    {mp.nstr(c, 17)},")


def main():
    half = log(2) / 2
    for degree in (4, 5):
        weight = lambda r: max(r**2, mpf("1e-40")) / exp(r)
        show("exp Q", degree, remez(exp_target, weight, -half, half, degree))
    for degree in (6, 7, 8):
        show("log P", degree, remez(log_target, log_weight, 1 / sqrt(mpf(2)) - 1, sqrt(mpf(2)) - 1, degree))


if __name__ == "__main__":
    main()
