// fix ID group rigid/small/poinsot ... [method NAME]: fix rigid/small with an exact free rotation, one call for all bodies of a rank.
#ifndef POINSOT_LAMMPS_FIX_RIGID_SMALL_POINSOT_H
#define POINSOT_LAMMPS_FIX_RIGID_SMALL_POINSOT_H

#include "fix_rigid_small.h"
#include "turn.h"

namespace LAMMPS_NS {

class FixRigidSmallPoinsot : public FixRigidSmall {
 public:
  FixRigidSmallPoinsot(class LAMMPS *, int, char **, const std::string &method);
  void init() override;
  void initial_integrate(int) override;

 private:
  poinsot_lammps::Turn turn_;
  std::vector<std::array<double, 3>> torque_;
};

} // namespace LAMMPS_NS

#endif
