// Shared by both fixes: a plan for a method and a number of threads, and bodies with moments given one by one.
#ifndef POINSOT_LAMMPS_TURN_H
#define POINSOT_LAMMPS_TURN_H

#include <poinsot.h>

#include <array>
#include <map>
#include <string>
#include <vector>

namespace poinsot_lammps {

class Turn {
 public:
  explicit Turn(const std::string &method) : method_(method) {}
  Turn(const Turn &) = delete;
  Turn &operator=(const Turn &) = delete;
  ~Turn() { poinsot_plan_destroy(&plan_); }

  // Make the plan; returns "" or an error message. To be called before each run: the number of threads may have changed.
  std::string prepare(int threads);

  // Free rotation over h of the bodies of a view with space-frame momenta, each with its moments in the view. Returns "" or an error
  // message, with *first the number in the view of the first body that failed (-1: not the fault of a body).
  std::string turn(poinsot_bodies view, double h, long *first);

 private:
  std::string make_plan(const std::vector<std::array<double, 3>> &classes);
  std::string find_classes(poinsot_bodies *view);

  std::string method_;
  int threads_ = 1;
  poinsot_plan *plan_ = nullptr;
  std::vector<poinsot_status> status_;
  // Methods other than exact and jacobi need body classes: one for each set of moments seen so far.
  bool by_class_ = false;
  std::map<std::array<double, 3>, int> known_;
  std::vector<std::array<double, 3>> classes_;
  std::vector<int> class_of_;
};

} // namespace poinsot_lammps

#endif
