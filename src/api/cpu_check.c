/* The door: the C entry points, before the Fortran that does the work.
 *
 * The Fortran sources are compiled for the processor of the build (-march=native), this file is not: it looks at the processor
 * before the first instruction that an older one might not know, and answers POINSOT_E_CPU instead. Fortran tells as constant
 * data what it needs (src/api/build.f90). Nothing is remembered: the look is some twenty loads, and there is no global state. */
#include "poinsot.h"

extern const int poinsot_build_needs, poinsot_build_version;

/* The same order as in build.f90. */
#define NEEDS(bit, feature) \
  if ((poinsot_build_needs >> (bit) & 1) && !__builtin_cpu_supports(feature)) return 0

static int processor_has_it_all(void) {
#if (defined __x86_64__ || defined __i386__) && defined __GNUC__
  NEEDS(0, "sse3");
  NEEDS(1, "ssse3");
  NEEDS(2, "sse4.1");
  NEEDS(3, "sse4.2");
  NEEDS(4, "popcnt");
  NEEDS(5, "avx");
  NEEDS(6, "avx2");
  NEEDS(7, "fma");
  NEEDS(8, "bmi");
  NEEDS(9, "bmi2");
  NEEDS(10, "avx512f");
  NEEDS(11, "avx512vl");
  NEEDS(12, "avx512bw");
  NEEDS(13, "avx512dq");
  NEEDS(14, "avx512cd");
  NEEDS(15, "avx512vbmi");
  NEEDS(16, "avx512ifma");
  NEEDS(17, "avx512vpopcntdq");
  NEEDS(18, "avx512vbmi2");
  NEEDS(19, "gfni");
  NEEDS(20, "vpclmulqdq");
  NEEDS(21, "avx512vnni");
#endif
  return 1;
}

/* For Fortran (poinsot_api_processor): may the rest of the library run here? */
int poinsot_processor_fits(void) { return processor_has_it_all(); }

#ifdef __linux__
/* A thread that forks takes no OpenMP workers along: the child would wait for them for ever. So they are sent home before. */
#include <pthread.h>
extern int omp_pause_resource_all(int kind) __attribute__((weak));
static void send_workers_home(void) {
  if (omp_pause_resource_all) (void)omp_pause_resource_all(1);
}
__attribute__((constructor)) static void before_fork(void) { (void)pthread_atfork(send_workers_home, NULL, NULL); }
#endif

/* What Fortran has behind each door. */
const char *poinsot_do_status_text(int);
int poinsot_do_has_feature(const char *);
size_t poinsot_do_method_count(void);
const char *poinsot_do_method_name(size_t);
size_t poinsot_do_splitting_count(void);
const char *poinsot_do_splitting_name(size_t);
int poinsot_do_splitting_flows(const char *, size_t, double *, double *, size_t *);
size_t poinsot_do_effect_count(void);
const char *poinsot_do_effect_name(size_t);
int poinsot_do_body_create(const double *, poinsot_body **);
int poinsot_do_body_create_tensor(const double *, poinsot_body **, double *);
void poinsot_do_body_destroy(poinsot_body **);
int poinsot_do_rotate(const poinsot_body *, const char *, double, size_t, size_t, double *, double *, poinsot_status *);
int poinsot_do_jacobi(size_t, const double *, const double *, const double *, double *, double *, double *);
int poinsot_do_bodies_rows(poinsot_bodies *, const char *, const char *, size_t, double *, double *);
int poinsot_do_bodies_arrays(poinsot_bodies *, const char *, size_t, double *const *, double *const *);
int poinsot_do_plan_create(poinsot_plan **);
void poinsot_do_plan_destroy(poinsot_plan **);
int poinsot_do_plan_add_class(poinsot_plan *, const double *, int *);
int poinsot_do_plan_add_class_tensor(poinsot_plan *, const double *, int *);
int poinsot_do_plan_set(poinsot_plan *, const char *, const char *);
int poinsot_do_plan_add_effect(poinsot_plan *, const char *, const char *);
int poinsot_do_plan_ready(poinsot_plan *);
size_t poinsot_do_plan_message(const poinsot_plan *, char *, size_t);
int poinsot_do_bodies_check(const poinsot_plan *, const poinsot_bodies *, char *, size_t);
int poinsot_do_drift(const poinsot_plan *, const poinsot_bodies *, double);
int poinsot_do_kick(const poinsot_plan *, const poinsot_bodies *, double, const double *const *, ptrdiff_t);
int poinsot_do_step(const poinsot_plan *, const poinsot_bodies *, double, double, int64_t, int64_t, poinsot_torque *, void *);
int poinsot_do_energy(const poinsot_plan *, const poinsot_bodies *, double, double *, double *);
int poinsot_do_momentum(const poinsot_plan *, const poinsot_bodies *, double *);
int poinsot_do_degrees_of_freedom(const poinsot_plan *, const poinsot_bodies *, size_t *);

#define RETURN_UNLESS_SUPPORTED(call, otherwise) return processor_has_it_all() ? (call) : (otherwise)

int poinsot_version(void) { return poinsot_build_version; }

const char *poinsot_status_text(poinsot_status s) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_status_text(s), s == POINSOT_OK ? "ok" : "this build needs a newer processor");
}

int poinsot_has_feature(const char *name) { RETURN_UNLESS_SUPPORTED(poinsot_do_has_feature(name), 0); }

size_t poinsot_method_count(void) { RETURN_UNLESS_SUPPORTED(poinsot_do_method_count(), 0); }
const char *poinsot_method_name(size_t i) { RETURN_UNLESS_SUPPORTED(poinsot_do_method_name(i), NULL); }
size_t poinsot_splitting_count(void) { RETURN_UNLESS_SUPPORTED(poinsot_do_splitting_count(), 0); }
const char *poinsot_splitting_name(size_t i) { RETURN_UNLESS_SUPPORTED(poinsot_do_splitting_name(i), NULL); }
poinsot_status poinsot_splitting_flows(const char *name, size_t capacity, double kick[], double drift[], size_t *count) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_splitting_flows(name, capacity, kick, drift, count), POINSOT_E_CPU);
}

size_t poinsot_effect_count(void) { RETURN_UNLESS_SUPPORTED(poinsot_do_effect_count(), 0); }
const char *poinsot_effect_name(size_t i) { RETURN_UNLESS_SUPPORTED(poinsot_do_effect_name(i), NULL); }

poinsot_status poinsot_body_create(const double moments[3], poinsot_body **body) {
  if (body) *body = NULL;
  RETURN_UNLESS_SUPPORTED(poinsot_do_body_create(moments, body), POINSOT_E_CPU);
}

poinsot_status poinsot_body_create_tensor(const double inertia[9], poinsot_body **body, double axes[9]) {
  if (body) *body = NULL;
  RETURN_UNLESS_SUPPORTED(poinsot_do_body_create_tensor(inertia, body, axes), POINSOT_E_CPU);
}

void poinsot_body_destroy(poinsot_body **body) {
  if (body && *body) poinsot_do_body_destroy(body);
}

poinsot_status poinsot_rotate(const poinsot_body *body, const char *method, double h, size_t steps,
                              size_t n, double y[], double q[], poinsot_status per_body[]) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_rotate(body, method, h, steps, n, y, q, per_body), POINSOT_E_CPU);
}

poinsot_status poinsot_jacobi(size_t n, const double u[], const double m[], const double m1[],
                              double sn[], double cn[], double dn[]) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_jacobi(n, u, m, m1, sn, cn, dn), POINSOT_E_CPU);
}

poinsot_status poinsot_bodies_rows(poinsot_bodies *bodies, const char *layout, const char *order, size_t n,
                                   double momentum[], double attitude[]) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_bodies_rows(bodies, layout, order, n, momentum, attitude), POINSOT_E_CPU);
}

poinsot_status poinsot_bodies_arrays(poinsot_bodies *bodies, const char *layout, size_t n,
                                     double *const momentum[], double *const attitude[4]) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_bodies_arrays(bodies, layout, n, momentum, attitude), POINSOT_E_CPU);
}

poinsot_status poinsot_plan_create(poinsot_plan **plan) {
  if (plan) *plan = NULL;
  RETURN_UNLESS_SUPPORTED(poinsot_do_plan_create(plan), POINSOT_E_CPU);
}

void poinsot_plan_destroy(poinsot_plan **plan) {
  if (plan && *plan) poinsot_do_plan_destroy(plan);
}

poinsot_status poinsot_plan_add_class(poinsot_plan *plan, const double moments[3], int *number) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_plan_add_class(plan, moments, number), POINSOT_E_CPU);
}

poinsot_status poinsot_plan_add_class_tensor(poinsot_plan *plan, const double inertia[9], int *number) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_plan_add_class_tensor(plan, inertia, number), POINSOT_E_CPU);
}

poinsot_status poinsot_plan_set(poinsot_plan *plan, const char *option, const char *value) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_plan_set(plan, option, value), POINSOT_E_CPU);
}

poinsot_status poinsot_plan_add_effect(poinsot_plan *plan, const char *name, const char *settings) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_plan_add_effect(plan, name, settings), POINSOT_E_CPU);
}

poinsot_status poinsot_plan_ready(poinsot_plan *plan) { RETURN_UNLESS_SUPPORTED(poinsot_do_plan_ready(plan), POINSOT_E_CPU); }

size_t poinsot_plan_message(const poinsot_plan *plan, char *buffer, size_t capacity) {
  if (buffer && capacity > 0) *buffer = 0;
  RETURN_UNLESS_SUPPORTED(poinsot_do_plan_message(plan, buffer, capacity), 0);
}

poinsot_status poinsot_bodies_check(const poinsot_plan *plan, const poinsot_bodies *bodies, char *buffer, size_t capacity) {
  if (buffer && capacity > 0) *buffer = 0;
  RETURN_UNLESS_SUPPORTED(poinsot_do_bodies_check(plan, bodies, buffer, capacity), POINSOT_E_CPU);
}

poinsot_status poinsot_drift(const poinsot_plan *plan, const poinsot_bodies *bodies, double h) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_drift(plan, bodies, h), POINSOT_E_CPU);
}

poinsot_status poinsot_kick(const poinsot_plan *plan, const poinsot_bodies *bodies, double h,
                            const double *const torque[3], ptrdiff_t stride) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_kick(plan, bodies, h, torque, stride), POINSOT_E_CPU);
}

poinsot_status poinsot_step(const poinsot_plan *plan, const poinsot_bodies *bodies, double t, double h,
                            int64_t first, int64_t steps, poinsot_torque *callback, void *context) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_step(plan, bodies, t, h, first, steps, callback, context), POINSOT_E_CPU);
}

poinsot_status poinsot_energy(const poinsot_plan *plan, const poinsot_bodies *bodies, double t,
                              double kinetic[], double potential[]) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_energy(plan, bodies, t, kinetic, potential), POINSOT_E_CPU);
}

poinsot_status poinsot_momentum(const poinsot_plan *plan, const poinsot_bodies *bodies, double momentum[]) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_momentum(plan, bodies, momentum), POINSOT_E_CPU);
}

poinsot_status poinsot_degrees_of_freedom(const poinsot_plan *plan, const poinsot_bodies *bodies, size_t *count) {
  RETURN_UNLESS_SUPPORTED(poinsot_do_degrees_of_freedom(plan, bodies, count), POINSOT_E_CPU);
}
