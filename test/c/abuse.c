/* What a C host may do wrong, and what it may ask for twice: answered, never suffered. Run plainly, under the sanitizers and
 * under valgrind. */
#include <fenv.h>
#include <locale.h>
#include <math.h>
#include <poinsot.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <pthread.h>

static int checks, failures;

static void check(int good, const char *what, int line) {
  checks++;
  if (good) return;
  failures++;
  fprintf(stderr, "abuse.c:%d: %s\n", line, what);
}
#define CHECK(condition) check(condition, #condition, __LINE__)

static const double moments[3] = {0.6, 0.8, 1.0};

static poinsot_plan *ready_plan(const char *layout) {
  poinsot_plan *plan;
  CHECK(poinsot_plan_create(&plan) == POINSOT_OK);
  CHECK(poinsot_plan_add_class(plan, moments, NULL) == POINSOT_OK);
  CHECK(poinsot_plan_set(plan, "layout", layout) == POINSOT_OK);
  CHECK(poinsot_plan_ready(plan) == POINSOT_OK);
  return plan;
}

static void library(void) {
  int s;
  double kick[32], drift[32];
  size_t count;
  CHECK(poinsot_version() >= 100);
  for (s = -3; s < 20; s++) CHECK(poinsot_status_text(s) != NULL && strlen(poinsot_status_text(s)) > 0);
  CHECK(poinsot_has_feature(NULL) == 0);
  CHECK(poinsot_has_feature("") == 0);
  CHECK(poinsot_has_feature("no such") == 0);
  CHECK(poinsot_has_feature("lapack") == 1);
  CHECK(poinsot_method_name((size_t)-1) == NULL && poinsot_method_name(poinsot_method_count()) == NULL);
  CHECK(poinsot_splitting_name((size_t)-1) == NULL && poinsot_splitting_name(poinsot_splitting_count()) == NULL);
  CHECK(poinsot_effect_name((size_t)-1) == NULL && poinsot_effect_name(poinsot_effect_count()) == NULL);
  CHECK(poinsot_splitting_count() > 10 && strcmp(poinsot_splitting_name(0), "strang") == 0);
  CHECK(poinsot_splitting_flows("strang", 8, kick, drift, &count) == POINSOT_OK && count == 2);
  CHECK(kick[0] == 0.5 && drift[0] == 1 && kick[1] == 0.5 && drift[1] == 0);
  CHECK(poinsot_splitting_flows("srkn6", 8, kick, drift, &count) == POINSOT_E_SIZE && count == 15 && kick[0] == 0.5);
  CHECK(poinsot_splitting_flows("srkn6", 0, NULL, NULL, &count) == POINSOT_E_SIZE && count == 15);
  CHECK(poinsot_splitting_flows("chin4", 8, kick, drift, &count) == POINSOT_E_METHOD && count == 0);
  CHECK(poinsot_splitting_flows("takahashi-imada", 8, kick, drift, &count) == POINSOT_E_METHOD);
  CHECK(poinsot_splitting_flows("strung", 8, kick, drift, &count) == POINSOT_E_METHOD);
  CHECK(poinsot_splitting_flows(NULL, 8, kick, drift, &count) == POINSOT_E_NULL);
  CHECK(poinsot_splitting_flows("strang", 8, NULL, drift, &count) == POINSOT_E_NULL);
  CHECK(poinsot_splitting_flows("strang", 8, kick, NULL, &count) == POINSOT_E_NULL);
  CHECK(poinsot_splitting_flows("strang", 8, kick, drift, NULL) == POINSOT_E_NULL);
  for (s = 0; s < (int)poinsot_splitting_count(); s++) {
    double all[2] = {0, 0};
    size_t i;
    if (poinsot_splitting_flows(poinsot_splitting_name((size_t)s), 32, kick, drift, &count) != POINSOT_OK) continue;
    for (i = 0; i < count; i++) all[0] += kick[i], all[1] += drift[i];
    CHECK(fabs(all[0] - 1) < 1e-14 && fabs(all[1] - 1) < 1e-14);
  }
  CHECK(poinsot_effect_count() > 5 && strcmp(poinsot_effect_name(0), "gravity") == 0);
}

static void body(void) {
  const double bad[][3] = {{-1, 1, 1}, {1, 1, 3}, {NAN, 1, 1}, {INFINITY, 1, 1}, {0, 0, 1}};
  double tensor[9] = {2, 0.1, 0, 0.1, 2, 0, 0, 0, 2}, axes[9], y[3] = {0.1, 0.2, 0.3}, q[4] = {1, 0, 0, 0};
  double y2[2][3] = {{NAN, 0, 0}, {0.1, 0.2, 0.3}}, q2[2][4] = {{1, 0, 0, 0}, {1, 0, 0, 0}};
  poinsot_body *it = NULL;
  poinsot_status each[2] = {-1, -1};
  size_t i;
  CHECK(poinsot_body_create(NULL, &it) == POINSOT_E_NULL && it == NULL);
  CHECK(poinsot_body_create(moments, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_body_create_tensor(NULL, &it, axes) == POINSOT_E_NULL && it == NULL);
  CHECK(poinsot_body_create_tensor(tensor, NULL, axes) == POINSOT_E_NULL);
  for (i = 0; i < sizeof bad / sizeof *bad; i++) CHECK(poinsot_body_create(bad[i], &it) == POINSOT_E_DOMAIN && it == NULL);
  tensor[1] = 5;
  CHECK(poinsot_body_create_tensor(tensor, &it, axes) == POINSOT_E_DOMAIN && it == NULL);
  tensor[1] = NAN;
  CHECK(poinsot_body_create_tensor(tensor, &it, axes) == POINSOT_E_DOMAIN && it == NULL);
  tensor[1] = 0.1;
  CHECK(poinsot_body_create_tensor(tensor, &it, NULL) == POINSOT_OK && it != NULL);
  poinsot_body_destroy(&it);
  CHECK(it == NULL);
  poinsot_body_destroy(&it);
  poinsot_body_destroy(NULL);

  CHECK(poinsot_body_create(moments, &it) == POINSOT_OK);
  CHECK(poinsot_rotate(NULL, "exact", 0.1, 1, 1, y, q, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_rotate(it, NULL, 0.1, 1, 1, y, q, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_rotate(it, "exact", 0.1, 1, 1, NULL, q, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_rotate(it, "exact", 0.1, 1, 1, y, NULL, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_rotate(it, "exakt", 0.1, 1, 1, y, q, NULL) == POINSOT_E_METHOD);
  CHECK(poinsot_rotate(it, "", 0.1, 1, 1, y, q, NULL) == POINSOT_E_METHOD);
  CHECK(poinsot_rotate(it, "exact", NAN, 1, 1, y, q, NULL) == POINSOT_E_DOMAIN);
  CHECK(poinsot_rotate(it, "exact", INFINITY, 1, 1, y, q, NULL) == POINSOT_E_DOMAIN);
  CHECK(poinsot_rotate(it, "exact", 0.1, 1, (size_t)-1, y, q, NULL) == POINSOT_E_SIZE);
  CHECK(poinsot_rotate(it, "exact", 0.1, 1, (size_t)1 << 40, y, q, NULL) == POINSOT_E_SIZE);
  CHECK(poinsot_rotate(it, "exact", 0.1, (size_t)-1, 1, y, q, NULL) == POINSOT_E_SIZE);
  CHECK(y[0] == 0.1 && q[0] == 1);
  CHECK(poinsot_rotate(it, "exact", 0.1, 1, 0, NULL, NULL, NULL) == POINSOT_OK);
  CHECK(poinsot_rotate(it, "exact", 0.1, 0, 1, y, q, each) == POINSOT_OK && y[0] == 0.1 && q[0] == 1 && each[0] == 0);
  CHECK(poinsot_rotate(it, "dmv8", 100.0, 1, 1, y, q, each) == POINSOT_E_PARTIAL && each[0] == POINSOT_E_STEP && y[0] == 0.1);
  q[0] = 0;
  CHECK(poinsot_rotate(it, "exact", 0.1, 1, 1, y, q, each) == POINSOT_E_PARTIAL && each[0] == POINSOT_E_NOT_UNIT && q[0] == 0);
  CHECK(poinsot_rotate(it, "exact", 0.1, 1, 2, y2[0], q2[0], each) == POINSOT_E_PARTIAL);
  CHECK(each[0] == POINSOT_E_NOT_FINITE && each[1] == POINSOT_OK && isnan(y2[0][0]) && q2[1][0] != 1);
  poinsot_body_destroy(&it);
}

static void jacobi(void) {
  double u[3] = {0.5, NAN, 1e6}, m[3] = {0.5, 0.5, 1.0}, m1[3] = {0.5, 0.5, 1e-300}, s[3], c[3], d[3];
  CHECK(poinsot_jacobi(3, NULL, m, NULL, s, c, d) == POINSOT_E_NULL);
  CHECK(poinsot_jacobi(3, u, NULL, NULL, s, c, d) == POINSOT_E_NULL);
  CHECK(poinsot_jacobi(3, u, m, NULL, NULL, c, d) == POINSOT_E_NULL);
  CHECK(poinsot_jacobi(0, NULL, NULL, NULL, NULL, NULL, NULL) == POINSOT_OK);
  CHECK(poinsot_jacobi((size_t)-1, u, m, NULL, s, c, d) == POINSOT_E_SIZE);
  CHECK(poinsot_jacobi(3, u, m, m1, s, c, d) == POINSOT_E_DOMAIN);
  CHECK(fabs(s[0] - 0.47075047365565734) < 1e-15 && isnan(s[1]) && fabs(d[2]*d[2] + s[2]*s[2] - 1) < 1e-12);
  CHECK(poinsot_jacobi(1, u, m, NULL, s, c, d) == POINSOT_OK && fabs(s[0]*s[0] + c[0]*c[0] - 1) < 1e-15);
  m[0] = 2;
  CHECK(poinsot_jacobi(1, u, m, NULL, s, c, d) == POINSOT_E_DOMAIN && isnan(s[0]));
}

static void plan(void) {
  poinsot_plan *it = NULL;
  const double bad[3] = {1, 1, 3}, tensor[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  double axes[9];
  char text[1024];
  int number = 7;
  size_t length, i;
  const char *const options[][2] = {{"method", "exakt"}, {"splitting", ""}, {"layout", "lamps"}, {"frame", "spice"},
                                    {"momentum", "L"}, {"colour", "red"}};
  const char *const settings[] = {"centre", "=", "centre = ", "= 1", "centre = 0, 0, one", "centre = 0 0", "centre = nan 0 0",
                                  "middle = 0 0 1", "centre = 'x'", "centre = 0 0 1; centre = 0 0 1", ";;;", "",
                                  "centre = 0 0 1; weight = 1e400", "centre = 0 0 1; class = 9; class = 1"};
  CHECK(poinsot_plan_create(NULL) == POINSOT_E_NULL);
  CHECK(poinsot_plan_add_class(NULL, moments, &number) == POINSOT_E_NULL && number == 7);
  CHECK(poinsot_plan_add_class_tensor(NULL, tensor, &number) == POINSOT_E_NULL);
  CHECK(poinsot_plan_class_axes(NULL, 0, axes) == POINSOT_E_NULL);
  CHECK(poinsot_plan_set(NULL, "method", "exact") == POINSOT_E_NULL);
  CHECK(poinsot_plan_add_effect(NULL, "gravity", "") == POINSOT_E_NULL);
  CHECK(poinsot_plan_ready(NULL) == POINSOT_E_NULL);
  CHECK(poinsot_plan_message(NULL, NULL, 0) == 0);
  CHECK(poinsot_plan_message(NULL, text, sizeof text) == 0 && text[0] == 0);

  CHECK(poinsot_plan_create(&it) == POINSOT_OK && it);
  CHECK(poinsot_plan_add_class(it, NULL, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_plan_add_class_tensor(it, NULL, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_plan_add_class(it, bad, &number) == POINSOT_E_DOMAIN && number == 7);
  length = poinsot_plan_message(it, NULL, 0);
  CHECK(length > 10);
  CHECK(poinsot_plan_message(it, NULL, 1000) == length);
  memset(text, 'x', sizeof text);
  CHECK(poinsot_plan_message(it, text, 8) == length && strlen(text) == 7 && text[8] == 'x');
  CHECK(poinsot_plan_message(it, text, 1) == length && text[0] == 0);
  CHECK(poinsot_plan_message(it, text, (size_t)-1) == length);
  CHECK(poinsot_plan_class_axes(it, 0, axes) == POINSOT_E_DOMAIN); /* no class yet */
  CHECK(poinsot_plan_add_class(it, moments, &number) == POINSOT_OK && number == 0);
  CHECK(poinsot_plan_class_axes(it, 0, NULL) == POINSOT_E_NULL && poinsot_plan_class_axes(it, -1, axes) == POINSOT_E_DOMAIN);
  CHECK(poinsot_plan_class_axes(it, 2147483647, axes) == POINSOT_E_DOMAIN);
  CHECK(poinsot_plan_class_axes(it, 0, axes) == POINSOT_OK && axes[0] == 1 && axes[1] == 0 && axes[8] == 1);
  CHECK(poinsot_plan_message(it, text, sizeof text) == 0);
  CHECK(poinsot_plan_add_effect(it, "gravity", "weight = 1e999") == POINSOT_E_DOMAIN);
  poinsot_plan_message(it, text, sizeof text);
  CHECK(strstr(text, "effect 'gravity': 'weight = 1e999': '1e999' must be finite and at most 1e307") != NULL);
  CHECK(poinsot_plan_add_class(it, moments, &number) == POINSOT_OK && number == 1);
  CHECK(poinsot_plan_find_class(NULL, moments, 0, &number) == POINSOT_E_NULL && number == 1);
  CHECK(poinsot_plan_find_class(it, NULL, 0, &number) == POINSOT_E_NULL);
  CHECK(poinsot_plan_find_class(it, moments, -1, &number) == POINSOT_E_DOMAIN && number == 1);
  CHECK(poinsot_plan_find_class(it, moments, NAN, &number) == POINSOT_E_DOMAIN);
  CHECK(poinsot_plan_find_class(it, bad, 0, &number) == POINSOT_E_DOMAIN);
  CHECK(poinsot_plan_find_class(it, moments, 0, &number) == POINSOT_OK && number == 0);
  CHECK(poinsot_plan_find_class(it, moments, 1e-6, NULL) == POINSOT_OK);
  CHECK(poinsot_plan_set(it, NULL, "exact") == POINSOT_E_NULL);
  CHECK(poinsot_plan_set(it, "method", NULL) == POINSOT_E_NULL);
  for (i = 0; i < sizeof options / sizeof *options; i++)
    CHECK(poinsot_plan_set(it, options[i][0], options[i][1]) == POINSOT_E_METHOD);
  CHECK(poinsot_plan_set(it, "threads", "-1") == POINSOT_E_DOMAIN);
  CHECK(poinsot_plan_set(it, "threads", "99999999999999999999") == POINSOT_E_DOMAIN);
  CHECK(poinsot_plan_set(it, "threads", "two") == POINSOT_E_DOMAIN);
  CHECK(poinsot_plan_set(it, "seed", "1.5") == POINSOT_E_DOMAIN);
  CHECK(poinsot_plan_add_effect(it, NULL, "") == POINSOT_E_NULL);
  CHECK(poinsot_plan_add_effect(it, "grawity", "centre = 0 0 1") == POINSOT_E_METHOD);
  CHECK(poinsot_plan_add_effect(it, "callback", NULL) == POINSOT_E_DOMAIN);
  CHECK(poinsot_plan_add_effect(it, "gravity", NULL) != POINSOT_OK);
  for (i = 0; i < sizeof settings / sizeof *settings; i++) {
    CHECK(poinsot_plan_add_effect(it, "gravity", settings[i]) != POINSOT_OK);
    CHECK(poinsot_plan_message(it, NULL, 0) > 0);
  }
  {
    char *endless = malloc(200001);
    memset(endless, 'x', 200000);
    endless[200000] = 0;
    CHECK(poinsot_plan_add_effect(it, "gravity", endless) != POINSOT_OK);
    CHECK(poinsot_plan_set(it, "method", endless) == POINSOT_E_METHOD);
    CHECK(poinsot_plan_set(it, endless, "exact") == POINSOT_E_METHOD);
    free(endless);
  }
  CHECK(poinsot_plan_add_effect(it, "gravity", "\tcentre = 0, 0, 1 ;\n class=2;") == POINSOT_OK);
  CHECK(poinsot_plan_add_effect(it, "gravity", "centre = 0 0 1; class = 3") == POINSOT_OK);
  CHECK(poinsot_plan_ready(it) == POINSOT_E_DOMAIN); /* class 3 does not exist */
  poinsot_plan_destroy(&it);
  CHECK(it == NULL);
  poinsot_plan_destroy(&it);
  poinsot_plan_destroy(NULL);

  it = ready_plan("native");
  CHECK(poinsot_plan_ready(it) == POINSOT_E_DOMAIN);
  CHECK(poinsot_plan_set(it, "method", "jacobi") == POINSOT_E_DOMAIN);
  CHECK(poinsot_plan_add_class(it, moments, NULL) == POINSOT_E_DOMAIN);
  CHECK(poinsot_plan_add_effect(it, "gravity", "centre = 0 0 1") == POINSOT_E_DOMAIN);
  poinsot_plan_destroy(&it);
}

static int quiet(void *context, double t, size_t n, const double *const q[4], ptrdiff_t q_stride, double *const torque[3],
                 ptrdiff_t torque_stride, double *energy) {
  (void)t, (void)n, (void)q, (void)q_stride, (void)torque, (void)torque_stride, (void)energy;
  return context != NULL;
}

static int not_finite(void *context, double t, size_t n, const double *const q[4], ptrdiff_t q_stride, double *const torque[3],
                      ptrdiff_t torque_stride, double *energy) {
  (void)context, (void)t, (void)n, (void)q, (void)q_stride, (void)torque_stride, (void)energy;
  torque[1][0] = NAN;
  return 0;
}

static void bodies(void) {
  enum { n = 3 };
  double y[n][3], q[n][4], y0[n][3], q0[n][4], torque[3] = {0, 0, 0}, carry[7 * n] = {0}, kinetic[n], potential[n];
  const double *const pushes[3] = {torque, torque, torque}, *const missing[3] = {torque, NULL, torque};
  double *const columns[4] = {y[0], y[0], y[0], NULL}, *const attitudes[4] = {q[0], q[0], q[0], q[0]};
  poinsot_plan *it = ready_plan("native"), *four = ready_plan("hoomd"), *open = NULL;
  poinsot_bodies view, v;
  struct {
    poinsot_bodies known;
    double more[4];
  } newer;
  poinsot_status each[n];
  int classes[n] = {0, 0, 0}, nobody[n] = {2147483647, 2, 1}, skipped[n] = {-1, -2147483647 - 1, -7};
  const int rows[n] = {4, 0, 2}, below[n] = {0, -1, 1};
  int64_t id[n] = {-5, 9223372036854775807LL, 0};
  char text[200];
  size_t count;
  int i;
  for (i = 0; i < n; i++) {
    const double yi[3] = {0.1 + i, 0.2, -0.3}, qi[4] = {0.6, 0, 0.8, 0};
    memcpy(y[i], yi, sizeof yi);
    memcpy(q[i], qi, sizeof qi);
  }
  memcpy(y0, y, sizeof y);
  memcpy(q0, q, sizeof q);

  CHECK(poinsot_bodies_rows(NULL, "native", NULL, n, y[0], q[0]) == POINSOT_E_NULL);
  CHECK(poinsot_bodies_rows(&view, NULL, NULL, n, y[0], q[0]) == POINSOT_E_NULL);
  CHECK(poinsot_bodies_rows(&view, "native", NULL, n, NULL, q[0]) == POINSOT_E_NULL);
  CHECK(poinsot_bodies_rows(&view, "native", NULL, n, y[0], NULL) == POINSOT_E_NULL);
  CHECK(poinsot_bodies_rows(&view, "nativ", NULL, n, y[0], q[0]) == POINSOT_E_METHOD);
  CHECK(poinsot_bodies_rows(&view, "native", "zyxw", n, y[0], q[0]) == POINSOT_E_METHOD);
  CHECK(poinsot_bodies_rows(&view, "native", NULL, (size_t)-1, y[0], q[0]) == POINSOT_E_SIZE);
  CHECK(poinsot_bodies_rows(&view, "native", NULL, 0, NULL, NULL) == POINSOT_OK);
  CHECK(poinsot_drift(it, &view, 0.1) == POINSOT_OK);
  CHECK(poinsot_step(it, &view, 0, 0.1, 0, 3, quiet, NULL) == POINSOT_OK);
  CHECK(poinsot_kick(it, &view, 0.1, pushes, 1) == POINSOT_OK);
  CHECK(poinsot_energy(it, &view, 0.1, NULL, NULL) == POINSOT_OK);
  CHECK(poinsot_momentum(it, &view, NULL) == POINSOT_OK);
  CHECK(poinsot_degrees_of_freedom(it, &view, &count) == POINSOT_OK && count == 0);
  CHECK(poinsot_bodies_arrays(NULL, "native", 1, columns, attitudes) == POINSOT_E_NULL);
  CHECK(poinsot_bodies_arrays(&view, "native", 1, NULL, attitudes) == POINSOT_E_NULL);
  CHECK(poinsot_bodies_arrays(&view, "native", 1, columns, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_bodies_arrays(&view, "hoomd", 1, columns, attitudes) == POINSOT_E_NULL);
  CHECK(poinsot_bodies_arrays(&view, "native", 1, columns, attitudes) == POINSOT_OK);

  CHECK(poinsot_bodies_rows(&view, "native", NULL, n, y[0], q[0]) == POINSOT_OK);
  view.status = each;
  CHECK(poinsot_drift(NULL, &view, 0.1) == POINSOT_E_NULL);
  CHECK(poinsot_drift(it, NULL, 0.1) == POINSOT_E_NULL);
  CHECK(poinsot_dissipate(NULL, &view, 0.1, 1) == POINSOT_E_NULL);
  CHECK(poinsot_dissipate(it, NULL, 0.1, 1) == POINSOT_E_NULL);
  CHECK(poinsot_dissipate(it, &view, NAN, 1) == POINSOT_E_DOMAIN);
  CHECK(poinsot_dissipate(it, &view, -0.1, 1) == POINSOT_E_DOMAIN);
  CHECK(poinsot_dissipate(it, &view, 0.1, 1) == POINSOT_OK); /* no drag, no noise: nothing to do */
  CHECK(poinsot_kick(NULL, &view, 0.1, pushes, 1) == POINSOT_E_NULL);
  CHECK(poinsot_kick(it, NULL, 0.1, pushes, 1) == POINSOT_E_NULL);
  CHECK(poinsot_kick(it, &view, 0.1, NULL, 1) == POINSOT_E_NULL);
  CHECK(poinsot_kick(it, &view, 0.1, missing, 1) == POINSOT_E_NULL);
  CHECK(poinsot_kick(it, &view, 0.1, pushes, 0) == POINSOT_E_SIZE);
  CHECK(poinsot_kick(it, &view, 0.1, pushes, -3) == POINSOT_E_SIZE);
  CHECK(poinsot_kick(it, &view, NAN, pushes, 1) == POINSOT_E_DOMAIN);
  CHECK(poinsot_step(NULL, &view, 0, 0.1, 0, 1, NULL, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_step(it, NULL, 0, 0.1, 0, 1, NULL, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_step(it, &view, NAN, 0.1, 0, 1, NULL, NULL) == POINSOT_E_DOMAIN);
  CHECK(poinsot_step(it, &view, 0, INFINITY, 0, 1, NULL, NULL) == POINSOT_E_DOMAIN);
  CHECK(poinsot_step(it, &view, 0, 0.1, 0, -1, NULL, NULL) == POINSOT_E_SIZE);
  CHECK(poinsot_step(it, &view, 0, 0.1, 9223372036854775807LL, 2, NULL, NULL) == POINSOT_E_SIZE);
  CHECK(poinsot_step(it, &view, 0, 0.1, 0, 1, quiet, &view) == POINSOT_E_CALLBACK);
  CHECK(poinsot_drift(it, &view, NAN) == POINSOT_E_DOMAIN);
  CHECK(poinsot_energy(NULL, &view, 0, kinetic, potential) == POINSOT_E_NULL);
  CHECK(poinsot_energy(it, NULL, 0, kinetic, potential) == POINSOT_E_NULL);
  CHECK(poinsot_energy(it, &view, NAN, kinetic, potential) == POINSOT_E_DOMAIN);
  CHECK(poinsot_momentum(NULL, &view, kinetic) == POINSOT_E_NULL);
  CHECK(poinsot_momentum(it, NULL, kinetic) == POINSOT_E_NULL);
  CHECK(poinsot_momentum(it, &view, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_degrees_of_freedom(NULL, &view, &count) == POINSOT_E_NULL);
  CHECK(poinsot_degrees_of_freedom(it, NULL, &count) == POINSOT_E_NULL);
  CHECK(poinsot_degrees_of_freedom(it, &view, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_degrees_of_freedom(it, &view, &count) == POINSOT_OK && count == 9);
  CHECK(poinsot_bodies_check(it, NULL, text, sizeof text) == POINSOT_E_NULL && strlen(text) > 0);
  CHECK(poinsot_bodies_check(NULL, &view, text, sizeof text) == POINSOT_E_NULL && strlen(text) > 0);
  CHECK(poinsot_bodies_check(four, &view, text, sizeof text) == POINSOT_E_SIZE && strstr(text, "y_fourth"));
  CHECK(poinsot_bodies_check(it, &view, NULL, 0) == POINSOT_OK);
  CHECK(poinsot_drift(four, &view, 0.1) == POINSOT_E_SIZE);
  CHECK(poinsot_plan_create(&open) == POINSOT_OK && poinsot_plan_add_class(open, moments, NULL) == POINSOT_OK &&
        poinsot_plan_add_effect(open, "gyrostat", "times = 0, 1; table = 0, 0, 1, 0, 0, 2") == POINSOT_OK &&
        poinsot_plan_ready(open) == POINSOT_OK);
  CHECK(poinsot_drift(open, &view, 0.1) == POINSOT_E_METHOD);
  CHECK(poinsot_bodies_check(open, &view, text, sizeof text) == POINSOT_E_METHOD && strstr(text, "not given the time"));
  poinsot_plan_destroy(&open);

  CHECK(poinsot_plan_create(&open) == POINSOT_OK);
  CHECK(poinsot_drift(open, &view, 0.1) == POINSOT_E_DOMAIN);
  CHECK(poinsot_kick(open, &view, 0.1, pushes, 1) == POINSOT_E_DOMAIN);
  CHECK(poinsot_step(open, &view, 0, 0.1, 0, 1, NULL, NULL) == POINSOT_E_DOMAIN);
  CHECK(poinsot_energy(open, &view, 0.1, kinetic, NULL) == POINSOT_E_DOMAIN);
  CHECK(poinsot_degrees_of_freedom(open, &view, &count) == POINSOT_E_DOMAIN);
  poinsot_plan_destroy(&open);

#define WITH(change, expected) v = view; change; CHECK(poinsot_drift(it, &v, 0.1) == expected)
  WITH(v.size = 0, POINSOT_E_SIZE);
  WITH(v.size = sizeof v - 8, POINSOT_E_SIZE);
  WITH(v.size = (size_t)-1, POINSOT_E_SIZE);
  WITH(v.n = (size_t)-1, POINSOT_E_SIZE);
  WITH(v.n = (size_t)1 << 31, POINSOT_E_SIZE);
  WITH(v.y_stride = 0, POINSOT_E_SIZE);
  WITH(v.q_stride = -4, POINSOT_E_SIZE);
  WITH(v.q_stride = PTRDIFF_MAX, POINSOT_E_SIZE);
  WITH(v.y[2] = NULL, POINSOT_E_NULL);
  WITH(v.q[0] = NULL, POINSOT_E_NULL);
  WITH(v.first_class = 2, POINSOT_E_SIZE);
  WITH(v.body_class = nobody, POINSOT_E_PARTIAL);
  for (i = 0; i < n; i++) CHECK(each[i] == POINSOT_E_DOMAIN);
  CHECK(poinsot_degrees_of_freedom(it, &v, &count) == POINSOT_OK && count == 0);
  WITH(v.body_class = skipped, POINSOT_OK);
  for (i = 0; i < n; i++) CHECK(each[i] == POINSOT_OK);
  CHECK(poinsot_degrees_of_freedom(it, &v, &count) == POINSOT_OK && count == 0);
  CHECK(poinsot_energy(it, &v, 0, kinetic, potential) == POINSOT_OK && kinetic[0] == 0 && potential[2] == 0);
  WITH(v.class_stride = -1, POINSOT_E_SIZE);
  WITH((v.y_at = rows, v.rows = 3), POINSOT_E_SIZE);   /* row 4 of three */
  WITH((v.q_at = below, v.rows = 0), POINSOT_E_SIZE);  /* a negative one */
  WITH((v.scale = v.moments[0] = v.moments[1] = v.moments[2] = kinetic), POINSOT_E_METHOD);
  for (i = 0; i < n; i++) kinetic[i] = -1;
  WITH(v.scale = kinetic, POINSOT_E_PARTIAL);
  WITH((v.moments[0] = v.moments[1] = v.moments[2] = kinetic), POINSOT_E_PARTIAL);
  for (i = 0; i < n; i++) CHECK(each[i] == POINSOT_E_DOMAIN);
  WITH((v.moments[0] = v.moments[1] = kinetic), POINSOT_E_NULL);
  memset(&newer, 0, sizeof newer);
  newer.known = view;
  newer.known.size = sizeof newer;
  newer.more[3] = 1;
  CHECK(poinsot_drift(it, &newer.known, 0.1) == POINSOT_E_SIZE);
  CHECK(poinsot_step(it, &view, 0, 0.1, 0, 0, NULL, NULL) == POINSOT_OK);
  CHECK(memcmp(y, y0, sizeof y) == 0 && memcmp(q, q0, sizeof q) == 0); /* nothing has moved so far */
  newer.more[3] = 0;
  CHECK(poinsot_drift(it, &newer.known, 0.1) == POINSOT_OK);
  CHECK(memcmp(q, q0, sizeof q) != 0);

  memcpy(y, y0, sizeof y);
  memcpy(q, q0, sizeof q);
  q[1][2] = 1e300;
  y[2][0] = INFINITY;
  view.body_class = classes;
  view.id = id;
  view.carry = carry;
  CHECK(poinsot_drift(it, &view, 0.1) == POINSOT_E_PARTIAL);
  CHECK(each[0] == POINSOT_OK && each[1] == POINSOT_E_NOT_UNIT && each[2] == POINSOT_E_NOT_FINITE);
  CHECK(q[1][2] == 1e300 && isinf(y[2][0]) && memcmp(q[2], q0[2], sizeof q[2]) == 0 && q[0][0] != q0[0][0]);
  CHECK(poinsot_energy(it, &view, 0, kinetic, potential) == POINSOT_E_PARTIAL && kinetic[1] == 0 && kinetic[0] > 0);
  torque[0] = NAN;
  CHECK(poinsot_kick(it, &view, 0.1, pushes, 1) == POINSOT_E_PARTIAL && each[0] == POINSOT_E_NOT_FINITE);
  memcpy(y, y0, sizeof y);
  memcpy(q, q0, sizeof q);
  CHECK(poinsot_step(it, &view, 0, 0.1, 0, 2, not_finite, NULL) == POINSOT_E_PARTIAL);
  CHECK(each[0] == POINSOT_E_NOT_FINITE && each[1] == POINSOT_OK && memcmp(y[0], y0[0], sizeof y[0]) == 0);
  poinsot_plan_destroy(&it);
  poinsot_plan_destroy(&four);
}

/* ---- the short way --------------------------------------------------------------------------------------------------- */

/* What a view asks for decides the way it takes; the bits and the statuses are the same. */
static void ways(void) {
  enum { most = 70 };
  static double y[2][most][3], q[2][most][4], g[most][3];
  static int in_order[most];
  const double thin[3] = {1, 1, 0}, *const torque[3] = {&g[0][0], &g[0][1], &g[0][2]};
  poinsot_status each[2][most];
  int n, k, way, i, j;
  for (i = 0; i < most; i++) in_order[i] = i;
  for (k = 0; k < 3; k++) {                        /* a body of three moments, one of two, and long steps */
    poinsot_plan *plan = NULL;
    CHECK(poinsot_plan_create(&plan) == POINSOT_OK && poinsot_plan_add_class(plan, k == 1 ? thin : moments, NULL) == POINSOT_OK &&
          poinsot_plan_ready(plan) == POINSOT_OK);
    for (n = 1; n <= most; n += n < 40 ? 1 : 6) {
      poinsot_status status[2][4];
      for (way = 0; way < 2; way++) {
        poinsot_bodies view;
        for (i = 0; i < n; i++) {
          for (j = 0; j < 3; j++) y[way][i][j] = k == 1 && j == 2 ? 0 : (0.3 + 0.01 * i + 0.2 * j) * (i == 5 ? 40 : 1);
          for (j = 0; j < 3; j++) g[i][j] = 0.7 * i - j;
          for (j = 0; j < 4; j++) q[way][i][j] = i % 3 ? j == 1 : 0.5;
        }
        if (n > 9) q[way][7][1] = NAN;
        if (n > 12) y[way][9][0] = 1e300;
        if (n > 20) g[17][1] = NAN;
        if (n > 22) g[18][1] = 1e308;
        CHECK(poinsot_bodies_rows(&view, "native", NULL, (size_t)n, y[way][0], q[way][0]) == POINSOT_OK);
        view.status = each[way];
        if (way) view.y_at = in_order;             /* no more than the same said at length */
        status[way][0] = poinsot_drift(plan, &view, k == 2 ? 3 : 0.1);
        status[way][1] = poinsot_step(plan, &view, 0, 0.05, 4, 3, NULL, NULL);
        status[way][2] = poinsot_drift(plan, &view, -0.2);
        status[way][3] = poinsot_kick(plan, &view, 0.03, torque, 3);
      }
      CHECK(memcmp(status[0], status[1], sizeof status[0]) == 0);
      CHECK(memcmp(each[0], each[1], (size_t)n * sizeof each[0][0]) == 0);
      CHECK(memcmp(y[0], y[1], (size_t)n * sizeof y[0][0]) == 0 && memcmp(q[0], q[1], (size_t)n * sizeof q[0][0]) == 0);
      CHECK(n < 24 || each[0][17] == POINSOT_E_NOT_FINITE);
      CHECK(n < 24 || each[0][18] == POINSOT_E_DOMAIN);
    }
    poinsot_plan_destroy(&plan);
  }
  {                                                /* many bodies at once, or thirty at a time; by moments */
    enum { many = 300 };
    static double u[3][many][3], v[3][many][4];
    static poinsot_status told[3][many];
    const double line[3] = {0, 0.7, 0.7};
    const int methods[2] = {1, 2};
    int steps = 3, whole = many, status, m;
    double h = 0.4;
    for (m = 0; m < 2; m++)
      for (k = 0; k < 2; k++) {
        const double *const of = k ? line : moments;
        poinsot_body *body;
        for (way = 0; way < 3; way++)
          for (i = 0; i < many; i++) {
            for (j = 0; j < 3; j++) u[way][i][j] = k && j == 0 ? i == 40 : 0.2 + 0.003 * i - 0.1 * j;
            for (j = 0; j < 4; j++) v[way][i][j] = i % 3 ? j == 2 : 0.5;
            if (i == 77) v[way][i][0] = 7;
          }
        CHECK(poinsot_body_create(of, &body) == POINSOT_OK);
        CHECK(poinsot_rotate(body, poinsot_method_name((size_t)m), h, 3, many, u[0][0], v[0][0], told[0]) == POINSOT_E_PARTIAL);
        for (i = 0; i < many; i += 30)
          (void)poinsot_rotate(body, poinsot_method_name((size_t)m), h, 3, 30, u[1][i], v[1][i], &told[1][i]);
        poinsot_body_destroy(&body);
        poinsot_rotate_f_(of, &methods[m], &h, &steps, &whole, u[2][0], v[2][0], told[2], &status);
        CHECK(status == POINSOT_E_PARTIAL && told[0][77] == POINSOT_E_NOT_UNIT);
        CHECK((told[0][40] == POINSOT_E_AXIS_MOMENTUM) == (k == 1));
        CHECK(memcmp(u[0], u[1], sizeof u[0]) == 0 && memcmp(v[0], v[1], sizeof v[0]) == 0);
        CHECK(memcmp(told[0], told[1], sizeof told[0]) == 0 && memcmp(told[0], told[2], sizeof told[0]) == 0);
        for (i = 0; i < many; i++) {
          for (j = 0; j < 3; j++) CHECK(fabs(u[0][i][j] - u[2][i][j]) < 4e-15);
          for (j = 0; j < 4; j++) CHECK(fabs(v[0][i][j] - v[2][i][j]) < 4e-15);
        }
      }
    poinsot_rotate_f_(moments, &methods[0], &h, &steps, &whole, NULL, v[2][0], told[2], &status);
    CHECK(status == POINSOT_E_NULL);
    poinsot_rotate_f_(NULL, &methods[0], &h, &steps, &whole, u[2][0], v[2][0], told[2], &status);
    CHECK(status == POINSOT_E_NULL);
    h = NAN;
    poinsot_rotate_f_(moments, &methods[1], &h, &steps, &whole, u[2][0], v[2][0], told[2], &status);
    CHECK(status == POINSOT_E_DOMAIN);
    whole = -1;
    poinsot_rotate_f_(moments, &methods[1], &h, &steps, &whole, u[2][0], v[2][0], told[2], &status);
    CHECK(status == POINSOT_E_SIZE);
  }
}

/* ---- the struct of another version, rows of the caller's choice ----------------------------------------------------- */

/* The functions behind the macros: what a program compiled with 0.1 calls. */
static poinsot_status (*const rows_of_0_1)(poinsot_bodies *, const char *, const char *, size_t, double[], double[]) =
    poinsot_bodies_rows;

static void growth(void) {
  enum { old = 136, n = 2 };
  union {
    poinsot_bodies view;
    unsigned char bytes[sizeof(poinsot_bodies) + 64];
  } room;
  poinsot_bodies view;
  double y[5][3] = {{0}}, q[5][4] = {{0}}, y2[n][3], q2[n][4];
  const int y_at[n] = {3, 1}, q_at[n] = {0, 4}, classes[4] = {0, 9, 1, 9}, skipped_of_two[n] = {0, -1};
  poinsot_plan *plan = NULL;
  poinsot_status each[n];
  size_t i;
  int j;
  CHECK(poinsot_plan_create(&plan) == POINSOT_OK && poinsot_plan_add_class(plan, moments, NULL) == POINSOT_OK &&
        poinsot_plan_add_class(plan, moments, NULL) == POINSOT_OK && poinsot_plan_ready(plan) == POINSOT_OK);
  for (i = 0; i < 5; i++)
    for (j = 0; j < 4; j++) {
      if (j < 3) y[i][j] = 0.1 * (double)i + j;
      q[i][j] = j == 0;
    }
  memset(&room, 0x5a, sizeof room);
  CHECK(rows_of_0_1(&room.view, "native", NULL, n, y[0], q[0]) == POINSOT_OK && room.view.size == old);
  for (i = old; i < sizeof room; i++) CHECK(room.bytes[i] == 0x5a);
  CHECK(poinsot_drift(plan, &room.view, 0.1) == POINSOT_OK); /* what follows is not read */
  CHECK(poinsot_bodies_rows_sized(&room.view, old + 8, "native", NULL, n, y[0], q[0]) == POINSOT_E_SIZE);
  CHECK(poinsot_bodies_rows_sized(&room.view, sizeof room.view, "native", NULL, n, y[0], q[0]) == POINSOT_OK);
  for (i = sizeof room.view; i < sizeof room; i++) CHECK(room.bytes[i] == 0x5a);

  for (i = 0; i < n; i++) {
    memcpy(y2[i], y[y_at[i]], sizeof y2[i]);
    memcpy(q2[i], q[q_at[i]], sizeof q2[i]);
  }
  CHECK(poinsot_bodies_rows(&view, "native", NULL, n, y2[0], q2[0]) == POINSOT_OK);
  CHECK(poinsot_drift(plan, &view, 0.1) == POINSOT_OK);
  CHECK(poinsot_bodies_rows(&view, "native", NULL, n, y[0], q[0]) == POINSOT_OK);
  view.y_at = y_at;
  view.q_at = q_at;
  view.rows = 5;
  view.status = each;
  view.body_class = classes;
  view.class_stride = 2;
  CHECK(poinsot_drift(plan, &view, 0.1) == POINSOT_OK && each[0] == POINSOT_OK && each[1] == POINSOT_OK);
  for (i = 0; i < n; i++)
    CHECK(memcmp(y2[i], y[y_at[i]], sizeof y2[i]) == 0 && memcmp(q2[i], q[q_at[i]], sizeof q2[i]) == 0);

  {                                                /* a body of twice the size; one of any moments, rows of three */
    const double twice[n] = {2, 1}, own[n][4] = {{2 * moments[0], 2 * moments[1], 2 * moments[2]}, {moments[0], moments[1], moments[2]}};
    double y3[n][3], q3[n][4], kinetic[n], potential[n];
    poinsot_plan *bare = NULL, *heavy = NULL;
    CHECK(poinsot_plan_create(&bare) == POINSOT_OK && poinsot_plan_ready(bare) == POINSOT_OK);
    CHECK(poinsot_plan_create(&heavy) == POINSOT_OK && poinsot_plan_add_class(heavy, own[0], NULL) == POINSOT_OK &&
          poinsot_plan_add_class(heavy, own[1], NULL) == POINSOT_OK && poinsot_plan_ready(heavy) == POINSOT_OK);
    memcpy(y3, y2, sizeof y3);
    memcpy(q3, q2, sizeof q3);
    CHECK(poinsot_bodies_rows(&view, "native", NULL, n, y3[0], q3[0]) == POINSOT_OK);
    view.status = each;
    for (j = 0; j < 3; j++) view.moments[j] = own[0] + j;
    view.moments_stride = 4;
    CHECK(poinsot_drift(bare, &view, 0.1) == POINSOT_OK && poinsot_energy(bare, &view, 0, kinetic, potential) == POINSOT_OK);
    CHECK(poinsot_bodies_rows(&view, "native", NULL, n, y2[0], q2[0]) == POINSOT_OK);
    view.status = each;
    CHECK(poinsot_drift(bare, &view, 0.1) == POINSOT_E_PARTIAL && each[0] == POINSOT_E_DOMAIN); /* of no class */
    view.scale = twice;
    CHECK(poinsot_drift(plan, &view, 0.1) == POINSOT_OK);
    for (i = 0; i < n; i++) {
      for (j = 0; j < 3; j++) CHECK(fabs(y3[i][j] - y2[i][j]) < 1e-14);
      for (j = 0; j < 4; j++) CHECK(fabs(q3[i][j] - q2[i][j]) < 1e-14);
    }
    view.scale = NULL;
    view.body_class = skipped_of_two;
    CHECK(poinsot_energy(heavy, &view, 0, potential, NULL) == POINSOT_OK && fabs(potential[0] - kinetic[0]) < 1e-14);
    poinsot_plan_destroy(&bare);
    poinsot_plan_destroy(&heavy);
  }
  poinsot_plan_destroy(&plan);
}

/* ---- fixed form ------------------------------------------------------------------------------------------------------ */

static void fixed_form(void) {
  enum { n = 3 };
  int64_t plan = 0;
  int status, number, each[n], bodies = n, length = 60, name_length = 10, settings_length = 40, one = 1;
  const double h = 0.1, tolerance = 1e-3, coarse = 1, first[3] = {1, 0.6, 0.8}, second[3] = {2, 1.1, 1.9};
  const int none[n] = {0, 0, 0}, mixed[n] = {0, 2, -1}, twos[n] = {2, 1, 1};
  double y[n][3], q[n][4], y2[n][3], q2[n][4], x[4][n];
  char text[61] = "";
  size_t i;
#define START(y, q) for (i = 0; i < n; i++) { \
    y[i][0] = 0.1; y[i][1] = 0.2; y[i][2] = 0.3; q[i][0] = 1; q[i][1] = q[i][2] = q[i][3] = 0; }
  poinsot_plan_create_f_(&plan, &status);
  CHECK(status == POINSOT_OK);
  poinsot_plan_add_class_f_(&plan, first, &number, &status);
  poinsot_plan_find_class_f_(&plan, first, &tolerance, &number, &status);
  CHECK(status == POINSOT_OK && number == 1);
  poinsot_plan_find_class_f_(&plan, second, &tolerance, &number, &status);
  CHECK(status == POINSOT_OK && number == 2);
  poinsot_plan_tolerance_f_(&plan, &tolerance, &status);
  CHECK(status == POINSOT_OK);
  poinsot_plan_tolerance_f_(&plan, &coarse, &status);
  CHECK(status == POINSOT_E_DOMAIN);
  poinsot_plan_message_f_(&plan, text, &length);
  CHECK(strncmp(text, "plan: tolerance = '1'", 21) == 0);
  poinsot_plan_effect_f_(&plan, "gravity   ", &name_length, "centre = 0 0 1; class = 2               ", &settings_length,
                         &status);
  CHECK(status == POINSOT_OK);
  poinsot_plan_message_f_(&plan, text, &length);
  CHECK(text[0] == ' ' && text[59] == ' ');
  number = POINSOT_E_NOT_UNIT;
  poinsot_status_text_f_(&number, text, &length);
  CHECK(strncmp(text, "the attitude is not a unit quaternion  ", 39) == 0 && text[59] == ' ');
  poinsot_plan_ready_f_(&plan, &status);
  CHECK(status == POINSOT_OK);
  START(y, q)
  START(y2, q2)
  poinsot_drift_f_(&plan, &bodies, y[0], q[0], none, &h, each, &status); /* all of class 1 */
  CHECK(status == POINSOT_OK && memcmp(q[0], q[2], sizeof q[0]) == 0);
  poinsot_drift_f_(&plan, &bodies, y2[0], q2[0], twos, &h, each, &status);
  CHECK(status == POINSOT_OK && memcmp(q2[0], q[0], sizeof q[0]) != 0 && memcmp(q2[1], q[1], sizeof q[0]) == 0);
  START(y, q)
  poinsot_drift_f_(&plan, &bodies, y[0], q[0], mixed, &h, each, &status);
  CHECK(status == POINSOT_E_PARTIAL && each[0] == POINSOT_E_DOMAIN && each[1] == POINSOT_OK && each[2] == POINSOT_OK);
  CHECK(q[0][0] == 1 && memcmp(q[1], q2[0], sizeof q[1]) == 0 && q[2][0] == 1);
  { /* four components, of a plan that takes three */
    double w[4][n] = {{1, 1, 1}};
    for (i = 0; i < n; i++) x[0][i] = 0, x[1][i] = 0.2, x[2][i] = 0.4, x[3][i] = 0.6;
    poinsot_drift_c_f_(&plan, &bodies, x[0], x[1], x[2], x[3], w[0], w[1], w[2], w[3], none, &h, each, &status);
    CHECK(status == POINSOT_E_METHOD && w[0][0] == 1);
    poinsot_kick_c_f_(&plan, &bodies, x[0], x[1], x[2], x[3], w[0], w[1], w[2], w[3], none, &h, x[0], x[1], x[2], each, &status);
    CHECK(status == POINSOT_E_METHOD && x[1][0] == 0.2);
  }
  poinsot_plan_destroy_f_(&plan);
  poinsot_plan_create_f_(&plan, &status);
  poinsot_plan_add_class_f_(&plan, second, &number, &status);
  { /* numbers as the locale writes them, if there is one with a comma; what has no name is refused in words */
    static const char *const commas[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "fr_FR.utf8", "C"};
    const double centre[3] = {0, 0, 0.5}, up[3] = {0, 0.5, 1}, weight = 1.5, tolerance = 1e-9;
    char words[100];
    for (i = 0; i < 5 && !setlocale(LC_NUMERIC, commas[i]); i++) continue;
    poinsot_plan_gravity_f_(&plan, centre, &weight, up, &status);
    CHECK(status == POINSOT_OK);
    poinsot_plan_tolerance_f_(&plan, &tolerance, &status);
    CHECK(status == POINSOT_OK);
    setlocale(LC_NUMERIC, "C");
    poinsot_plan_set_f_(&plan, &(int){1}, &(int){99999}, &status);
    poinsot_plan_message_f_(&plan, words, &(int){100});
    CHECK(status == POINSOT_E_METHOD && memcmp(words, "unknown method '99999'", 22) == 0);
    poinsot_plan_set_f_(&plan, &(int){99}, &(int){1}, &status);
    poinsot_plan_message_f_(&plan, words, &(int){100});
    CHECK(status == POINSOT_E_METHOD && memcmp(words, "plan: unknown option '99'", 25) == 0);
    poinsot_plan_destroy_f_(&plan);
    poinsot_plan_create_f_(&plan, &status);
    poinsot_plan_add_class_f_(&plan, second, &number, &status);
  }
  number = 4; /* hoomd */
  poinsot_plan_set_f_(&plan, &(int){3}, &number, &status);
  poinsot_plan_ready_f_(&plan, &status);
  for (i = 0; i < n; i++) x[0][i] = 0, x[1][i] = 0.2, x[2][i] = 0.4, x[3][i] = 0.6;
  {
    double w[4][n] = {{1, 1, 1}};
    poinsot_drift_c_f_(&plan, &bodies, x[0], x[1], x[2], x[3], w[0], w[1], w[2], w[3], none, &h, each, &status);
    CHECK(status == POINSOT_OK && fabs(w[0][0] - q2[0][0]) < 1e-14 && fabs(w[3][2] - q2[0][3]) < 1e-14);
    bodies = one;
    poinsot_kick_c_f_(&plan, &bodies, x[0], x[1], x[2], x[3], w[0], w[1], w[2], w[3], none, &h, x[0], x[1], x[2], each, &status);
    CHECK(status == POINSOT_OK);
  }
  poinsot_plan_destroy_f_(&plan);
  { /* drag in rows, in component arrays, and of conjugate momenta: the same */
    static const char drag[] = "rate = 0.5";
    const int what = 4, said = 10, step = 3, four = 4;
    double p[4][n], w[4][n] = {{1, 1, 1}}, a[3][n];
    bodies = n;
    poinsot_plan_create_f_(&plan, &status);
    poinsot_plan_add_class_f_(&plan, second, &number, &status);
    poinsot_plan_effect_f_(&plan, "drag", &what, drag, &said, &status);
    CHECK(status == POINSOT_OK);
    poinsot_plan_ready_f_(&plan, &status);
    START(y, q)
    for (i = 0; i < n; i++) a[0][i] = 0.1, a[1][i] = 0.2, a[2][i] = 0.3;
    poinsot_dissipate_f_(&plan, &bodies, y[0], q[0], none, &h, &step, each, &status);
    CHECK(status == POINSOT_OK && fabs(y[0][0] - 0.1 * exp(-0.05)) < 1e-16 && q[2][0] == 1);
    poinsot_dissipate_a_f_(&plan, &bodies, a[0], a[1], a[2], w[0], w[1], w[2], w[3], none, &h, &step, each, &status);
    CHECK(status == POINSOT_OK && a[0][0] == y[0][0] && a[1][1] == y[1][1] && a[2][2] == y[2][2]);
    poinsot_plan_destroy_f_(&plan);
    poinsot_plan_create_f_(&plan, &status);
    poinsot_plan_add_class_f_(&plan, second, &number, &status);
    poinsot_plan_effect_f_(&plan, "drag", &what, drag, &said, &status);
    poinsot_plan_set_f_(&plan, &(int){3}, &four, &status);
    poinsot_plan_ready_f_(&plan, &status);
    for (i = 0; i < n; i++) p[0][i] = 0, p[1][i] = 0.2, p[2][i] = 0.4, p[3][i] = 0.6;
    poinsot_dissipate_c_f_(&plan, &bodies, p[0], p[1], p[2], p[3], w[0], w[1], w[2], w[3], none, &h, &step, each, &status);
    CHECK(status == POINSOT_OK && fabs(p[1][0] - 2 * y[0][0]) < 1e-15 && fabs(p[3][2] - 2 * y[2][2]) < 1e-15);
    poinsot_plan_destroy_f_(&plan);
  }
}

/* ---- two threads, one plan ------------------------------------------------------------------------------------------ */

enum { many = 1000 };
typedef struct {
  const poinsot_plan *plan;
  double y[many][3], q[many][4];
  poinsot_status status;
} half;

static void *run(void *given) {
  half *mine = given;
  poinsot_bodies view;
  size_t i;
  int k;
  for (i = 0; i < many; i++) {
    const double yi[3] = {sin((double)i), cos((double)i), 0.5}, qi[4] = {1, 0, 0, 0};
    memcpy(mine->y[i], yi, sizeof yi);
    memcpy(mine->q[i], qi, sizeof qi);
  }
  mine->status = poinsot_bodies_rows(&view, "native", "wxyz", many, mine->y[0], mine->q[0]);
  for (k = 0; k < 5 && mine->status == POINSOT_OK; k++)
    mine->status = poinsot_step(mine->plan, &view, 0, 0.01, 4 * k, 4, NULL, NULL);
  return NULL;
}

/* No text is cut: what is wrong at the end of a long one is found. */
static void long_text(void) {
  enum { length = 70000 };
  poinsot_plan *plan;
  char *text = malloc(length + 20);
  CHECK(poinsot_plan_create(&plan) == POINSOT_OK);
  memset(text, ' ', length);
  strcpy(text, "centre = 0 0 1");
  text[14] = ' ';
  strcpy(text + length, "; nosuch = 1");
  CHECK(poinsot_plan_add_effect(plan, "gravity", text) == POINSOT_E_METHOD);
  strcpy(text + length, "; weight = 2");
  CHECK(poinsot_plan_add_effect(plan, "gravity", text) == POINSOT_OK);
  free(text);
  poinsot_plan_destroy(&plan);
}

/* A thread that does not round to nearest is told so, by every way in; afterwards all is as before. */
static void rounding(void) {
  enum { n = 3 };
  const int modes[3] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
  const double h = 0.1, torque[n][3] = {{0.1, 0.2, 0.3}}, *const columns[3] = {torque[0], torque[0] + 1, torque[0] + 2};
  const int exact = 1, one = 1, bodies = n;
  poinsot_plan *plan;
  poinsot_body *body;
  poinsot_bodies view;
  double y[n][3], q[n][4];
  int k, i, status, got[4], each[n];
  volatile double sum = 1;
  fesetround(FE_UPWARD);
  sum += 1e-20;
  fesetround(FE_TONEAREST);
  if (sum == 1) return; /* valgrind rounds to nearest whatever is asked for */
  CHECK(poinsot_body_create(moments, &body) == POINSOT_OK);
  CHECK(poinsot_plan_create(&plan) == POINSOT_OK);
  CHECK(poinsot_plan_add_class(plan, moments, NULL) == POINSOT_OK);
  CHECK(poinsot_plan_ready(plan) == POINSOT_OK);
  for (i = 0; i < n; i++) {
    y[i][0] = 0.1, y[i][1] = 0.2, y[i][2] = 0.3;
    q[i][0] = 1, q[i][1] = q[i][2] = q[i][3] = 0;
  }
  CHECK(poinsot_bodies_rows(&view, "native", "wxyz", n, y[0], q[0]) == POINSOT_OK);
  for (k = 0; k < 3; k++) {
    fesetround(modes[k]);
    got[0] = poinsot_drift(plan, &view, h);
    got[1] = poinsot_kick(plan, &view, h, columns, 3);
    got[2] = poinsot_rotate(body, "exact", h, 1, n, y[0], q[0], each);
    poinsot_rotate_f_(moments, &exact, &h, &one, &bodies, y[0], q[0], each, &got[3]);
    fesetround(FE_TONEAREST);
    for (i = 0; i < 4; i++) CHECK(got[i] == POINSOT_E_PARTIAL);
    CHECK(each[0] == POINSOT_E_DOMAIN && q[0][0] == 1);
  }
  status = poinsot_drift(plan, &view, h);
  CHECK(status == POINSOT_OK && q[0][0] < 1);
  poinsot_plan_destroy(&plan);
  poinsot_body_destroy(&body);
}

static void threads(void) {
  poinsot_plan *plan;
  half *two = calloc(2, sizeof *two);
  pthread_t other;
  CHECK(poinsot_plan_create(&plan) == POINSOT_OK);
  CHECK(poinsot_plan_add_class(plan, moments, NULL) == POINSOT_OK);
  CHECK(poinsot_plan_add_effect(plan, "gravity", "centre = 0 0 1") == POINSOT_OK);
  CHECK(poinsot_plan_set(plan, "threads", "2") == POINSOT_OK);
  CHECK(poinsot_plan_ready(plan) == POINSOT_OK);
  two[0].plan = two[1].plan = plan;
  CHECK(pthread_create(&other, NULL, run, &two[1]) == 0);
  run(&two[0]);
  pthread_join(other, NULL);
  CHECK(two[0].status == POINSOT_OK && two[1].status == POINSOT_OK);
  CHECK(memcmp(two[0].y, two[1].y, sizeof two[0].y) == 0 && memcmp(two[0].q, two[1].q, sizeof two[0].q) == 0);
  poinsot_plan_destroy(&plan);
  free(two);
}

int main(void) {
  ways();
  growth();
  fixed_form();
  library();
  body();
  jacobi();
  plan();
  bodies();
  long_text();
  rounding();
  threads();
  printf("abuse: %d checks, %d failed\n", checks, failures);
  return failures != 0;
}
