#include "turn.h"

namespace poinsot_lammps {

std::string Turn::prepare(int threads) {
  threads_ = threads < 1 ? 1 : threads;
  by_class_ = method_ != "exact" && method_ != "jacobi";
  return make_plan(classes_);
}

std::string Turn::make_plan(const std::vector<std::array<double, 3>> &classes) {
  poinsot_plan_destroy(&plan_);
  poinsot_status status = poinsot_plan_create(&plan_);
  if (status == POINSOT_OK) status = poinsot_plan_set(plan_, "method", method_.c_str());
  if (status == POINSOT_E_METHOD) {
    std::string methods;
    for (std::size_t i = 0; i < poinsot_method_count(); i++) methods += std::string(i ? ", " : "") + poinsot_method_name(i);
    return "unknown method \"" + method_ + "\"; there are " + methods;
  }
  if (status == POINSOT_OK) status = poinsot_plan_set(plan_, "layout", "lammps");
  if (status == POINSOT_OK) status = poinsot_plan_set(plan_, "threads", std::to_string(threads_).c_str());
  for (const auto &moments : classes)
    if (status == POINSOT_OK) status = poinsot_plan_add_class(plan_, moments.data(), nullptr);
  if (status == POINSOT_OK) status = poinsot_plan_ready(plan_);
  if (status == POINSOT_OK) return "";
  std::array<char, 400> text{};
  poinsot_plan_message(plan_, text.data(), text.size());
  return text[0] ? text.data() : poinsot_status_text(status);
}

std::string Turn::find_classes(poinsot_bodies *view) {
  const std::ptrdiff_t stride = view->moments_stride;
  const std::size_t before = classes_.size();
  class_of_.resize(view->n);
  for (std::size_t i = 0; i < view->n; i++) {
    const std::array<double, 3> moments = {{view->moments[0][i * stride], view->moments[1][i * stride], view->moments[2][i * stride]}};
    const auto found = known_.emplace(moments, static_cast<int>(classes_.size()));
    if (found.second) classes_.push_back(moments);
    class_of_[i] = found.first->second;
  }
  view->body_class = class_of_.data();
  for (auto &moments : view->moments) moments = nullptr;
  view->moments_stride = 0;
  return classes_.size() == before ? "" : make_plan(classes_);
}

std::string Turn::turn(poinsot_bodies view, double h, long *first) {
  *first = -1;
  if (view.n == 0) return "";
  if (by_class_) {
    const std::string wrong = find_classes(&view);
    if (!wrong.empty()) return wrong;
  }
  status_.resize(view.n);
  view.status = status_.data();
  const poinsot_status status = poinsot_drift(plan_, &view, h);
  if (status == POINSOT_OK) return "";
  if (status != POINSOT_E_PARTIAL) {
    std::array<char, 400> text{};
    poinsot_bodies_check(plan_, &view, text.data(), text.size());
    return text[0] ? text.data() : poinsot_status_text(status);
  }
  for (std::size_t i = 0; i < view.n; i++)
    if (status_[i] != POINSOT_OK) {
      *first = static_cast<long>(i);
      return poinsot_status_text(status_[i]);
    }
  return poinsot_status_text(status);
}

} // namespace poinsot_lammps
