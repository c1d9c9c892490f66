/* Run on a processor older than the build (an emulator): POINSOT_E_CPU everywhere, and no illegal instruction. */
#include <poinsot.h>
#include <stdio.h>

int main(void) {
  const double moments[3] = {0.6, 0.8, 1.0};
  double y[3] = {0.1, 0.2, 0.3}, q[4] = {1, 0, 0, 0};
  poinsot_body *body;
  poinsot_plan *plan;
  int version, status;
  poinsot_version_f_(&version, &status);
  printf("%s\n", poinsot_status_text(POINSOT_E_CPU));
  if (poinsot_version() < 100 || version < 100 || status != POINSOT_E_CPU) return 1;
  if (poinsot_body_create(moments, &body) != POINSOT_E_CPU || body) return 2;
  if (poinsot_rotate(body, "exact", 0.1, 1, 1, y, q, NULL) != POINSOT_E_CPU) return 3;
  if (poinsot_plan_create(&plan) != POINSOT_E_CPU || plan) return 4;
  if (poinsot_method_count() != 0 || poinsot_has_feature("lapack")) return 5;
  poinsot_body_destroy(&body);
  poinsot_plan_destroy(&plan);
  return 0;
}
