"""Sideways parking by scipy with random guesses, and by carnot without a guess, in one run.

What one writes with scipy is Hamilton's equations of the vehicle, by hand, and a random guess of
the momentum. Prints a table: how many guesses lead to a geodesic, how many to the shortest one, and
the seconds until a shortest one is found.
"""

import time

import carnot
import numpy as np
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import root

START, GOAL, LEAST = np.zeros(4), np.array([0.0, 1.0, 0.0, 0.0]), 22.707881771
GUESSES = 40


def rates(t, z):
    """Of q = (x, y, theta, phi) and p, with the front wheel's speed s = P / a."""
    theta, phi, px, py, pt, pf = z[2], z[3], z[4], z[5], z[6], z[7]
    sin, cos = np.sin(phi - theta), np.cos(phi - theta)
    a, P = 1 + sin**2, px * np.cos(phi) + py * np.sin(phi) + pt * sin
    s = P / a
    turn = s * (py * np.cos(phi) - px * np.sin(phi))
    bend = s * pt * cos - s**2 * sin * cos
    zero = np.zeros_like(s)
    return np.array(
        [s * np.cos(phi), s * np.sin(phi), s * sin, pf, zero, zero, bend, -turn - bend]
    )


def action(z):
    sin = np.sin(z[3] - z[2])
    P = z[4] * np.cos(z[3]) + z[5] * np.sin(z[3]) + z[6] * sin
    return (P**2 / (1 + sin**2) + z[7] ** 2) / 2


def by_bvp(p0):
    t = np.linspace(0, 1, 50)
    guess = np.vstack([START[:, None] + (GOAL - START)[:, None] * t, np.outer(p0, np.ones(50))])
    ends = lambda a, b: np.concatenate([a[:4] - START, b[:4] - GOAL])
    found = solve_bvp(rates, ends, t, guess, tol=1e-8, max_nodes=5000)
    return action(found.y[:, 0]) if found.success else None


def by_shooting(p0):
    def miss(p):
        z0 = np.concatenate([START, p])
        return solve_ivp(rates, (0, 1), z0, method="DOP853", rtol=1e-10, atol=1e-10).y[:4, -1] - GOAL

    found = root(miss, p0)
    good = found.success and np.abs(miss(found.x)).max() < 1e-7
    return action(np.concatenate([START, found.x])) if good else None


def row(name, attempts):
    began, first, actions = time.perf_counter(), None, []
    for attempt in attempts:
        actions.append(attempt())
        if first is None and actions[-1] is not None and abs(actions[-1] - LEAST) < 1e-4:
            first = time.perf_counter() - began
    found = [one for one in actions if one is not None]
    least = sum(abs(one - LEAST) < 1e-4 for one in found)
    seconds = (time.perf_counter() - began) / len(actions)
    until = "-" if first is None else f"{first:.2f}"
    print(f"{name:28} {len(found):3d}/{len(actions):<3d} {least:3d} {seconds:9.3f} {until:>9}")


def main():
    random = np.random.default_rng(0)
    guesses = [10 * random.standard_normal(4) for _ in range(GUESSES)]
    print(f"{'':28} {'found':>7} least  s a try   s until")
    row("scipy.integrate.solve_bvp", [lambda p=p: by_bvp(p) for p in guesses])
    row("scipy.optimize.root", [lambda p=p: by_shooting(p) for p in guesses])
    car = carnot.scene("vehicle")
    row("carnot, no guess", [lambda: car.geodesics(START, GOAL).best().action])


if __name__ == "__main__":
    main()
