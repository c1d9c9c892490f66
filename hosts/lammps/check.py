"""Checks of the preloaded library in a real LAMMPS; the last line is "N passed, M failed"."""
import os
import pathlib
import subprocess
import sys
import tempfile
import numpy as np

here = pathlib.Path(__file__).resolve().parent
preload = here / "build" / "libpoinsot_lammps.so"
mpirun = sys.argv[1]
passed = failed = 0
folder = tempfile.mkdtemp(prefix="poinsot-lammps-")


def check(name, good, what):
    global passed, failed
    passed, failed = passed + bool(good), failed + (not good)
    print(f"   ... {name} [{'PASSED' if good else 'FAILED'}]  {what}", flush=True)


def run(case, ours, ranks=1, **options):
    out = os.path.join(folder, f"{case}-{ours}-{ranks}-{len(os.listdir(folder))}")
    environment = dict(os.environ)
    if ours:
        environment["LD_PRELOAD"] = str(preload)
    command = [sys.executable, str(here / "cases.py"), case, out] + [f"{k}={v}" for k, v in options.items()]
    if ranks > 1:
        command = [mpirun, "-n", str(ranks)] + command
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=1200)
    if done.returncode != 0:
        print(done.stdout[-2000:], done.stderr[-2000:])
        raise SystemExit(f"case {case} stopped with exit code {done.returncode}")
    report = [line for line in done.stderr.splitlines() if line.startswith("poinsot:")]
    parts = [dict(np.load(f"{out}.{rank}.npz")) for rank in range(ranks)]
    return parts[0] if ranks == 1 else parts, report


def multiply(a, b):
    w = a[:, 0] * b[:, 0] - np.sum(a[:, 1:] * b[:, 1:], axis=1)
    v = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + np.cross(a[:, 1:], b[:, 1:])
    return np.concatenate([w[:, None], v], axis=1)


def exact_motion(q, momentum, moments, time, step=0.02, order=18):
    """Free bodies by their Taylor series, in the body frame; nothing of poinsot's."""
    back = q * [1, -1, -1, -1]
    pure = np.concatenate([np.zeros((len(q), 1)), momentum], axis=1)
    y = multiply(multiply(back, pure), q)[:, 1:]
    steps = int(np.ceil(time / step))
    h = time / steps
    for _ in range(steps):
        ys, qs = [y], [q]
        for k in range(order):
            w = [a / moments for a in ys]
            ys.append(sum(np.cross(ys[i], w[k - i]) for i in range(k + 1)) / (k + 1))
            spin = [np.concatenate([np.zeros((len(q), 1)), a], axis=1) for a in w]
            qs.append(sum(multiply(qs[i], spin[k - i]) for i in range(k + 1)) / (2 * (k + 1)))
        y = sum(a * h**k for k, a in enumerate(ys))
        q = sum(a * h**k for k, a in enumerate(qs))
        q /= np.linalg.norm(q, axis=1)[:, None]
    return q


def tumbling_error(found):
    before, after, mass = found["before"], found["after"], float(found["mass"])
    a = before[:, 7:10] / 2  # LAMMPS hands out diameters
    moments = mass / 5 * np.stack([a[:, 1] ** 2 + a[:, 2] ** 2, a[:, 0] ** 2 + a[:, 2] ** 2, a[:, 0] ** 2 + a[:, 1] ** 2], axis=1)
    want = exact_motion(before[:, :4], before[:, 4:7], moments, float(found["time"]))
    got = after[:, :4]
    return np.max(np.minimum(np.linalg.norm(got - want, axis=1), np.linalg.norm(got + want, axis=1)))


stock, _ = run("tumbling", False)
ours, report = run("tumbling", True)
check("tumbling-stock", tumbling_error(stock) >= 1e-2, f"nve/asphere alone, dt = .1, T = 10: error {tumbling_error(stock):.1e}")
check("tumbling", tumbling_error(ours) <= 1e-11, f"with poinsot: error {tumbling_error(ours):.1e}")
check("calls-taken", len(report) == 1 and "richardson 6400," in report[0] and " 0 refused, 0 sequences" in report[0], "; ".join(report))
if mpirun != "none":
    two, _ = run("tumbling", True, ranks=2)
    rows = np.concatenate([part["after"] for part in two])
    same = len(rows) == 64 and all(any(np.array_equal(row, other) for other in rows) for row in ours["after"])
    check("two-ranks", same, f"ranks 1 and 2 ({' and '.join(str(len(part['after'])) for part in two)} bodies): the same bits")

stock, _ = run("water", False)
ours, report = run("water", True)
check("water", abs(ours["drift"]) <= 0.1 * abs(stock["drift"]),
      f"216 TIP3P, dt = 4 fs, kcal/mol/ps: fix rigid/small {float(stock['drift']):.3g}, with poinsot {float(ours['drift']):.3g}")

for fix in ("rigid/nve/small molecule", "rigid/small molecule"):
    ours, report = run("co2", True, fix=fix)
    energy = ours["energy"]
    good = np.all(np.isfinite(energy)) and np.ptp(energy) < 0.02 * abs(energy[0]) + 2 and " 0 refused" in "".join(report)
    check("co2-" + fix.split()[0].replace("/", "-"), good,
          f"linear bodies, 20000 steps: energy {energy[0]:.3f} to {energy[-1]:.3f}; {report[-1] if report else 'no report'}")

print(f"\n{passed} passed, {failed} failed")
sys.exit(failed > 0)
