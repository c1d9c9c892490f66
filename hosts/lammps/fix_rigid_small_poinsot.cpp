#include "fix_rigid_small_poinsot.h"

#include "atom.h"
#include "comm.h"
#include "error.h"

#include <cstring>

using namespace LAMMPS_NS;

FixRigidSmallPoinsot::FixRigidSmallPoinsot(LAMMPS *lmp, int narg, char **arg, const std::string &method)
    : FixRigidSmall(lmp, narg, arg), turn_(method) {
  const std::string wrong = turn_.prepare(1);
  if (!wrong.empty()) error->all(FLERR, "fix rigid/small/poinsot: " + wrong);
}

void FixRigidSmallPoinsot::init() {
  FixRigidSmall::init();
  const std::string wrong = turn_.prepare(comm->nthreads);
  if (!wrong.empty()) error->all(FLERR, "fix rigid/small/poinsot: " + wrong);
}

// Kick and turn all bodies here; then let LAMMPS do the rest of the step with neither torque nor rotation left in it: centres of mass,
// communication, atoms, virial. (With a step of 0 its own rotation only normalises the quaternion.)
void FixRigidSmallPoinsot::initial_integrate(int vflag) {
  static_assert(sizeof(Body) % sizeof(double) == 0, "bodies must be whole numbers of doubles apart");
  torque_.resize(nlocal_body);
  for (int i = 0; i < nlocal_body; i++)
    for (int j = 0; j < 3; j++) {
      torque_[i][j] = body[i].torque[j];
      body[i].angmom[j] += dtf * body[i].torque[j];
      body[i].torque[j] = 0;
    }
  if (nlocal_body > 0) {
    const std::ptrdiff_t stride = sizeof(Body) / sizeof(double);
    poinsot_bodies view;
    poinsot_bodies_rows(&view, "lammps", "wxyz", nlocal_body, body[0].angmom, body[0].quat);
    view.y_stride = view.q_stride = view.moments_stride = stride;
    for (int j = 0; j < 3; j++) view.moments[j] = &body[0].inertia[j];
    long first;
    const std::string wrong = turn_.turn(view, dtv, &first);
    if (!wrong.empty()) {
      const std::string who = first < 0 ? "" : "body of atom " + std::to_string(atom->tag[body[first].ilocal]) + ": ";
      error->one(FLERR, "fix rigid/small/poinsot: " + who + wrong);
    }
  }
  const double half_step = dtq;
  dtq = 0;
  FixRigidSmall::initial_integrate(vflag);
  dtq = half_step;
  for (int i = 0; i < nlocal_body; i++) std::memcpy(body[i].torque, torque_[i].data(), sizeof body[i].torque);
}
