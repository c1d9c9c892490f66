/* Out of memory, answered with a status. Requests beyond a limit find no memory, as a host near its end would have it; the limit
 * sinks from call to call, so that each large allocation fails once. Small ones (below 64 kB: texts, descriptors) always
 * succeed: the compiler's run-time library ends a program that cannot have those. */
#define _GNU_SOURCE
#include <poinsot.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
static long countdown = -1; /* large requests until one fails; -1: none does */
static int refused;

static int none_left(size_t size) {
  if (size < 65536 || countdown < 0) return 0;
  if (countdown-- > 0) return 0;
  countdown = 0;
  refused = 1;
  return 1;
}
void *malloc(size_t size) { return none_left(size) ? NULL : __libc_malloc(size); }
void *calloc(size_t n, size_t size) { return none_left(n * size) ? NULL : __libc_calloc(n, size); }
void *realloc(void *p, size_t size) { return none_left(size) ? NULL : __libc_realloc(p, size); }

enum { n = 20000 };
static double y[n][3], q[n][4], before_y[n][3], before_q[n][4], energy[2 * n];
static int class_of[n], each[n];

static int torque(void *context, double t, size_t m, const double *const at[4], ptrdiff_t q_stride, double *const g[3],
                  ptrdiff_t stride, double *e) {
  (void)context, (void)t, (void)m, (void)at, (void)q_stride, (void)stride, (void)e;
  g[0][0] = 1;
  return 0;
}

int main(void) {
  poinsot_plan *plan = NULL, *coupled = NULL;
  poinsot_body *body = NULL;
  poinsot_bodies view;
  const double moments[3] = {0.6, 0.8, 1};
  char *positions = malloc(64 * n + 100), *at;
  int what, i, bad = 0, statuses = 0, each_of[7] = {0};
  for (i = 0; i < n; i++) y[i][0] = 0.1, y[i][2] = i % 7, q[i][0] = 1;
  memcpy(before_y, y, sizeof y);
  memcpy(before_q, q, sizeof q);
  at = positions + sprintf(positions, "dipole = 1, 0, 0; coupling = 1e-9; positions = ");
  for (i = 0; i < 1500; i++) at += sprintf(at, "%d 0 0 ", i);
  poinsot_body_create(moments, &body);
  poinsot_plan_create(&plan);
  poinsot_plan_add_class(plan, moments, NULL);
  poinsot_plan_add_class(plan, moments, NULL);
  poinsot_plan_add_effect(plan, "gravity", "centre = 0, 0, 1");
  poinsot_plan_ready(plan);
  poinsot_bodies_rows(&view, "native", NULL, n, y[0], q[0]);
  view.body_class = class_of;
  view.status = each;
  for (what = 0; what < 7; what++) {
    long k;
    for (k = 0; k < 200; k++) {
      poinsot_status s = POINSOT_OK;
      memcpy(y, before_y, sizeof y);
      memcpy(q, before_q, sizeof q);
      refused = 0;
      countdown = k;
      switch (what) {
      case 0: s = poinsot_rotate(body, "exact", 0.1, 1, n, y[0], q[0], each); break;
      case 1: s = poinsot_drift(plan, &view, 0.1); break;
      case 2: s = poinsot_step(plan, &view, 0, 0.1, 0, 2, NULL, NULL); break;
      case 3: s = poinsot_step(plan, &view, 0, 0.1, 0, 2, torque, NULL); break;
      case 4: s = poinsot_energy(plan, &view, 0, energy, NULL); break;
      case 5:
        if (!coupled) poinsot_plan_create(&coupled), poinsot_plan_add_class(coupled, moments, NULL);
        s = poinsot_plan_add_effect(coupled, "dipoles", positions);
        break;
      default: {
        poinsot_plan *many = NULL;
        s = poinsot_plan_create(&many);
        for (i = 0; i < 300 && s == POINSOT_OK; i++) s = poinsot_plan_add_class(many, moments, NULL);
        if (s == POINSOT_OK) s = poinsot_plan_ready(many);
        poinsot_plan_destroy(&many);
      }
      }
      countdown = -1;
      if (!refused) break;
      statuses += s == POINSOT_E_MEMORY;
      each_of[what]++;
      if (s == POINSOT_E_MEMORY && (memcmp(y, before_y, sizeof y) || memcmp(q, before_q, sizeof q))) {
        bad++;
        fprintf(stderr, "memory.c: call %d, failure %ld: an array has changed\n", what, k);
      }
      if (s != POINSOT_E_MEMORY) {
        bad++;
        fprintf(stderr, "memory.c: call %d, failure %ld: status %d\n", what, k, s);
      }
    }
  }
  poinsot_plan_destroy(&plan);
  poinsot_plan_destroy(&coupled);
  poinsot_body_destroy(&body);
  free(positions);
  for (i = 0; i < 7; i++) printf("%d ", each_of[i]);
  printf("requests refused, %d answered, %d not\n", statuses, bad);
  return bad != 0 || statuses == 0;
}
