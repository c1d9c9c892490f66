/* What a host pays: one call a step in every layout and by every member of poinsot_bodies, many steps a call, few bodies.
 *
 * usage: ways [--quick]     processor time, the least of several runs; slots: time of one FMA of a 512-bit vector, 8 bodies share it */
#include <poinsot.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { many = 262144, cached = 4096, together = 20 };

typedef struct {
  const char *name, *layout;
  int classes;                    /* 0: no body_class */
  enum { rows, columns, scattered, scaled, own, compensated } kind;
} way;

static const way ways[] = {{"rows", "native", 0, rows},           {"columns", "native", 0, columns},
                           {"lammps", "lammps", 0, rows},         {"dl_poly", "dl_poly", 0, rows},
                           {"hoomd", "hoomd", 0, rows},           {"one class, named", "native", 1, rows},
                           {"2 classes at random", "native", 2, rows},    {"16 classes", "native", 16, rows},
                           {"256 classes", "native", 256, rows},  {"rows in random order", "native", 0, scattered},
                           {"scale", "native", 0, scaled},        {"moments of each", "native", 0, own},
                           {"compensated", "native", 0, compensated}};

static double y[4 * many], q[4 * many], torque[3 * many], scale[many], moments[3 * many], carry[7 * many];
static double kinetic[many], space[3 * many];
static int class_of[many], at[many];
static const double body[3] = {0.376, 0.627, 1};
static double slot;

static double now(void) { return (double)clock() / CLOCKS_PER_SEC; }

/* The time of one FMA of eight doubles, in ns: twelve chains, so that none waits. */
typedef double vector __attribute__((vector_size(64)));
static double fma_time(void) {
  double best = 1e9;
  volatile double out;
  int run, k;
  for (run = 0; run < 30; run++) {
    vector a = {1}, b = {2}, c = {3}, d = {4}, e = {5}, f = {6}, g = {7}, h = {8}, i = {9}, j = {10}, l = {11}, m = {12};
    const vector x = {0.999, 0.998, 0.997, 0.996, 0.999, 0.999, 0.999, 0.999}, z = x * 0.001;
    double start = now(), t;
    for (k = 0; k < 400000; k++) {
      a = a * x + z, b = b * x + z, c = c * x + z, d = d * x + z, e = e * x + z, f = f * x + z;
      g = g * x + z, h = h * x + z, i = i * x + z, j = j * x + z, l = l * x + z, m = m * x + z;
    }
    t = (now() - start) / 400000 / 12 * 1e9;
    a = a + b + c + d + e + f + g + h + i + j + l + m;
    out = a[0];
    (void)out;
    if (t < best) best = t;
  }
  return best;
}

static poinsot_plan *plan_of(const way *w) {
  poinsot_plan *plan = NULL;
  int i;
  if (poinsot_plan_create(&plan) || poinsot_plan_set(plan, "layout", w->layout)) exit(1);
  for (i = 0; i < (w->classes > 1 ? w->classes : 1); i++) {
    double m[3] = {body[0] * (1 + 1e-3 * i), body[1], body[2]};
    if (poinsot_plan_add_class(plan, m, NULL)) exit(1);
  }
  if (poinsot_plan_ready(plan)) exit(1);
  return plan;
}

static void fill(const way *w, int n, poinsot_bodies *view) {
  int wide = strcmp(w->layout, "hoomd") ? 3 : 4, i, j;
  double *ys[3], *qs[4];
  for (i = 0; i < n; i++) {
    const double u[3] = {0.3 + 1e-7 * i, 0.5, 0.8}, p[4] = {-(u[0] + u[1] + u[2]), u[0] + u[2] - u[1], u[1] + u[0] - u[2], u[2] + u[1] - u[0]};
    scale[i] = 1 + 0.5 * (i % 7);
    class_of[i] = w->classes ? (int)((unsigned)i * 2654435761u >> 7) % w->classes : 0;
    at[i] = (int)((i * 7919LL) % n);
    for (j = 0; j < 3; j++) moments[3 * i + j] = body[j] * scale[i];
    for (j = 0; j < wide; j++) *(w->kind == columns ? &y[j * n + i] : &y[wide * i + j]) = wide == 4 ? p[j] : u[j];
    for (j = 0; j < 4; j++) *(w->kind == columns ? &q[j * n + i] : &q[4 * i + j]) = 0.5;
  }
  for (j = 0; j < 3; j++) ys[j] = y + j * n;
  for (j = 0; j < 4; j++) qs[j] = q + j * n;
  if (w->kind == columns ? poinsot_bodies_arrays(view, w->layout, (size_t)n, ys, qs)
                         : poinsot_bodies_rows(view, w->layout, NULL, (size_t)n, y, q))
    exit(1);
  if (w->classes) view->body_class = class_of;
  if (w->kind == scattered) view->y_at = view->q_at = at, view->rows = (size_t)n;
  if (w->kind == scaled) view->scale = scale;
  if (w->kind == own) view->moments_stride = 3;
  for (j = 0; j < 3 && w->kind == own; j++) view->moments[j] = moments + j;
  memset(carry, 0, 7 * sizeof(double) * (size_t)n);
  if (w->kind == compensated) view->carry = carry;
}

/* ns a body: 0 a drift, 1 a kick, 2 a step of many, 3 the energies, 4 the momenta in space. */
static double measure(const way *w, int n, int what, int runs) {
  const double *const g[3] = {torque, torque + 1, torque + 2};
  poinsot_plan *plan = plan_of(w);
  poinsot_bodies view;
  double best = 1e9;
  int run, k, calls = 1 + 200000 / n, failed = 0;
  fill(w, n, &view);
  for (run = 0; run < runs; run++) {
    double start = now(), t;
    for (k = 0; k < calls; k++)
      failed |= what == 0 ? poinsot_drift(plan, &view, 0.03)
                : what == 1 ? poinsot_kick(plan, &view, 0.01, g, 3)
                : what == 2 ? poinsot_step(plan, &view, 0, 0.03, 0, together, NULL, NULL)
                : what == 3 ? poinsot_energy(plan, &view, 0, kinetic, NULL)
                            : poinsot_momentum(plan, &view, space);
    t = (now() - start) / calls / n / (what == 2 ? together : 1) * 1e9;
    if (t < best) best = t;
  }
  poinsot_plan_destroy(&plan);
  if (failed) printf("status %d: ", failed);
  return best;
}

int main(int argc, char **argv) {
  const int few[] = {1, 2, 8, 16, 64};
  int runs = argc > 1 && !strcmp(argv[1], "--quick") ? 4 : 15;
  double kernel;
  size_t i;
  slot = fma_time();
  printf("an FMA of 8 doubles takes %.3f ns; ns a body, in brackets slots (ns a body, 8 bodies, over that)\n\n", slot);
  printf("                        one drift a call: %d bodies    %d bodies        one kick, %d    %d steps a call, %d\n", many,
         cached, many, together, cached);
  for (i = 0; i < sizeof ways / sizeof *ways; i++) {
    double t[4];
    int k;
    t[0] = measure(&ways[i], many, 0, runs), t[1] = measure(&ways[i], cached, 0, runs);
    t[2] = measure(&ways[i], many, 1, runs), t[3] = measure(&ways[i], cached, 2, runs);
    printf("%22s  ", ways[i].name);
    for (k = 0; k < 4; k++) printf("      %6.2f (%3.0f)", t[k], t[k] * 8 / slot);
    printf("\n");
  }
  printf("\n                        energies: %d bodies    %d bodies    momenta in space, %d    %d\n", many, cached, many, cached);
  for (i = 0; i < sizeof ways / sizeof *ways; i++) {
    double t[4];
    int k;
    for (k = 0; k < 4; k++) t[k] = measure(&ways[i], k % 2 ? cached : many, 3 + k / 2, runs);
    printf("%22s  ", ways[i].name);
    for (k = 0; k < 4; k++) printf("      %6.2f (%3.0f)", t[k], t[k] * 8 / slot);
    printf("\n");
  }
  printf("\n                        ns a call: drift      kick    step    columns, drift    poinsot_rotate    poinsot_rotate_f\n");
  for (i = 0; i < sizeof few / sizeof *few; i++) {
    poinsot_body *one;
    double best[2] = {1e9, 1e9}, start;
    int n = few[i], run, k, exact = 1, steps = 1, status;
    const double h = 0.03;
    poinsot_bodies view;
    if (poinsot_body_create(body, &one)) return 1;
    fill(&ways[0], n, &view);
    for (run = 0; run < runs; run++) {
      start = now();
      for (k = 0; k < 20000; k++) (void)poinsot_rotate(one, "exact", h, 1, (size_t)n, y, q, NULL);
      best[0] = fmin(best[0], (now() - start) / 20000 * 1e9);
      start = now();
      for (k = 0; k < 20000; k++) poinsot_rotate_f_(body, &exact, &h, &steps, &n, y, q, class_of, &status);
      best[1] = fmin(best[1], (now() - start) / 20000 * 1e9);
    }
    poinsot_body_destroy(&one);
    kernel = measure(&ways[0], n, 2, runs) * n;
    printf("%10d bodies         %12.0f  %8.0f  %6.0f  %16.0f  %16.0f  %18.0f\n", n, measure(&ways[0], n, 0, runs) * n,
           measure(&ways[0], n, 1, runs) * n, kernel, measure(&ways[1], n, 0, runs) * n, best[0], best[1]);
  }
  return 0;
}
