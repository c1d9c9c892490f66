/* A spinning top through the C interface: cc heavy_top.c $(pkg-config --cflags --libs poinsot) -lm */
#include <math.h>
#include <poinsot.h>
#include <stdio.h>

static int failed(poinsot_plan *plan, poinsot_status status) {
  char message[200];
  poinsot_plan_message(plan, message, sizeof message);
  fprintf(stderr, "%s: %s\n", poinsot_status_text(status), message);
  poinsot_plan_destroy(&plan);
  return 1;
}

int main(void) {
  const double moments[3] = {0.6, 0.8, 1.0};
  double y[1][3] = {{1.8, 0.4, -0.9}}, q[1][4] = {{1, 0, 0, 0}}, kinetic, potential;
  poinsot_plan *plan;
  poinsot_bodies bodies;
  poinsot_status status;
  int k;

  if ((status = poinsot_plan_create(&plan)) || (status = poinsot_plan_add_class(plan, moments, NULL)) ||
      (status = poinsot_plan_add_effect(plan, "gravity", "centre = 0, 0, 1; weight = 1")) ||
      (status = poinsot_plan_ready(plan)) || (status = poinsot_bodies_rows(&bodies, "native", NULL, 1, y[0], q[0])))
    return failed(plan, status);

  for (k = 0; k <= 10; k++) { /* 100 steps of 0.01 at a time */
    status = poinsot_energy(plan, &bodies, k, &kinetic, &potential);
    if (status) return failed(plan, status);
    printf("t = %4d   H = %.13f   q = %9.6f %9.6f %9.6f %9.6f\n", k, kinetic + potential, q[0][0], q[0][1], q[0][2], q[0][3]);
    if (k < 10) status = poinsot_step(plan, &bodies, 0.0, 0.01, 100 * k, 100, NULL, NULL);
    if (status) return failed(plan, status);
  }
  poinsot_plan_destroy(&plan);
  return 0;
}
