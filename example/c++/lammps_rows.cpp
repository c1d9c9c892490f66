// A host with LAMMPS arrays: space-frame angular momentum and quaternions in rows, torques in the space frame, atoms of
// several types counted from 1. c++ lammps_rows.cpp $(pkg-config --cflags --libs poinsot)
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <poinsot.h>
#include <stdexcept>
#include <vector>

static void must(poinsot_status status) {
  if (status != POINSOT_OK) throw std::runtime_error(poinsot_status_text(status));
}

struct destroy {
  void operator()(poinsot_plan *plan) const { poinsot_plan_destroy(&plan); }
};

int main() try {
  const std::size_t n = 1000;
  std::vector<std::array<double, 3>> angmom(n), torque(n, {{0.0, 0.0, 0.1}});
  std::vector<std::array<double, 4>> quat(n, {{0.5, 0.5, 0.5, 0.5}});
  std::vector<int> type(n);
  for (std::size_t i = 0; i < n; i++) {
    // Types may be in any order: a call collects the bodies of each type itself, and the result of a body depends neither on its
    // position nor on its neighbours. Sorted types cost a little less, which is no reason to move a host's atoms.
    type[i] = 1 + i % 2;
    angmom[i] = {{std::sin(i), std::cos(i), 1.0}};
  }
  const auto start = angmom;

  poinsot_plan *made;
  must(poinsot_plan_create(&made));
  const std::unique_ptr<poinsot_plan, destroy> plan(made);
  const double water[3] = {0.58, 1.18, 1.76}, tensor[9] = {2, 0.3, 0, 0.3, 1.5, 0, 0, 0, 1.2};
  must(poinsot_plan_add_class(plan.get(), water, nullptr));
  must(poinsot_plan_add_class_tensor(plan.get(), tensor, nullptr));
  must(poinsot_plan_set(plan.get(), "layout", "lammps"));
  must(poinsot_plan_ready(plan.get()));

  poinsot_bodies bodies;
  must(poinsot_bodies_rows(&bodies, "lammps", "wxyz", n, angmom[0].data(), quat[0].data()));
  bodies.body_class = type.data();
  bodies.first_class = 1;
  const double *const push[3] = {&torque[0][0], &torque[0][1], &torque[0][2]};
  for (int step = 0; step < 20; step++) {
    must(poinsot_kick(plan.get(), &bodies, 0.005, push, 3));
    must(poinsot_drift(plan.get(), &bodies, 0.01));
    must(poinsot_kick(plan.get(), &bodies, 0.005, push, 3));
  }

  double worst = 0; // L = L0 + t torque, to rounding
  for (std::size_t i = 0; i < n; i++)
    for (int j = 0; j < 3; j++) worst = std::fmax(worst, std::fabs(angmom[i][j] - start[i][j] - 0.2 * torque[i][j]));
  std::printf("lammps rows: L - L0 - t torque = %.1e\n", worst);
  return worst < 1e-14 ? 0 : 1;
} catch (const std::exception &error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
