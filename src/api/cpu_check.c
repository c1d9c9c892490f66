/* The C entry points, before the Fortran that does the work.
 *
 * The Fortran sources are compiled for the processor of the build (-march=native), this file is not: it looks at the processor
 * before the first instruction that an older one might not know, and answers POINSOT_E_CPU instead. Fortran tells as constant
 * data what it needs (src/api/build.f90). Nothing is remembered: the look is some twenty loads, and there is no global state. */
#include "poinsot.h"

/* Hidden: a program that links the shared library sees what poinsot.h declares, and nothing that skips the check. */
#pragma GCC visibility push(hidden)
extern const int poinsot_build_needs, poinsot_build_version;
int poinsot_processor_fits(void);
#pragma GCC visibility pop

/* The same order as in build.f90. */
#define NEEDS(bit, feature) \
  if ((poinsot_build_needs >> (bit) & 1) && !__builtin_cpu_supports(feature)) return 0

static int processor_has_it_all(void) {
#if (defined __x86_64__ || defined __i386__) && defined __GNUC__
  /* All that could be asked for: the compiler makes one or two tests of it. */
#define HAS(feature) __builtin_cpu_supports(feature)
  if (HAS("sse3") && HAS("ssse3") && HAS("sse4.1") && HAS("sse4.2") && HAS("popcnt") && HAS("avx") && HAS("avx2") && HAS("fma") &&
      HAS("bmi") && HAS("bmi2")) {
    if (poinsot_build_needs >> 10 == 0) return 1;
    if (HAS("avx512f") && HAS("avx512vl") && HAS("avx512bw") && HAS("avx512dq") && HAS("avx512cd") && HAS("avx512vbmi") &&
        HAS("avx512ifma") && HAS("avx512vpopcntdq") && HAS("avx512vbmi2") && HAS("gfni") && HAS("vpclmulqdq") && HAS("avx512vnni"))
      return 1;
  }
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

/* The Fortran runtime knows these by weak references only: in a fully static program they would be NULL, and exit() call them. */
__attribute__((used)) static int (*const needed_at_exit[])(pthread_mutex_t *) = {pthread_mutex_destroy, pthread_mutex_trylock};
#endif

/* A C function is one line here, one procedure in Fortran (bind(c, name="poinsot_do_...")), one declaration in poinsot.h and, for
 * Fortran of other compilers, one interface in include/poinsot_interface.f90. The line declares what Fortran has and defines
 * the function: `before` first, then Fortran's, or `otherwise` on a processor that it was not compiled for. */
#define CHECKED(type, name, parameters, arguments, before, otherwise)           \
  __attribute__((visibility("hidden"))) type poinsot_do_##name parameters;      \
  type poinsot_##name parameters {                                              \
    before;                                                                     \
    return processor_has_it_all() ? poinsot_do_##name arguments : (otherwise);  \
  }
#define STATUS_AFTER(before, name, parameters, arguments) \
  CHECKED(poinsot_status, name, parameters, arguments, before, POINSOT_E_CPU)
#define STATUS(name, parameters, arguments) STATUS_AFTER((void)0, name, parameters, arguments)
#define LIST(things)                                            \
  CHECKED(size_t, things##_count, (void), (), (void)0, 0)       \
  CHECKED(const char *, things##_name, (size_t i), (i), (void)0, NULL)
/* Nothing was made that would need a newer processor to be destroyed. */
#define DESTROY(thing, type)                                                      \
  __attribute__((visibility("hidden"))) void poinsot_do_##thing##_destroy(type **); \
  void poinsot_##thing##_destroy(type **it) {                                     \
    if (it && *it) poinsot_do_##thing##_destroy(it);                              \
  }
#define NO_TEXT if (buffer && capacity > 0) *buffer = 0

/* ---- the library -------------------------------------------------------------------------------------------------- */

int poinsot_version(void) { return poinsot_build_version; }
CHECKED(const char *, status_text, (poinsot_status status), (status), (void)0,
        status == POINSOT_OK ? "ok" : "this build needs a newer processor")
CHECKED(int, has_feature, (const char *name), (name), (void)0, 0)
LIST(method)
LIST(splitting)
LIST(effect)
STATUS(splitting_flows, (const char *name, size_t capacity, double kick[], double drift[], size_t *count),
       (name, capacity, kick, drift, count))

/* ---- one kind of body ---------------------------------------------------------------------------------------------- */

STATUS_AFTER(if (body) *body = NULL, body_create, (const double moments[3], poinsot_body **body), (moments, body))
STATUS_AFTER(if (body) *body = NULL, body_create_tensor, (const double inertia[9], poinsot_body **body, double axes[9]),
             (inertia, body, axes))
DESTROY(body, poinsot_body)
STATUS(rotate, (const poinsot_body *body, const char *method, double h, size_t steps, size_t n, double y[], double q[],
                poinsot_status per_body[]),
       (body, method, h, steps, n, y, q, per_body))

/* For legacy.c: poinsot_rotate_f_ makes no body; rows are as wide as the plan's momentum. */
#pragma GCC visibility push(hidden)
STATUS(rotate_moments, (const double moments[3], int by_jacobi, double h, size_t steps, size_t n, double y[], double q[],
                        poinsot_status per_body[]),
       (moments, by_jacobi, h, steps, n, y, q, per_body))
CHECKED(int, plan_components, (const poinsot_plan *plan), (plan), (void)0, 3)
#pragma GCC visibility pop

STATUS_AFTER(NO_TEXT, moments_check, (const double moments[3], char *buffer, size_t capacity), (moments, buffer, capacity))
STATUS_AFTER(NO_TEXT, inertia_check, (const double inertia[9], char *buffer, size_t capacity), (inertia, buffer, capacity))
STATUS(inertia_of_points, (size_t n, const double mass[], const double x[], double centre[3], double tensor[9]),
       (n, mass, x, centre, tensor))
STATUS(principal_axes, (const double tensor[9], double moments[3], double axes[9]), (tensor, moments, axes))

/* ---- elliptic functions -------------------------------------------------------------------------------------------- */

STATUS(jacobi, (size_t n, const double u[], const double m[], const double m1[], double sn[], double cn[], double dn[]),
       (n, u, m, m1, sn, cn, dn))
STATUS(jacobi_am, (size_t n, const double u[], const double m[], const double m1[], double am[]), (n, u, m, m1, am))
STATUS(elliptic_k, (size_t n, const double m[], const double m1[], double k[]), (n, m, m1, k))
STATUS(elliptic_e, (size_t n, const double m[], const double m1[], double e[]), (n, m, m1, e))
STATUS(elliptic_pi, (size_t n, const double nu[], const double m[], const double m1[], double p[]), (n, nu, m, m1, p))
STATUS(elliptic_f, (size_t n, const double phi[], const double m[], const double m1[], double f[]), (n, phi, m, m1, f))
STATUS(elliptic_e_incomplete, (size_t n, const double phi[], const double m[], const double m1[], double e[]), (n, phi, m, m1, e))
STATUS(elliptic_pi_incomplete, (size_t n, const double nu[], const double phi[], const double m[], const double m1[], double p[]),
       (n, nu, phi, m, m1, p))
STATUS(carlson_rf, (size_t n, const double x[], const double y[], const double z[], double r[]), (n, x, y, z, r))
STATUS(carlson_rc, (size_t n, const double x[], const double y[], double r[]), (n, x, y, r))
STATUS(carlson_rd, (size_t n, const double x[], const double y[], const double z[], double r[]), (n, x, y, z, r))
STATUS(carlson_rj, (size_t n, const double x[], const double y[], const double z[], const double p[], double r[]), (n, x, y, z, p, r))

/* ---- quaternions --------------------------------------------------------------------------------------------------- */

#define FROM_ONE(name) STATUS(quaternion_##name, (size_t n, const double in[], double out[]), (n, in, out))
#define FROM_TWO(name) \
  STATUS(quaternion_##name, (size_t n, const double in[], const double with[], double out[]), (n, in, with, out))
FROM_TWO(multiply)
FROM_ONE(conjugate)
FROM_ONE(inverse)
FROM_ONE(normalize)
FROM_ONE(exp)
FROM_ONE(log)
FROM_TWO(rotate)
FROM_TWO(rotate_back)
FROM_ONE(to_matrix)
FROM_ONE(from_matrix)
FROM_ONE(nearest)
FROM_ONE(from_rotation_vector)
FROM_ONE(to_rotation_vector)
FROM_TWO(from_axis_angle)
STATUS(quaternion_to_axis_angle, (size_t n, const double q[], double axis[], double angle[]), (n, q, axis, angle))
FROM_ONE(from_cayley)
FROM_ONE(to_cayley)
STATUS(quaternion_from_euler, (size_t n, const char *convention, const double angles[], double q[]), (n, convention, angles, q))
STATUS(quaternion_to_euler, (size_t n, const char *convention, const double q[], double angles[]), (n, convention, q, angles))
STATUS(quaternion_slerp, (size_t n, const double p[], const double q[], const double t[], double r[]), (n, p, q, t, r))
FROM_TWO(shortest_arc)
FROM_TWO(distance)
STATUS(quaternion_random, (size_t n, int64_t seed, double q[]), (n, seed, q))

/* ---- many bodies --------------------------------------------------------------------------------------------------- */

STATUS(bodies_rows_sized, (poinsot_bodies *bodies, size_t size, const char *layout, const char *order, size_t n,
                           double momentum[], double attitude[]),
       (bodies, size, layout, order, n, momentum, attitude))
STATUS(bodies_arrays_sized, (poinsot_bodies *bodies, size_t size, const char *layout, size_t n, double *const momentum[],
                             double *const attitude[4]),
       (bodies, size, layout, n, momentum, attitude))
/* For programs compiled with the header of 0.1, whose struct had 136 bytes: macros of these names hide them in the header. */
#undef poinsot_bodies_rows
#undef poinsot_bodies_arrays
poinsot_status poinsot_bodies_rows(poinsot_bodies *bodies, const char *layout, const char *order, size_t n, double momentum[],
                                   double attitude[]) {
  return poinsot_bodies_rows_sized(bodies, 136, layout, order, n, momentum, attitude);
}
poinsot_status poinsot_bodies_arrays(poinsot_bodies *bodies, const char *layout, size_t n, double *const momentum[],
                                     double *const attitude[4]) {
  return poinsot_bodies_arrays_sized(bodies, 136, layout, n, momentum, attitude);
}
STATUS_AFTER(NO_TEXT, bodies_check, (const poinsot_plan *plan, const poinsot_bodies *bodies, char *buffer, size_t capacity),
             (plan, bodies, buffer, capacity))

STATUS_AFTER(if (plan) *plan = NULL, plan_create, (poinsot_plan **plan), (plan))
DESTROY(plan, poinsot_plan)
STATUS(plan_add_class, (poinsot_plan *plan, const double moments[3], int *number), (plan, moments, number))
STATUS(plan_find_class, (poinsot_plan *plan, const double moments[3], double tolerance, int *number),
       (plan, moments, tolerance, number))
STATUS(plan_add_class_tensor, (poinsot_plan *plan, const double inertia[9], int *number), (plan, inertia, number))
STATUS(plan_class_axes, (const poinsot_plan *plan, int number, double axes[9]), (plan, number, axes))
STATUS(plan_set, (poinsot_plan *plan, const char *option, const char *value), (plan, option, value))
STATUS(plan_add_effect, (poinsot_plan *plan, const char *name, const char *settings), (plan, name, settings))
STATUS(plan_ready, (poinsot_plan *plan), (plan))
CHECKED(size_t, plan_message, (const poinsot_plan *plan, char *buffer, size_t capacity), (plan, buffer, capacity), NO_TEXT, 0)

STATUS(drift, (const poinsot_plan *plan, const poinsot_bodies *bodies, double h), (plan, bodies, h))
STATUS(kick, (const poinsot_plan *plan, const poinsot_bodies *bodies, double h, const double *const torque[3], ptrdiff_t stride),
       (plan, bodies, h, torque, stride))
STATUS(dissipate, (const poinsot_plan *plan, const poinsot_bodies *bodies, double h, int64_t step), (plan, bodies, h, step))
STATUS(step, (const poinsot_plan *plan, const poinsot_bodies *bodies, double t, double h, int64_t first, int64_t steps,
              poinsot_torque *callback, void *context),
       (plan, bodies, t, h, first, steps, callback, context))
STATUS(energy, (const poinsot_plan *plan, const poinsot_bodies *bodies, double t, double kinetic[], double potential[]),
       (plan, bodies, t, kinetic, potential))
STATUS(momentum, (const poinsot_plan *plan, const poinsot_bodies *bodies, double momentum[]), (plan, bodies, momentum))
STATUS(degrees_of_freedom, (const poinsot_plan *plan, const poinsot_bodies *bodies, size_t *count), (plan, bodies, count))
