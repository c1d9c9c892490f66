/* Entry points for Fortran with implicit interfaces: poinsot_..._f. See include/poinsot.h.
 *
 * In C and not in Fortran for the reason of cpu_check.c: nothing of a newer processor before it was looked at. All work goes
 * through poinsot.h; here arguments are dereferenced and numbers become names. */
#include "poinsot.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static poinsot_plan *plan_of(const int64_t *plan) { return plan ? (poinsot_plan *)(intptr_t)*plan : NULL; }

static const char *const layouts[] = {"native", "lammps", "dl_poly", "hoomd"};
static const char *const momenta[] = {"body-momentum", "space-momentum", "body-velocity", "space-velocity",
                                      "conjugate-momentum"};
static const char *const frames[] = {"body", "space"};

/* Name number i, from 1, of a list; NULL outside. */
static const char *from_list(const char *const *list, size_t length, int i) {
  return i >= 1 && (size_t)i <= length ? list[i - 1] : NULL;
}
#define NAME(list, i) from_list(list, sizeof list / sizeof *list, i)

static const char *method_of(int i) { return i >= 1 ? poinsot_method_name((size_t)i - 1) : NULL; }
static const char *splitting_of(int i) { return i >= 1 ? poinsot_splitting_name((size_t)i - 1) : NULL; }

/* A number as poinsot_plan_set and _add_effect read it: with a point, also where the locale of the program has a comma. */
static const char *text_of(double x, char text[32]) {
  char raw[64], *end = text;
  const char *c;
  snprintf(raw, sizeof raw, "%.17g", x);
  for (c = raw; *c; c++) {
    if (strchr("0123456789+-einfa", *c)) *end++ = *c;
    else if (end == text || end[-1] != '.') *end++ = '.';
  }
  *end = 0;
  return text;
}

static size_t count_of(const int *n) { return *n < 0 ? (size_t)-1 : (size_t)*n; }

void poinsot_version_f_(int *version, int *status) {
  char none[1];
  *version = poinsot_version();
  *status = poinsot_bodies_check(NULL, NULL, none, 1) == POINSOT_E_CPU ? POINSOT_E_CPU : POINSOT_OK;
}

/* Constants for each lane are cheaper than a body: `exact` and `jacobi` take them, whatever the number of bodies. */
__attribute__((visibility("hidden"))) poinsot_status poinsot_rotate_moments(const double moments[3], int by_jacobi, double h,
                                                                            size_t steps, size_t n, double y[], double q[],
                                                                            poinsot_status per_body[]);
/* Of src/api/body.f90; a body was made before, so the processor has been looked at. */
__attribute__((visibility("hidden"))) poinsot_status poinsot_do_rotate_by(int threads, const poinsot_body *body, const char *method,
                                                                         double h, size_t steps, size_t n, double y[],
                                                                         double q[], poinsot_status per_body[]);

void poinsot_rotate_f_(const double moments[3], const int *method, const double *h, const int *steps, const int *n,
                       double y[], double q[], int each[], int *status) {
  enum { exact = 1, jacobi };
  poinsot_body *body;
  const char *name;
  if (*method == exact || *method == jacobi) {
    *status = *steps < 0 ? POINSOT_E_SIZE
                         : poinsot_rotate_moments(moments, *method == jacobi, *h, (size_t)*steps, count_of(n), y, q, each);
    return;
  }
  name = method_of(*method);
  *status = poinsot_body_create(moments, &body);
  if (*status) return;
  *status = !name        ? POINSOT_E_METHOD
            : *steps < 0 ? POINSOT_E_SIZE
                         : poinsot_do_rotate_by(1, body, name, *h, (size_t)*steps, count_of(n), y, q, each);
  poinsot_body_destroy(&body);
}

void poinsot_splitting_f_(const int *splitting, const int *capacity, double kick[], double drift[], int *count, int *status) {
  size_t pairs = 0;
  const char *name = splitting_of(*splitting);
  *status = name ? poinsot_splitting_flows(name, *capacity < 0 ? 0 : (size_t)*capacity, kick, drift, &pairs) : POINSOT_E_METHOD;
  *count = (int)pairs;
}

void poinsot_plan_create_f_(int64_t *plan, int *status) {
  poinsot_plan *made;
  *status = poinsot_plan_create(&made);
  *plan = (int64_t)(intptr_t)made;
}

void poinsot_plan_destroy_f_(int64_t *plan) {
  poinsot_plan *handle = plan_of(plan);
  poinsot_plan_destroy(&handle);
  if (plan) *plan = 0;
}

void poinsot_plan_add_class_f_(const int64_t *plan, const double moments[3], int *number, int *status) {
  int from_zero = -1;
  *status = poinsot_plan_add_class(plan_of(plan), moments, &from_zero);
  *number = from_zero + 1;
}

void poinsot_plan_find_class_f_(const int64_t *plan, const double moments[3], const double *tolerance, int *number, int *status) {
  int from_zero = -1;
  *status = poinsot_plan_find_class(plan_of(plan), moments, *tolerance, &from_zero);
  *number = from_zero + 1;
}

void poinsot_plan_add_tensor_f_(const int64_t *plan, const double inertia[9], int *number, int *status) {
  int from_zero = -1;
  *status = poinsot_plan_add_class_tensor(plan_of(plan), inertia, &from_zero);
  *number = from_zero + 1;
}

void poinsot_plan_set_f_(const int64_t *plan, const int *option, const int *value, int *status) {
  static const char *const options[] = {"method", "splitting", "layout", "momentum", "frame", "threads", "seed", "physical"};
  static const char *const answers[] = {"yes", "no"};
  const char *key = NAME(options, *option), *text = NULL;
  char number[16], which[16];
  snprintf(number, sizeof number, "%d", *value);
  snprintf(which, sizeof which, "%d", *option);
  switch (*option) {
  case 1: text = method_of(*value); break;
  case 2: text = splitting_of(*value); break;
  case 3: text = NAME(layouts, *value); break;
  case 4: text = NAME(momenta, *value); break;
  case 5: text = NAME(frames, *value); break;
  case 8: text = NAME(answers, *value); break;
  default: break;
  }
  /* What has no name is refused by its number, in words. */
  *status = poinsot_plan_set(plan_of(plan), key ? key : which, text && *text ? text : number);
}

void poinsot_plan_gravity_f_(const int64_t *plan, const double centre[3], const double *weight, const double up[3], int *status) {
  char text[300] = "centre =", number[32];
  int i;
  for (i = 0; i < 7; i++) {
    strcat(text, i == 3 ? "; weight = " : i == 4 ? "; up = " : " ");
    strcat(text, text_of(i < 3 ? centre[i] : i == 3 ? *weight : up[i - 4], number));
  }
  *status = poinsot_plan_add_effect(plan_of(plan), "gravity", text);
}

void poinsot_plan_tolerance_f_(const int64_t *plan, const double *tolerance, int *status) {
  char text[32];
  *status = poinsot_plan_set(plan_of(plan), "tolerance", text_of(*tolerance, text));
}

/* A Fortran text as a C text: blanks at its end do not count. Cut where it does not fit, which no name or number of ours does. */
static void to_c(const char *text, int length, char *out, size_t capacity) {
  size_t n = length > 0 && text ? (size_t)length : 0;
  while (n > 0 && text[n - 1] == ' ') n--;
  if (n > capacity - 1) n = capacity - 1;
  if (n > 0) memcpy(out, text, n);
  out[n] = 0;
}

/* A C text into a Fortran text, blank-padded. */
static void to_fortran(const char *text, char *out, int length) {
  size_t capacity = length > 0 ? (size_t)length : 0, n = strlen(text);
  if (!out) return;
  if (n > capacity) n = capacity;
  memcpy(out, text, n);
  memset(out + n, ' ', capacity - n);
}

void poinsot_plan_effect_f_(const int64_t *plan, const char *name, const int *name_length, const char *settings,
                            const int *settings_length, int *status) {
  char which[64], few[1024], *text = few;
  size_t room = *settings_length > 0 ? (size_t)*settings_length + 1 : 1;
  if (room > sizeof few) text = malloc(room);
  *status = POINSOT_E_MEMORY;
  if (!text) return;
  to_c(name, *name_length, which, sizeof which);
  to_c(settings, *settings_length, text, room);
  *status = poinsot_plan_add_effect(plan_of(plan), which, text);
  if (text != few) free(text);
}

void poinsot_plan_message_f_(const int64_t *plan, char *text, const int *length) {
  char few[1024], *sentence = few;
  size_t room = poinsot_plan_message(plan_of(plan), NULL, 0) + 1;
  if (room > sizeof few) sentence = malloc(room);
  if (!sentence || room < sizeof few) room = sizeof few; /* without memory what there is room for */
  if (!sentence) sentence = few;
  sentence[0] = 0;
  (void)poinsot_plan_message(plan_of(plan), sentence, room);
  to_fortran(sentence, text, *length);
  if (sentence != few) free(sentence);
}

void poinsot_status_text_f_(const int *status, char *text, const int *length) {
  to_fortran(poinsot_status_text(*status), text, *length);
}

void poinsot_plan_ready_f_(const int64_t *plan, int *status) { *status = poinsot_plan_ready(plan_of(plan)); }

/* ---- bodies -------------------------------------------------------------------------------------------------------- */

/* Classes count from 1. class(1) = 0 and one class in the plan: nothing further is read. With several, all 0 is all of class 1. */
static const int *classes(const int64_t *plan, const int *n, const int body_class[]) {
  double axes[9];
  if (!body_class || *n <= 0) return NULL;
  if (body_class[0] != 0) return body_class;
  if (poinsot_plan_class_axes(plan_of(plan), 1, axes) != POINSOT_OK) return NULL;
  for (int i = 1; i < *n; i++)
    if (body_class[i] != 0) return body_class;
  return NULL;
}

__attribute__((visibility("hidden"))) int poinsot_plan_components(const poinsot_plan *plan);

/* A view of rows; classes count from 1. */
static poinsot_status rows(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], int each[],
                           poinsot_bodies *view) {
  int j;
  memset(view, 0, sizeof *view);
  view->size = sizeof *view;
  if (*n < 0) return POINSOT_E_SIZE;
  if (*n > 0 && !(y && q)) return POINSOT_E_NULL;
  view->n = (size_t)*n;
  view->y_stride = poinsot_plan_components(plan_of(plan));
  view->q_stride = 4;
  for (j = 0; j < 3; j++) view->y[j] = y + j;
  for (j = 0; j < 4; j++) view->q[j] = q + j;
  if (view->y_stride == 4) view->y_fourth = y + 3;
  view->body_class = classes(plan, n, body_class);
  view->first_class = 1;
  view->status = each;
  return POINSOT_OK;
}

/* A view of component arrays. */
static poinsot_status arrays(const int64_t *plan, const char *layout, const int *n, double *const y[], double *const q[4],
                             const int body_class[], int each[], poinsot_bodies *view) {
  poinsot_status status = poinsot_bodies_arrays(view, layout, count_of(n), y, q);
  if (status) return status;
  view->body_class = classes(plan, n, body_class);
  view->first_class = 1;
  view->status = each;
  return POINSOT_OK;
}

void poinsot_drift_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *h,
                      int each[], int *status) {
  poinsot_bodies view;
  *status = rows(plan, n, y, q, body_class, each, &view);
  if (*status == POINSOT_OK) *status = poinsot_drift(plan_of(plan), &view, *h);
}

void poinsot_kick_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *h,
                     const double torque[], int each[], int *status) {
  poinsot_bodies view;
  const double *const components[3] = {torque, torque + 1, torque + 2};
  *status = rows(plan, n, y, q, body_class, each, &view);
  if (*status == POINSOT_OK) *status = poinsot_kick(plan_of(plan), &view, *h, components, 3);
}

void poinsot_dissipate_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *h,
                          const int *step, int each[], int *status) {
  poinsot_bodies view;
  *status = rows(plan, n, y, q, body_class, each, &view);
  if (*status == POINSOT_OK) *status = poinsot_dissipate(plan_of(plan), &view, *h, *step);
}

void poinsot_step_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *t,
                     const double *h, const int *first, const int *steps, int each[], int *status) {
  poinsot_bodies view;
  *status = rows(plan, n, y, q, body_class, each, &view);
  if (*status == POINSOT_OK) *status = poinsot_step(plan_of(plan), &view, *t, *h, *first, *steps, NULL, NULL);
}

/* The host's subroutine as a context: a pointer to a function does not fit into a pointer to data. */
typedef struct {
  poinsot_torque_f *torques;
} subroutine;

/* The library hands over columns one after the other, which is q(n,4) and torque(n,3). */
static int call_subroutine(void *context, double t, size_t n, const double *const q[4], ptrdiff_t q_stride,
                           double *const torque[3], ptrdiff_t torque_stride, double *energy) {
  int stop = 0, bodies = (int)n;
  (void)q_stride;
  (void)torque_stride;
  (void)energy;
  ((const subroutine *)context)->torques(&t, &bodies, q[0], torque[0], &stop);
  return stop;
}

void poinsot_step_torque_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *t,
                            const double *h, const int *first, const int *steps, poinsot_torque_f *torques, int each[],
                            int *status) {
  poinsot_bodies view;
  subroutine host;
  host.torques = torques;
  *status = torques ? rows(plan, n, y, q, body_class, each, &view) : POINSOT_E_NULL;
  if (*status == POINSOT_OK) *status = poinsot_step(plan_of(plan), &view, *t, *h, *first, *steps, call_subroutine, &host);
}

void poinsot_energy_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *t,
                       double kinetic[], double potential[], int *status) {
  poinsot_bodies view;
  *status = rows(plan, n, y, q, body_class, NULL, &view);
  if (*status == POINSOT_OK) *status = poinsot_energy(plan_of(plan), &view, *t, kinetic, potential);
}

void poinsot_drift_a_f_(const int64_t *plan, const int *n, double y1[], double y2[], double y3[], double q0[], double q1[],
                        double q2[], double q3[], const int body_class[], const double *h, int each[], int *status) {
  poinsot_bodies view;
  double *const y[3] = {y1, y2, y3}, *const q[4] = {q0, q1, q2, q3};
  *status = arrays(plan, "native", n, y, q, body_class, each, &view);
  if (*status == POINSOT_OK) *status = poinsot_drift(plan_of(plan), &view, *h);
}

void poinsot_kick_a_f_(const int64_t *plan, const int *n, double y1[], double y2[], double y3[], double q0[], double q1[],
                       double q2[], double q3[], const int body_class[], const double *h, const double torque1[],
                       const double torque2[], const double torque3[], int each[], int *status) {
  poinsot_bodies view;
  double *const y[3] = {y1, y2, y3}, *const q[4] = {q0, q1, q2, q3};
  const double *const components[3] = {torque1, torque2, torque3};
  *status = arrays(plan, "native", n, y, q, body_class, each, &view);
  if (*status == POINSOT_OK) *status = poinsot_kick(plan_of(plan), &view, *h, components, 1);
}

void poinsot_dissipate_a_f_(const int64_t *plan, const int *n, double y1[], double y2[], double y3[], double q0[], double q1[],
                            double q2[], double q3[], const int body_class[], const double *h, const int *step, int each[],
                            int *status) {
  poinsot_bodies view;
  double *const y[3] = {y1, y2, y3}, *const q[4] = {q0, q1, q2, q3};
  *status = arrays(plan, "native", n, y, q, body_class, each, &view);
  if (*status == POINSOT_OK) *status = poinsot_dissipate(plan_of(plan), &view, *h, *step);
}

/* Four components are a conjugate momentum: a plan that takes fewer has another variable. */
static poinsot_status four(const int64_t *plan, const int *n, double *const p[4], double *const q[4], const int body_class[],
                           int each[], poinsot_bodies *view) {
  poinsot_status status = arrays(plan, "hoomd", n, p, q, body_class, each, view);
  if (status || view->n == 0) return status;
  view->y_fourth = NULL;
  if (poinsot_bodies_check(plan_of(plan), view, NULL, 0) == POINSOT_OK) status = POINSOT_E_METHOD;
  view->y_fourth = p[3];
  return status;
}

/* The same for a conjugate momentum. */
void poinsot_dissipate_c_f_(const int64_t *plan, const int *n, double p0[], double p1[], double p2[], double p3[], double q0[],
                            double q1[], double q2[], double q3[], const int body_class[], const double *h, const int *step,
                            int each[], int *status) {
  poinsot_bodies view;
  double *const p[4] = {p0, p1, p2, p3}, *const q[4] = {q0, q1, q2, q3};
  *status = four(plan, n, p, q, body_class, each, &view);
  if (*status == POINSOT_OK) *status = poinsot_dissipate(plan_of(plan), &view, *h, *step);
}

void poinsot_drift_c_f_(const int64_t *plan, const int *n, double p0[], double p1[], double p2[], double p3[], double q0[],
                        double q1[], double q2[], double q3[], const int body_class[], const double *h, int each[],
                        int *status) {
  poinsot_bodies view;
  double *const p[4] = {p0, p1, p2, p3}, *const q[4] = {q0, q1, q2, q3};
  *status = four(plan, n, p, q, body_class, each, &view);
  if (*status == POINSOT_OK) *status = poinsot_drift(plan_of(plan), &view, *h);
}

void poinsot_kick_c_f_(const int64_t *plan, const int *n, double p0[], double p1[], double p2[], double p3[], double q0[],
                       double q1[], double q2[], double q3[], const int body_class[], const double *h, const double torque1[],
                       const double torque2[], const double torque3[], int each[], int *status) {
  poinsot_bodies view;
  double *const p[4] = {p0, p1, p2, p3}, *const q[4] = {q0, q1, q2, q3};
  const double *const components[3] = {torque1, torque2, torque3};
  *status = four(plan, n, p, q, body_class, each, &view);
  if (*status == POINSOT_OK) *status = poinsot_kick(plan_of(plan), &view, *h, components, 1);
}
