#include "fix_nve_poinsot.h"

#include "atom.h"
#include "atom_vec_ellipsoid.h"
#include "comm.h"
#include "error.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace {

std::string method_of(int narg, char **arg, Error *error) {
  std::string method = "exact";
  for (int i = 3; i < narg; i += 2) {
    if (std::string(arg[i]) != "method" || i + 1 >= narg)
      error->all(FLERR, std::string("fix nve/poinsot: \"") + arg[i] + "\" is not a keyword with its value; there is: method NAME");
    method = arg[i + 1];
  }
  return method;
}

// Of an ellipsoid with half axes a.
void ellipsoid_moments(double mass, const double a[3], double moments[3]) {
  const double fifth = 0.2 * mass, squares[3] = {a[0] * a[0], a[1] * a[1], a[2] * a[2]};
  moments[0] = fifth * (squares[1] + squares[2]);
  moments[1] = fifth * (squares[0] + squares[2]);
  moments[2] = fifth * (squares[0] + squares[1]);
}

// Versions that have superellipsoids keep the moments of these with the shape.
template <class Bonus> auto moments_of(const Bonus &body, double mass, double moments[3], int) -> decltype(body.flag_super, void()) {
  if (body.flag_super)
    std::copy(body.inertia, body.inertia + 3, moments);
  else
    ellipsoid_moments(mass, body.shape, moments);
}

template <class Bonus> void moments_of(const Bonus &body, double mass, double moments[3], long) {
  ellipsoid_moments(mass, body.shape, moments);
}

} // namespace

FixNVEPoinsot::FixNVEPoinsot(LAMMPS *lmp, int narg, char **arg) : FixNVE(lmp, narg, arg), turn_(method_of(narg, arg, error)) {
  const std::string wrong = turn_.prepare(1);
  if (!wrong.empty()) error->all(FLERR, "fix nve/poinsot: " + wrong);
}

int FixNVEPoinsot::count() const { return igroup == atom->firstgroup ? atom->nfirst : atom->nlocal; }

void FixNVEPoinsot::init() {
  FixNVE::init();
  avec_ = dynamic_cast<AtomVecEllipsoid *>(atom->style_match("ellipsoid"));
  if (!avec_) error->all(FLERR, "fix nve/poinsot needs atom_style ellipsoid");
  for (int i = 0; i < atom->nlocal; i++)
    if ((atom->mask[i] & groupbit) && atom->ellipsoid[i] < 0)
      error->one(FLERR, "fix nve/poinsot: atom " + std::to_string(atom->tag[i]) + " is a point, it has no shape");
  const std::string wrong = turn_.prepare(comm->nthreads);
  if (!wrong.empty()) error->all(FLERR, "fix nve/poinsot: " + wrong);
}

void FixNVEPoinsot::kick_atom(int i) {
  const double *f = atom->f[i], *torque = atom->torque[i], over_mass = dtf / atom->rmass[i];
  for (int j = 0; j < 3; j++) {
    atom->v[i][j] += over_mass * f[j];
    atom->angmom[i][j] += dtf * torque[j];
  }
}

// Half a kick, places over the step, and then all attitudes in one call, on LAMMPS's own arrays. dtv and dtf are those of this
// level of rRESPA.
void FixNVEPoinsot::initial_integrate(int) {
  static_assert(sizeof(AtomVecEllipsoid::Bonus) % sizeof(double) == 0, "quaternions must be whole numbers of doubles apart");
  const int n = count();
  momentum_at_.clear();
  attitude_at_.clear();
  moments_.clear();
  for (int i = 0; i < n; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    kick_atom(i);
    for (int j = 0; j < 3; j++) atom->x[i][j] += dtv * atom->v[i][j];
    double moments[3];
    moments_of(avec_->bonus[atom->ellipsoid[i]], atom->rmass[i], moments, 0);
    momentum_at_.push_back(i);
    attitude_at_.push_back(atom->ellipsoid[i]);
    moments_.insert(moments_.end(), moments, moments + 3);
  }
  if (momentum_at_.empty()) return;

  poinsot_bodies view;
  poinsot_bodies_rows(&view, "lammps", "wxyz", momentum_at_.size(), atom->angmom[0], avec_->bonus[0].quat);
  view.q_stride = sizeof(AtomVecEllipsoid::Bonus) / sizeof(double);
  view.y_at = momentum_at_.data();
  view.q_at = attitude_at_.data();
  view.rows = atom->nlocal;
  for (int j = 0; j < 3; j++) view.moments[j] = &moments_[j];
  view.moments_stride = 3;
  long first;
  const std::string wrong = turn_.turn(view, dtv, &first);
  if (wrong.empty()) return;
  const std::string who = first < 0 ? "" : "atom " + std::to_string(atom->tag[momentum_at_[first]]) + ": ";
  error->one(FLERR, "fix nve/poinsot: " + who + wrong);
}

void FixNVEPoinsot::final_integrate() {
  const int n = count();
  for (int i = 0; i < n; i++)
    if (atom->mask[i] & groupbit) kick_atom(i);
}
