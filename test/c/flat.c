/* Memory stays flat: a million steps through the C interface, in a thousand calls of each kind, with effects, a thermostat and a
 * callback; plans and bodies made and freed; every way to fail. The memory of its own after it, heap and stack, against that after
 * the first tenth; not pages of files, which the system takes away and brings back as it likes. */
#define _GNU_SOURCE
#include <poinsot.h>
#include <stdio.h>
#include <unistd.h>

enum { n = 40, rounds = 1000 };
static double y[n][3], q[n][4], energy[n];
static int each[n];

static long own_memory(void) { /* in kB; -1: unknown */
  long size = -1, pages = -1, of_files = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  if (file == NULL) return -1;
  if (fscanf(file, "%ld %ld %ld", &size, &pages, &of_files) != 3) pages = -1;
  fclose(file);
  return pages < 0 ? -1 : (pages - of_files) * (sysconf(_SC_PAGESIZE) / 1024);
}

static int torque(void *context, double t, size_t m, const double *const at[4], ptrdiff_t q_stride, double *const g[3],
                  ptrdiff_t stride, double *e) {
  int *stop = context;
  (void)t, (void)e;
  for (size_t i = 0; i < m; i++) g[0][i * (size_t)stride] = at[1][i * (size_t)q_stride];
  return *stop;
}

static poinsot_plan *make(const char *splitting) {
  const double moments[3] = {0.6, 0.8, 1.0};
  poinsot_plan *plan = NULL;
  poinsot_plan_create(&plan);
  poinsot_plan_add_class(plan, moments, NULL);
  poinsot_plan_set(plan, "splitting", splitting);
  poinsot_plan_add_effect(plan, "gravity", "centre = 0, 0, 1");
  poinsot_plan_add_effect(plan, "langevin", "friction = 0.1; temperature = 0.5");
  poinsot_plan_add_effect(plan, "no such thing", "");
  return poinsot_plan_ready(plan) == POINSOT_OK ? plan : NULL;
}

static int turn(poinsot_plan *plan, int64_t round) {
  const double moments[3] = {0.6, 0.8, 1.0};
  poinsot_bodies bodies;
  poinsot_body *body = NULL;
  poinsot_plan *short_lived = make("srkn4");
  int stop = round % 7 == 3, bad = short_lived == NULL;
  double keep;
  poinsot_bodies_rows(&bodies, "native", NULL, n, &y[0][0], &q[0][0]);
  bodies.status = each;
  bad += poinsot_step(plan, &bodies, 0.0, 0.01, round * 1000, 990, NULL, NULL) != POINSOT_OK;
  bad += poinsot_step(plan, &bodies, 0.0, 0.01, round * 1000 + 990, 5, torque, &stop) !=
         (stop ? POINSOT_E_CALLBACK : POINSOT_OK);
  bad += poinsot_step(short_lived, &bodies, 0.0, 0.01, round * 1000 + 995, 5, NULL, NULL) != POINSOT_OK;
  bad += poinsot_energy(plan, &bodies, 0.0, energy, NULL) != POINSOT_OK;
  keep = q[3][0], q[3][0] = 7;
  bad += poinsot_drift(plan, &bodies, 0.01) != POINSOT_E_PARTIAL;
  q[3][0] = keep;
  bad += poinsot_body_create(moments, &body) != POINSOT_OK;
  bad += poinsot_rotate(body, "jacobi", 0.1, 3, n, &y[0][0], &q[0][0], each) != POINSOT_OK;
  bad += poinsot_rotate(body, "no such method", 0.1, 3, n, &y[0][0], &q[0][0], each) != POINSOT_E_METHOD;
  poinsot_body_destroy(&body);
  poinsot_plan_destroy(&short_lived);
  return bad;
}

int main(void) {
  poinsot_plan *plan = make("strang");
  long start = 0, end;
  int bad = plan == NULL;
  for (int i = 0; i < n; i++) y[i][0] = 0.1 * i, y[i][1] = 1, q[i][0] = 1;
  for (int64_t k = 0; k < rounds && !bad; k++) {
    if (k == rounds / 10) start = own_memory();
    bad += turn(plan, k);
  }
  end = own_memory();
  poinsot_plan_destroy(&plan);
  printf("%d steps of %d bodies: %ld kB of its own after a tenth, %ld kB at the end\n", rounds * 1000, n, start, end);
  if (bad) printf("a call answered something else than it should\n");
  return bad || end > start + 64;
}
