// fix ID group nve/poinsot [method NAME]: constant energy for ellipsoids, by velocity Verlet with an exact free rotation.
#ifndef POINSOT_LAMMPS_FIX_NVE_POINSOT_H
#define POINSOT_LAMMPS_FIX_NVE_POINSOT_H

#include "fix_nve.h"
#include "turn.h"

namespace LAMMPS_NS {

class FixNVEPoinsot : public FixNVE {
 public:
  FixNVEPoinsot(class LAMMPS *, int, char **);
  void init() override;
  void initial_integrate(int) override;
  void final_integrate() override;

 private:
  int count() const; // of the atoms to look at
  void kick_atom(int i);
  poinsot_lammps::Turn turn_;
  class AtomVecEllipsoid *avec_ = nullptr;
  std::vector<int> momentum_at_, attitude_at_; // rows of the bodies of the group
  std::vector<double> moments_;                // three for each
};

} // namespace LAMMPS_NS

#endif
