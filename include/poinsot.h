/* poinsot: rotation of rigid bodies. The C interface, C99 and C++.
 *
 * Terms (glossary: docs/conventions.md)
 *   body      principal moments of inertia I1, I2, I3, in any order and any unit
 *   y         angular momentum in the body frame, in units of I times angular velocity
 *   q         attitude: unit quaternion, scalar first, body -> space; its norm may differ from 1 by at most 1e-6
 *   h, t      step size and time, in the unit in which y/I is an angular velocity in radians per unit of time; h of either sign
 *   class     bodies with the same moments
 *   plan      what stays the same from call to call: classes, method, splitting, effects, frame, momentum variable, threads
 *
 * Rules
 *   Statuses  Every call that can fail returns a status. The library never prints, never stops the program, and has no global
 *             state. NULL where a pointer is required: POINSOT_E_NULL. If a body fails (its numbers are not finite, its attitude
 *             is not a unit quaternion, it has momentum about an axis without inertia, the step is too long for the method), it
 *             keeps its state from before the call and gets its own status; the results of all other bodies are bitwise
 *             unaffected, and the call returns POINSOT_E_PARTIAL. After any other failure all arrays are unchanged, unless a
 *             function says otherwise.
 *   Memory    _create makes a handle; _destroy frees it and sets it to NULL; destroying NULL is allowed. Arrays belong to the
 *             caller, are used only during the call, and must not overlap.
 *   Threads   All functions may be called from several threads at once. Threads may share a handle that is no longer modified:
 *             a body always, a plan after poinsot_plan_ready. Simultaneous calls must use different arrays. Inside a parallel
 *             region of the caller, a call runs on one thread. If the system cannot create a thread (ulimit -u), the OpenMP
 *             runtime ends the process: use one thread there.
 *   Bits      A body's result depends on the body, its class and the step, not on its neighbours, its position, the number of
 *             bodies or the number of threads. With the native layout and no tensor class, one call of ten steps gives bitwise
 *             the result of ten calls of one step.
 *   Fork      A forked child may call every function, with threads too: on Linux the OpenMP threads of the forking thread are
 *             released before the fork and restarted when needed. Do not fork inside a parallel region.
 *   Traps     No call on valid input raises an invalid, overflow or divide-by-zero exception.
 *   Rounding  The rounding mode must be to nearest. In a thread with another mode, bodies get POINSOT_E_DOMAIN and keep their state.
 *   Processor On a processor older than the build requires, calls return POINSOT_E_CPU.
 */
#ifndef POINSOT_H
#define POINSOT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef int poinsot_status;

enum poinsot_status_code {
  POINSOT_OK = 0,
  POINSOT_E_NULL = 1,        /* a required pointer is NULL */
  POINSOT_E_SIZE = 2,        /* a size or a stride does not fit */
  POINSOT_E_DOMAIN = 3,      /* a value is out of range or not physical; or the plan is ready, or not yet ready */
  POINSOT_E_METHOD = 4,      /* unknown method, splitting, effect, layout or option name */
  POINSOT_E_STEP = 5,        /* the step is too long for this method */
  POINSOT_E_CONVERGENCE = 6, /* an iteration did not converge */
  POINSOT_E_MEMORY = 7,      /* out of memory */
  POINSOT_E_CALLBACK = 8,    /* the callback returned a stop request */
  POINSOT_E_PARTIAL = 9,     /* some bodies failed: see the status of each body */
  POINSOT_E_IO = 10,         /* a file could not be read or written */
  POINSOT_E_SCENE = 11,      /* the scene file has an error */
  POINSOT_E_CPU = 12,        /* this build needs a newer processor */
  POINSOT_E_NOT_FINITE = 13, /* of a body: a number is not finite */
  POINSOT_E_NOT_UNIT = 14,   /* of a body: the attitude is not a unit quaternion to 1e-6 */
  POINSOT_E_AXIS_MOMENTUM = 15 /* of a body: momentum about an axis without inertia, above 1e-6 of its total */
};

/* ---- the library -------------------------------------------------------------------------------------------------- */

/* 10000 major + 100 minor + patch. */
int poinsot_version(void);

/* The meaning of a status: a constant string, never NULL, even for an unknown number. */
const char *poinsot_status_text(poinsot_status status);

/* 1 if the build has a feature, else 0: "openmp", "lapack"; "release" (compiled with -O2 or -O3; other builds are up to 20 times
 * slower); processor features "avx2", "fma", "avx512", ..., and levels "x86-64-v2", "x86-64-v3", "x86-64-v4", which tell which
 * level of an installation was loaded. NULL and unknown names: 0. */
int poinsot_has_feature(const char *name);

/* Names of methods, splittings and effects, by number from 0: constant strings, "" for an unused number, NULL past the end. */
size_t poinsot_method_count(void);
const char *poinsot_method_name(size_t i);
size_t poinsot_splitting_count(void);
const char *poinsot_splitting_name(size_t i);
size_t poinsot_effect_count(void);
const char *poinsot_effect_name(size_t i);

/* For a host that runs the steps itself because its torques depend on more than attitudes, for example on centres of mass. One
 * step of size h of a splitting is, for i = 0 to *count - 1, a kick over kick[i] h followed by a drift over drift[i] h: poinsot_kick
 * and poinsot_drift for the rotation, the host for everything else. Skip coefficients that are 0. The scheme has its full order
 * if the drifts are exact. POINSOT_E_SIZE if capacity is less than *count (at most 32; set in any case); POINSOT_E_METHOD
 * for an unknown name and for splittings that need more than kicks and drifts: force gradients, a processor. */
poinsot_status poinsot_splitting_flows(const char *name, size_t capacity, double kick[], double drift[], size_t *count);

/* ---- one kind of body ---------------------------------------------------------------------------------------------- */

typedef struct poinsot_body poinsot_body;

/* A body from principal moments, zero or positive. Rounded values are accepted: the largest may exceed the sum of the other two
 * by 1e-3 of itself, and is used as given. If one moment is zero (or at most 1e-10 of the largest, and less than the difference of
 * the other two), the other two may differ by up to 1e-5 and are replaced by their mean. Otherwise POINSOT_E_DOMAIN. *body is NULL
 * after a failure. */
poinsot_status poinsot_body_create(const double moments[3], poinsot_body **body);

/* A body from its inertia tensor in any frame, row-major, symmetric to 1e-6 of its largest entry. A principal moment from -1e-6 to
 * 1e-10 of the largest counts as zero; up to 1e-6 if the entries have few digits (not quite symmetric, or all of
 * them single-precision numbers). The moments of a diagonal tensor are its entries. The principal axes are returned as the columns
 * of the rotation `axes` (row-major; may be NULL): x_given = axes x_principal. y and q of the body refer to the principal frame. */
poinsot_status poinsot_body_create_tensor(const double inertia[9], poinsot_body **body, double axes[9]);

/* Free a body and set the handle to NULL. body and *body may be NULL. */
void poinsot_body_destroy(poinsot_body **body);

/* Advance n bodies with the same moments by `steps` free steps of size h, in place.
 *   method    a name from poinsot_method_name: "exact", "jacobi", "dmv2" to "dmv24", "midpoint", ...; otherwise POINSOT_E_METHOD
 *   h         of either sign. A step may turn a body by up to 1e15 radians with "exact" and "jacobi", and by up to pi/2 with the
 *             others, at the largest angular velocity of the motion; beyond that the body gets POINSOT_E_STEP. "dmv2" and "rattle"
 *             fail somewhere between 1 and 1.5 (POINSOT_E_CONVERGENCE); "three-rotations" has a smaller limit for thin bodies.
 *             |angular velocity| up to 1e70, beyond that POINSOT_E_DOMAIN
 *   n         0 to 268435455; otherwise POINSOT_E_SIZE
 *   y         [n][3] angular momenta, body frame;   q: [n][4] attitudes, of unit norm to 1e-6, otherwise POINSOT_E_NOT_UNIT. NULL
 *             only if n = 0
 *   per_body  [n] status of each body; may be NULL
 * Uses the number of threads set for OpenMP (OMP_NUM_THREADS, omp_set_num_threads) if the work, `steps` times n, takes 20 ms or
 * more, otherwise one thread. (A plan has its own number.) */
poinsot_status poinsot_rotate(const poinsot_body *body, const char *method, double h, size_t steps,
                              size_t n, double y[], double q[], poinsot_status per_body[]);

/* ---- inertia ------------------------------------------------------------------------------------------------------- */

/* The status that poinsot_body_create or poinsot_body_create_tensor would return, and the reason as a sentence: which number, by
 * how much it is off, what is allowed; "" for POINSOT_OK. Writes at most capacity bytes, including the terminating zero; buffer may
 * be NULL. */
poinsot_status poinsot_moments_check(const double moments[3], char *buffer, size_t capacity);
poinsot_status poinsot_inertia_check(const double inertia[9], char *buffer, size_t capacity);

/* Centre of mass of n point masses, x: [n][3], and their inertia tensor about it: sum of m (|r|^2 - r r^T), r = x - centre, so the
 * entries off the diagonal are -sum of m r_i r_j. Masses are zero or positive, not all zero. n = 0: POINSOT_E_SIZE. */
poinsot_status poinsot_inertia_of_points(size_t n, const double mass[], const double x[], double centre[3], double tensor[9]);

/* Principal moments, ascending, and axes of a tensor (row-major, with -sum of m r_i r_j off the diagonal; if your program has
 * +sum there, change the signs): tensor = axes diag(moments) axes^T; the columns of axes (row-major) are right-handed, the largest
 * component of each of the first two positive. For equal moments the axes are as close as possible to the given frame. Accepts the
 * same tensors as poinsot_body_create_tensor; tensor and axes may be the same array. */
poinsot_status poinsot_principal_axes(const double tensor[9], double moments[3], double axes[9]);

/* ---- functions on arrays: rules -------------------------------------------------------------------------------------- *
 * n elements or rows, outputs last. An output may be the same array as an input of the same shape. If an element has no result
 * (an argument is not finite or outside the domain, or the result overflows), it is NaN and the call returns POINSOT_E_DOMAIN; all
 * other elements are valid. An element's result does not depend on its position. n = 0: nothing is read, POINSOT_OK. */

/* ---- elliptic functions and integrals ------------------------------------------------------------------------------ *
 * m = k^2 in [0, 1]. m1 = 1 - m: pass it if you know it more accurately than 1 - m gives (near m = 1), else NULL. nu is the one in
 * 1 - nu sin^2; integrals through a pole (nu sin^2 = 1) are POINSOT_E_DOMAIN, no principal value is computed. Accurate to a few ULP.
 * jacobi and jacobi_am return POINSOT_E_DOMAIN while the rounding mode of the thread is not to nearest. */

/* sn, cn, dn of u, |u| <= 1e15, to 1e-15 max(1, |u|/50); am to 1e-15 (1 + |am|). */
poinsot_status poinsot_jacobi(size_t n, const double u[], const double m[], const double m1[],
                              double sn[], double cn[], double dn[]);
poinsot_status poinsot_jacobi_am(size_t n, const double u[], const double m[], const double m1[], double am[]);

/* Complete integrals K(m), m < 1; E(m); Pi(nu, m), nu < 1, m < 1. */
poinsot_status poinsot_elliptic_k(size_t n, const double m[], const double m1[], double k[]);
poinsot_status poinsot_elliptic_e(size_t n, const double m[], const double m1[], double e[]);
poinsot_status poinsot_elliptic_pi(size_t n, const double nu[], const double m[], const double m1[], double p[]);

/* Incomplete integrals F(phi, m), E(phi, m), Pi(nu; phi, m), |phi| <= 1e15; for m = 1 (except E) or nu >= 1 only up to pi/2. */
poinsot_status poinsot_elliptic_f(size_t n, const double phi[], const double m[], const double m1[], double f[]);
poinsot_status poinsot_elliptic_e_incomplete(size_t n, const double phi[], const double m[], const double m1[], double e[]);
poinsot_status poinsot_elliptic_pi_incomplete(size_t n, const double nu[], const double phi[], const double m[], const double m1[],
                                              double p[]);

/* Carlson's R_F(x, y, z), R_C(x, y), R_D(x, y, z), R_J(x, y, z, p): x, y, z >= 0, at most one of them 0; z > 0 in R_D; y of R_C and
 * p of R_J not 0. For negative y or p: the principal value (R_J to a few ULP of R_F/(y - p), y the middle one of x, y, z). */
poinsot_status poinsot_carlson_rf(size_t n, const double x[], const double y[], const double z[], double r[]);
poinsot_status poinsot_carlson_rc(size_t n, const double x[], const double y[], double r[]);
poinsot_status poinsot_carlson_rd(size_t n, const double x[], const double y[], const double z[], double r[]);
poinsot_status poinsot_carlson_rj(size_t n, const double x[], const double y[], const double z[], const double p[], double r[]);

/* ---- quaternions --------------------------------------------------------------------------------------------------- *
 * Rows [n][4], scalar first, Hamilton's product. A unit quaternion is an attitude, body -> space; q and -q are the same attitude.
 * Input attitudes must have unit norm to 1e-6; output attitudes have unit norm. Vectors are [n][3], angles in
 * radians, matrices [n][9], row-major, their columns the body axes in space. */

/* r = p o q (as rotations: first q, then p), r = conjugate of q, 1/q, q/|q|; the last two are undefined for q = 0. */
poinsot_status poinsot_quaternion_multiply(size_t n, const double p[], const double q[], double r[]);
poinsot_status poinsot_quaternion_conjugate(size_t n, const double q[], double r[]);
poinsot_status poinsot_quaternion_inverse(size_t n, const double q[], double r[]);
poinsot_status poinsot_quaternion_normalize(size_t n, const double q[], double r[]);

/* exp and log of quaternions of any norm: exp((0, v)) rotates by 2 |v| about v. log is the principal value, with a vector part of
 * length at most pi, along the first axis if q is real and negative. exp needs q[0] <= 709.78. */
poinsot_status poinsot_quaternion_exp(size_t n, const double q[], double r[]);
poinsot_status poinsot_quaternion_log(size_t n, const double q[], double r[]);

/* w = Q v, body to space, and w = Q^T v, space to body. */
poinsot_status poinsot_quaternion_rotate(size_t n, const double q[], const double v[], double w[]);
poinsot_status poinsot_quaternion_rotate_back(size_t n, const double q[], const double v[], double w[]);

/* Rotation matrices. from_matrix accepts rotations to 4e-6 (|m^T m - 1|, determinant +1); nearest returns the rotation nearest in
 * the least-squares sense to a matrix of any scale, if it is unique. The scalar part is not negative. */
poinsot_status poinsot_quaternion_to_matrix(size_t n, const double q[], double m[]);
poinsot_status poinsot_quaternion_from_matrix(size_t n, const double m[], double q[]);
poinsot_status poinsot_quaternion_nearest(size_t n, const double m[], double q[]);

/* Rotation vector: angle times axis; to_ returns a length of at most pi. */
poinsot_status poinsot_quaternion_from_rotation_vector(size_t n, const double v[], double q[]);
poinsot_status poinsot_quaternion_to_rotation_vector(size_t n, const double q[], double v[]);

/* axis [n][3], of any non-zero length, angle [n]. to_ returns unit axes and angles in [0, pi]; for the identity, the first axis. */
poinsot_status poinsot_quaternion_from_axis_angle(size_t n, const double axis[], const double angle[], double q[]);
poinsot_status poinsot_quaternion_to_axis_angle(size_t n, const double q[], double axis[], double angle[]);

/* Cayley vector: tan(angle/2) times axis; undefined for a half-turn. */
poinsot_status poinsot_quaternion_from_cayley(size_t n, const double e[], double q[]);
poinsot_status poinsot_quaternion_to_cayley(size_t n, const double q[], double e[]);

/* Intrinsic Euler angles [n][3]: q = q_1(a1) o q_2(a2) o q_3(a3), rotations about the axes of the convention: "xyz", "xzy",
 * "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"; otherwise POINSOT_E_METHOD. to_ returns the first and third
 * in [-pi, pi], the second in [0, pi] if the first and third axes are the same, else in [-pi/2, pi/2]; in gimbal lock the third is
 * 0. */
poinsot_status poinsot_quaternion_from_euler(size_t n, const char *convention, const double angles[], double q[]);
poinsot_status poinsot_quaternion_to_euler(size_t n, const char *convention, const double q[], double angles[]);

/* Spherical interpolation from p (t = 0) to q (t = 1) by the shorter arc; t [n], extrapolates outside [0, 1]. */
poinsot_status poinsot_quaternion_slerp(size_t n, const double p[], const double q[], const double t[], double r[]);

/* The smallest rotation that takes direction a to direction b, [n][3]. The scalar part is not negative. */
poinsot_status poinsot_quaternion_shortest_arc(size_t n, const double a[], const double b[], double q[]);

/* d [n] = min(|p - q|, |p + q|) of any two quaternions; for attitudes, half the angle between them if that is small. */
poinsot_status poinsot_quaternion_distance(size_t n, const double p[], const double q[], double d[]);

/* Attitudes distributed uniformly over all rotations: row i is a function of seed and i. */
poinsot_status poinsot_quaternion_random(size_t n, int64_t seed, double q[]);

/* ---- many bodies: the view ----------------------------------------------------------------------------------------- */

/* How the library sees the caller's bodies. Set size = sizeof(poinsot_bodies) and all else to 0, then fill in what you need; or
 * call poinsot_bodies_rows or poinsot_bodies_arrays. Component j of body i is y[j][i*y_stride], q[j][i*q_stride]. For bindings: with
 * 8-byte pointers it is 26 8-byte words without gaps, in this order, 208 bytes (136 in version 0.1). */
typedef struct poinsot_bodies {
  size_t size;             /* sizeof(poinsot_bodies); that of an earlier version is accepted, its missing members are 0; so is
                              a longer struct that ends in zeros; any other size is POINSOT_E_SIZE */
  size_t n;                /* number of bodies, at most 268435455 */
  double *y[3];            /* components of the momentum variable of the plan */
  double *q[4];            /* components of the attitude, scalar first */
  ptrdiff_t y_stride;      /* from one body to the next, in doubles, at least 1 */
  ptrdiff_t q_stride;
  const int *body_class;   /* [n] class of each body; NULL: all are of the first class. A body with a negative class
                              is skipped: state kept, status OK, energy and momentum 0, no degrees of freedom, no part in pairs */
  const int64_t *id;       /* [n] number of each body for the random numbers of a thermostat; NULL: its position */
  double *carry;           /* [n][7] low-order parts of compensated sums, zero at the start, kept by the caller; NULL: plain sums */
  poinsot_status *status;  /* [n] status of each body, set by each call; or NULL */
  double *y_fourth;        /* the fourth component of a conjugate momentum, same stride; else NULL */
  ptrdiff_t first_class;   /* what body_class calls the first class of the plan: 0, or 1 for hosts that count from 1 */
  /* since 0.2 */
  ptrdiff_t class_stride;  /* of body_class, in ints; 0 = 1 */
  const int *y_at, *q_at;  /* [n] rows of y (and y_fourth) and of q, from 0; NULL: body i is row i. Other arrays are indexed by i */
  size_t rows;             /* number of rows: an index outside 0 to rows - 1 is POINSOT_E_SIZE; 0: only negative ones are detected */
  const double *scale;     /* [n] moments of body i over those of its class; NULL: 1. Bodies of one shape and different sizes cost no
                              more than those of one class (taylor: more). If not positive, that body gets POINSOT_E_DOMAIN */
  const double *moments[3]; /* or moments for each body, about the principal axes of its class if it has one; body_class, if given,
                              only selects the bodies that effects act on. The plan then needs no class. For the methods "exact" and
                              "jacobi", splittings without force gradients and effects that need no moments; POINSOT_E_METHOD with
                              any other, or with scale */
  ptrdiff_t moments_stride; /* in doubles; 0 = 1 */
} poinsot_bodies;

/* Fill a view of n bodies stored in rows: momentum [n][3] (or [n][4] for a conjugate momentum), attitude [n][4].
 *   layout    "native", "lammps", "dl_poly", "hoomd": that of the plan
 *   order     of the quaternion components: "wxyz" or "xyzw"; NULL is "wxyz"
 * Sets every member of *bodies; those not named here become 0. */
poinsot_status poinsot_bodies_rows(poinsot_bodies *bodies, const char *layout, const char *order, size_t n,
                                   double momentum[], double attitude[]);

/* The same for component arrays: momentum[3] (or [4]) and attitude[4] (w, x, y, z) point to arrays of n numbers. */
poinsot_status poinsot_bodies_arrays(poinsot_bodies *bodies, const char *layout, size_t n,
                                     double *const momentum[], double *const attitude[4]);

/* The same, writing `size` bytes, the size of the struct in the caller's version; an unknown size is POINSOT_E_SIZE. The two names
 * above are macros for these. (The functions of those names serve programs compiled with version 0.1, and write its 136 bytes.) */
poinsot_status poinsot_bodies_rows_sized(poinsot_bodies *bodies, size_t size, const char *layout, const char *order, size_t n,
                                         double momentum[], double attitude[]);
poinsot_status poinsot_bodies_arrays_sized(poinsot_bodies *bodies, size_t size, const char *layout, size_t n,
                                           double *const momentum[], double *const attitude[4]);
#define poinsot_bodies_rows(bodies, layout, order, n, momentum, attitude) \
  poinsot_bodies_rows_sized(bodies, sizeof(poinsot_bodies), layout, order, n, momentum, attitude)
#define poinsot_bodies_arrays(bodies, layout, n, momentum, attitude) \
  poinsot_bodies_arrays_sized(bodies, sizeof(poinsot_bodies), layout, n, momentum, attitude)

/* ---- many bodies: the plan ----------------------------------------------------------------------------------------- */

typedef struct poinsot_plan poinsot_plan;

/* Make a plan with method "exact", splitting "srkn6", native layout, torques in the body frame, one thread. */
poinsot_status poinsot_plan_create(poinsot_plan **plan);

/* Free a plan and set the handle to NULL. plan and *plan may be NULL. */
void poinsot_plan_destroy(poinsot_plan **plan);

/* Add a body class; *number is its number, counted from 0 (number may be NULL). Moments stay in the caller's order. With a tensor
 * (row-major, in the caller's body frame) y, q, torques, and all body-frame quantities of an effect (centre, dipole, rotor, axis,
 * body torque, three frictions) refer to that frame, not the principal one. The entries of a diagonal tensor are the moments. */
poinsot_status poinsot_plan_add_class(poinsot_plan *plan, const double moments[3], int *number);
poinsot_status poinsot_plan_add_class_tensor(poinsot_plan *plan, const double inertia[9], int *number);

/* Find the class whose moments are nearest, axis by axis, each within `tolerance` times the largest (the lowest number of
 * several; classes made from tensors are not considered); add a class if there is none. For codes that compute moments from
 * coordinates, where 216 water molecules have 216 slightly different sets of moments: 1e-6 puts them in one class. Numbers depend on
 * the order of calls: MPI ranks must share the list, or use `moments` of poinsot_bodies. POINSOT_E_DOMAIN for a tolerance that is
 * negative or not finite, or a plan that is ready. */
poinsot_status poinsot_plan_find_class(poinsot_plan *plan, const double moments[3], double tolerance, int *number);

/* The principal axes of class `number` (from 0) as the columns of the rotation `axes`, row-major: x_given = axes x_principal; the
 * identity for a class made from moments. POINSOT_E_DOMAIN if there is no such class. */
poinsot_status poinsot_plan_class_axes(const poinsot_plan *plan, int number, double axes[9]);

/* Set an option by name:
 *   "method"     a name from poinsot_method_name;   "splitting"  one from poinsot_splitting_name
 *   "layout"     the momentum variable of the arrays, and the frame of torques:
 *                "native"   angular momentum, body frame; torques in the body frame
 *                "lammps"   angular momentum, space frame; torques in the space frame
 *                "dl_poly"  angular velocity, body frame; torques in the space frame
 *                "hoomd"    conjugate momentum 2 q o (0, y), four components; torques in the space frame
 *   "momentum"   the momentum variable alone: "body-momentum", "space-momentum", "body-velocity", "space-velocity",
 *                "conjugate-momentum"
 *   "frame"      of the torques for poinsot_kick and from a callback: "body" or "space"
 *   "threads"    "1" (default) to "4096", or "0": the number set for OpenMP (OMP_NUM_THREADS, omp_set_num_threads). Several are used
 *                only if each gets 0.2 ms of work; if other programs keep the cores busy, a call can then wait for a time slice of
 *                the scheduler, 12 to 80 ms, however small the work: see the table in docs/performance.md
 *   "seed"       of random numbers, a 64-bit integer
 *   "tolerance"  relative, of the splitting "taylor": 1e-15 to 1e-2 (default "1e-12")
 *   "physical"   "yes" (default), or "no": classes added afterwards may have any non-negative moments, whatever their sum
 *                (if one is zero, the other two are replaced by their mean: Euler's equations allow no other motion)
 * Options in upper or lower case; blanks around a value are ignored.
 * POINSOT_E_METHOD for an unknown option or name, POINSOT_E_DOMAIN for a number out of range or a plan that is ready. */
poinsot_status poinsot_plan_set(poinsot_plan *plan, const char *option, const char *value);

/* Add an effect by name, with keys and values as listed by `poinsot effects`, in one string: "centre = 0, 0, 1; weight = 2".
 * As in scene files, names and keys may be in upper or lower case, numbers are separated by blanks or commas, "3*0" is three
 * zeros, and words may be quoted. Keys not given have their defaults; the key `class` (from 1; 0 is all) selects the class that the
 * effect acts on. settings may be NULL or "". Wrong keys or values: POINSOT_E_METHOD, _E_SIZE or _E_DOMAIN, explained by
 * poinsot_plan_message. */
poinsot_status poinsot_plan_add_effect(poinsot_plan *plan, const char *name, const char *settings);

/* Check the plan and make it ready: from then on it cannot be changed, and threads may share it. */
poinsot_status poinsot_plan_ready(poinsot_plan *plan);

/* Why the last call on a plan that was not ready failed, as a sentence: what, where, what is allowed; "" if it did not fail.
 * Writes at most capacity bytes, including the terminating zero, and returns the length of the whole sentence. buffer may be NULL
 * if capacity is 0; plan may be NULL. */
size_t poinsot_plan_message(const poinsot_plan *plan, char *buffer, size_t capacity);

/* Would poinsot_drift accept these bodies with this plan? Returns the status that it would return before it looks at any body,
 * and the reason as a sentence, as in poinsot_plan_message. */
poinsot_status poinsot_bodies_check(const poinsot_plan *plan, const poinsot_bodies *bodies, char *buffer, size_t capacity);

/* ---- many bodies: what a host calls every step --------------------------------------------------------------------- */

/* Free rotation of all bodies over h by the plan's method, including built-in rotors (gyrostats); no other effect of the plan
 * acts (for drag and thermostats: poinsot_dissipate). A rotor whose momentum is a table in time needs the time, which only
 * poinsot_step and poinsot_energy are given: POINSOT_E_METHOD here, in poinsot_dissipate, and, if the layout has velocities, in
 * poinsot_kick and poinsot_momentum. */
poinsot_status poinsot_drift(const poinsot_plan *plan, const poinsot_bodies *bodies, double h);

/* Kick: y += h torque. torque[j][i*stride] is component j for body i, in the plan's frame of torques; stride >= 1. */
poinsot_status poinsot_kick(const poinsot_plan *plan, const poinsot_bodies *bodies, double h,
                            const double *const torque[3], ptrdiff_t stride);

/* The flow of the plan's drag and thermostats alone, over h >= 0. A host that runs its own steps calls it in the middle of
 * kick h/2, drift h/2, dissipate h, drift h/2, kick h/2, which is the splitting "baoab". There is one set of random numbers for each
 * (seed, id, step); with step = k the result is bitwise that of step k of poinsot_step. It acts on I omega: y minus the momentum of
 * built-in rotors. Momenta have the right temperature immediately after this call; at the ends of steps they are too cold by O(h^2),
 * while attitudes are sampled best there. h < 0: POINSOT_E_DOMAIN. A plan without drag or thermostat: POINSOT_OK, nothing changed. */
poinsot_status poinsot_dissipate(const poinsot_plan *plan, const poinsot_bodies *bodies, double h, int64_t step);

/* The host's torques, called by poinsot_step. Attitudes are in the host's order and body frames, component j of body i at
 * q[j][i*q_stride]; write torques, zero on entry, to torque[j][i*torque_stride], in the plan's frame of torques. *energy may be set
 * to the potential energy of all bodies. Runs in the thread that called poinsot_step. Return 0 to go on, anything else to stop. It
 * must neither throw nor longjmp out. */
typedef int poinsot_torque(void *context, double t, size_t n, const double *const q[4], ptrdiff_t q_stride,
                           double *const torque[3], ptrdiff_t torque_stride, double *energy);

/* Take steps number first to first + steps - 1, of size h, by the plan's splitting, with the plan's effects and the callback's
 * torques (NULL: none). Step k starts at t + k h. The step number also selects the random numbers: continue with first + steps. The
 * result is bitwise the same however the steps are divided into calls, except with takahashi-imada, whose processor acts at both ends
 * of a call and adds rounding errors. If the callback stops: POINSOT_E_CALLBACK, and all bodies have their state from before the
 * interrupted step. */
poinsot_status poinsot_step(const poinsot_plan *plan, const poinsot_bodies *bodies, double t, double h,
                            int64_t first, int64_t steps, poinsot_torque *callback, void *context);

/* Kinetic and potential energy of each body at time t, [n] each, either may be NULL; the energy of a pair is divided equally
 * between its bodies. The callback's energy is not included. A body that fails gets zeros. */
poinsot_status poinsot_energy(const poinsot_plan *plan, const poinsot_bodies *bodies, double t,
                              double kinetic[], double potential[]);

/* Angular momentum of each body in the space frame, [n][3]. */
poinsot_status poinsot_momentum(const poinsot_plan *plan, const poinsot_bodies *bodies, double momentum[]);

/* Rotational degrees of freedom of all bodies: 3 each, 2 for a linear one; an axis without inertia has none. */
poinsot_status poinsot_degrees_of_freedom(const poinsot_plan *plan, const poinsot_bodies *bodies, size_t *count);

/* ---- for Fortran code with implicit interfaces, also fixed form ---------------------------------------------------- *
 * poinsot_..._f: subroutines for compilers that append one underscore (gfortran, ifort, ifx, flang). All arguments are passed by
 * reference: 4-byte INTEGER, DOUBLE PRECISION, handles in INTEGER*8, strings followed by their length. status is last. Methods,
 * splittings and effects are given by their number in the lists above, counted from 1: method 1 = exact, 2 = jacobi, 3 = dmv2,
 * 4 = dmv4, ... Classes count from 1. Bodies are rows: y(3,n) (y(4,n) for a conjugate momentum), q(4,n); in routines that end in
 * _a_f each component is a separate array. class(n): the class of each body; if the plan has one class, class(1) = 0 means that all
 * bodies are of it, and no further element is read; with several classes, all 0 means that all are of class 1, and a 0 among other
 * numbers is POINSOT_E_DOMAIN for that body; -1: the body is skipped. each(n): status of each body. */

/* status = POINSOT_OK or POINSOT_E_CPU; version as in poinsot_version. */
void poinsot_version_f_(int *version, int *status);
/* As poinsot_rotate, for bodies that all have these moments, on one thread. Methods 1 and 2 (exact, jacobi) do not set up a body
 * class: the result equals that of poinsot_rotate up to rounding errors. */
void poinsot_rotate_f_(const double moments[3], const int *method, const double *h, const int *steps, const int *n,
                       double y[], double q[], int each[], int *status);
/* As poinsot_splitting_flows, for splitting number `splitting`. */
void poinsot_splitting_f_(const int *splitting, const int *capacity, double kick[], double drift[], int *count, int *status);
void poinsot_plan_create_f_(int64_t *plan, int *status);
void poinsot_plan_destroy_f_(int64_t *plan);
void poinsot_plan_add_class_f_(const int64_t *plan, const double moments[3], int *number, int *status);
void poinsot_plan_add_tensor_f_(const int64_t *plan, const double inertia[9], int *number, int *status);
void poinsot_plan_find_class_f_(const int64_t *plan, const double moments[3], const double *tolerance, int *number, int *status);
/* option 1 method, 2 splitting: value is its number; 3 layout: 1 native, 2 lammps, 3 dl_poly, 4 hoomd; 4 momentum: 1 to 5 in the
 * order above; 5 frame: 1 body, 2 space; 6 threads; 7 seed; 8 physical: 1 yes, 2 no. */
void poinsot_plan_set_f_(const int64_t *plan, const int *option, const int *value, int *status);
/* U = weight * (Q^T up) . centre, on all classes. */
void poinsot_plan_gravity_f_(const int64_t *plan, const double centre[3], const double *weight, const double up[3], int *status);
/* The option "tolerance". */
void poinsot_plan_tolerance_f_(const int64_t *plan, const double *tolerance, int *status);
/* As poinsot_plan_add_effect; CHARACTER name*(name_length), settings*(settings_length), trailing blanks are ignored. */
void poinsot_plan_effect_f_(const int64_t *plan, const char *name, const int *name_length, const char *settings,
                            const int *settings_length, int *status);
void poinsot_plan_ready_f_(const int64_t *plan, int *status);
/* poinsot_plan_message and poinsot_status_text into CHARACTER text*(length), blank-padded. */
void poinsot_plan_message_f_(const int64_t *plan, char *text, const int *length);
void poinsot_status_text_f_(const int *status, char *text, const int *length);
void poinsot_drift_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *h,
                      int each[], int *status);
/* torque(3,n) */
void poinsot_kick_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *h,
                     const double torque[], int each[], int *status);
/* As poinsot_dissipate. */
void poinsot_dissipate_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *h,
                          const int *step, int each[], int *status);
/* As poinsot_step, without a callback. */
void poinsot_step_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *t,
                     const double *h, const int *first, const int *steps, int each[], int *status);
/* The same with torques from an EXTERNAL subroutine torques(t, n, q, torque, stop) with q(n,4), torque(n,3), INTEGER stop: set
 * stop to a non-zero value to stop. */
typedef void poinsot_torque_f(const double *t, const int *n, const double q[], double torque[], int *stop);
void poinsot_step_torque_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *t,
                            const double *h, const int *first, const int *steps, poinsot_torque_f *torques, int each[],
                            int *status);
void poinsot_energy_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *t,
                       double kinetic[], double potential[], int *status);
/* Component arrays; not for a conjugate momentum. */
void poinsot_drift_a_f_(const int64_t *plan, const int *n, double y1[], double y2[], double y3[], double q0[], double q1[],
                        double q2[], double q3[], const int body_class[], const double *h, int each[], int *status);
void poinsot_kick_a_f_(const int64_t *plan, const int *n, double y1[], double y2[], double y3[], double q0[], double q1[],
                       double q2[], double q3[], const int body_class[], const double *h, const double torque1[],
                       const double torque2[], const double torque3[], int each[], int *status);
void poinsot_dissipate_a_f_(const int64_t *plan, const int *n, double y1[], double y2[], double y3[], double q0[], double q1[],
                            double q2[], double q3[], const int body_class[], const double *h, const int *step, int each[],
                            int *status);
/* The same with the four components of a conjugate momentum; POINSOT_E_METHOD if that is not the plan's variable. */
void poinsot_dissipate_c_f_(const int64_t *plan, const int *n, double p0[], double p1[], double p2[], double p3[], double q0[],
                            double q1[], double q2[], double q3[], const int body_class[], const double *h, const int *step,
                            int each[], int *status);
void poinsot_drift_c_f_(const int64_t *plan, const int *n, double p0[], double p1[], double p2[], double p3[], double q0[],
                        double q1[], double q2[], double q3[], const int body_class[], const double *h, int each[], int *status);
void poinsot_kick_c_f_(const int64_t *plan, const int *n, double p0[], double p1[], double p2[], double p3[], double q0[],
                       double q1[], double q2[], double q3[], const int body_class[], const double *h, const double torque1[],
                       const double torque2[], const double torque3[], int each[], int *status);

#ifdef __cplusplus
}
#endif

#endif
