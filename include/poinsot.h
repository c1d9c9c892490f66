/* poinsot: rotation of rigid bodies. The C interface, C99 and C++.
 *
 * What is meant
 *   body      moments of inertia I1, I2, I3 about principal axes, in any order and any unit
 *   y         angular momentum in the body frame, in units of I times an angular velocity
 *   q         attitude: unit quaternion, scalar first, body -> space; off unit norm by at most 1e-6
 *   h, t      step and time, in the unit that makes y/I an angular velocity in radians per unit of time; h of either sign
 *   class     a kind of body: bodies with the same moments
 *   plan      what does not change from call to call: classes, method, splitting, effects, frame, momentum variable, threads
 *
 * Rules
 *   Statuses  Every call that can fail returns a status. Nothing is printed, nothing stops the program, there is no global
 *             state. A NULL where none is allowed: POINSOT_E_NULL. A body that fails (its numbers are not finite, not a unit
 *             quaternion, momentum about an axis without inertia, a step too long for the method) keeps the state that it had
 *             when the call began and gets a status of its own; the others go on, bit for bit as without it, and the call
 *             returns POINSOT_E_PARTIAL. After any other failure no array has been changed, unless a function says so.
 *   Memory    Handles are made by _create and freed by _destroy, which sets them to NULL; to destroy NULL is fine. Arrays are
 *             the caller's, are used during the call only, and must not overlap.
 *   Threads   All functions may be called from several threads at once. One handle may be shared by threads once it is not
 *             changed any more: a body always, a plan after poinsot_plan_ready. The arrays of simultaneous calls must differ.
 *             Inside a parallel region of the caller a call runs serial. Where the system refuses to make a thread (ulimit -u),
 *             the OpenMP runtime itself ends the process: ask for one thread there.
 *   Bits      A body's result depends on the body, its class and the step: not on its neighbours, its place, the number of
 *             bodies or of threads. With the native layout and no tensor class, ten steps in one call are ten calls of one step.
 *   Fork      A child made by fork may call everything, with threads too: on Linux the forking thread's OpenMP workers are sent
 *             home before the fork and are started again when they are needed. Do not fork inside a parallel region.
 *   Traps     No call on valid input raises an invalid, overflow or divide-by-zero exception.
 *   Rounding  A thread that does not round to nearest refuses its bodies: POINSOT_E_DOMAIN, state kept.
 *   Processor A build for a newer processor answers POINSOT_E_CPU on an older one.
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
  POINSOT_E_DOMAIN = 3,      /* a value is out of its range or not physical; or the plan is (not) ready */
  POINSOT_E_METHOD = 4,      /* unknown method, splitting, effect, layout or option name */
  POINSOT_E_STEP = 5,        /* the step is too long for this method */
  POINSOT_E_CONVERGENCE = 6, /* an iteration did not converge */
  POINSOT_E_MEMORY = 7,      /* out of memory */
  POINSOT_E_CALLBACK = 8,    /* the callback asked to stop */
  POINSOT_E_PARTIAL = 9,     /* some bodies failed: see the status of each body */
  POINSOT_E_IO = 10,         /* a file could not be read or written */
  POINSOT_E_SCENE = 11,      /* the scene file has an error */
  POINSOT_E_CPU = 12,        /* this build needs a newer processor */
  POINSOT_E_NOT_FINITE = 13, /* of a body: a number is not finite */
  POINSOT_E_NOT_UNIT = 14,   /* of a body: the attitude is not a unit quaternion, to 1e-6 */
  POINSOT_E_AXIS_MOMENTUM = 15 /* of a body: momentum about an axis without inertia, above 1e-6 of all its momentum */
};

/* ---- the library -------------------------------------------------------------------------------------------------- */

/* 10000 major + 100 minor + patch. */
int poinsot_version(void);

/* What a status means: constant text, never NULL, also for an unknown number. */
const char *poinsot_status_text(poinsot_status status);

/* 1 if the build has a feature, else 0: "openmp", "lapack"; "release" (compiled with -O2 or -O3: another build is up to 20 times
 * slower); of the processor "avx2", "fma", "avx512", ..., and "x86-64-v2", "x86-64-v3", "x86-64-v4" for a whole level: which of the
 * levels of an installation was loaded. NULL and unknown names: 0. */
int poinsot_has_feature(const char *name);

/* Free methods, splittings and effects by number from 0: constant texts, "" for a number not given, NULL past the end. */
size_t poinsot_method_count(void);
const char *poinsot_method_name(size_t i);
size_t poinsot_splitting_count(void);
const char *poinsot_splitting_name(size_t i);
size_t poinsot_effect_count(void);
const char *poinsot_effect_name(size_t i);

/* For a host whose torques depend on more than attitudes, centres of mass say, and which therefore runs the steps itself: one step
 * of length h of a splitting is, for i = 0 to *count - 1, a kick over kick[i] h, then a drift over drift[i] h, of attitudes by
 * poinsot_kick and poinsot_drift and of all else by the host; zeros are left out. The order is kept if the drifts are exact.
 * POINSOT_E_SIZE if capacity is less than *count (at most 32), which is set nevertheless; POINSOT_E_METHOD for an unknown
 * name and for splittings that need more than kicks and drifts: force gradients, a processor. */
poinsot_status poinsot_splitting_flows(const char *name, size_t capacity, double kick[], double drift[], size_t *count);

/* ---- one kind of body ---------------------------------------------------------------------------------------------- */

typedef struct poinsot_body poinsot_body;

/* A body from principal moments, zero or positive. Few digits are enough: the largest may exceed the sum of the others by
 * 1e-3 of itself, and is used as it is; beside a zero moment (or one of at most 1e-10 of the largest, if they differ by more
 * than it) two that differ by up to 1e-5 become their mean. POINSOT_E_DOMAIN for others. *body is NULL after a failure. */
poinsot_status poinsot_body_create(const double moments[3], poinsot_body **body);

/* A body from its inertia tensor in any frame, row-major, symmetric to 1e-6 of its largest entry. A moment that is, relative
 * to the largest, from -1e-6 to 1e-10 is zero, and up to 1e-6 if the entries have few digits (not quite symmetric, or all of
 * them numbers of single precision); those of a diagonal tensor are its entries. The principal axes come back as the columns of the
 * rotation `axes` (row-major; may be NULL): x_given = axes x_principal. y and q of the body refer to the principal frame. */
poinsot_status poinsot_body_create_tensor(const double inertia[9], poinsot_body **body, double axes[9]);

/* Free a body and set the handle to NULL. body and *body may be NULL. */
void poinsot_body_destroy(poinsot_body **body);

/* `steps` free steps of length h of n bodies of one kind, in place.
 *   method    a name of poinsot_method_name: "exact", "jacobi", "dmv2" to "dmv24", "midpoint", ...; POINSOT_E_METHOD else
 *   h         either sign; "exact" and "jacobi" take up to 1e15 radians, the others pi/2 by the largest angular velocity of the
 *             motion: a body beyond gets POINSOT_E_STEP. "dmv2" and "rattle" end between 1 and 1.5: POINSOT_E_CONVERGENCE.
 *             "three-rotations" takes less of a thin body. |angular velocity| up to 1e70: POINSOT_E_DOMAIN beyond
 *   n         0 to 268435455; POINSOT_E_SIZE beyond
 *   y         [n][3] angular momenta, body frame;   q: [n][4] attitudes, of unit norm to 1e-6 or POINSOT_E_NOT_UNIT. NULL only if
 *             n = 0
 *   per_body  [n] a status for each body; may be NULL
 * Uses as many threads as OpenMP says (OMP_NUM_THREADS, omp_set_num_threads) where the work, `steps` times n, takes 20 ms or
 * more, else one; a plan says its own number. */
poinsot_status poinsot_rotate(const poinsot_body *body, const char *method, double h, size_t steps,
                              size_t n, double y[], double q[], poinsot_status per_body[]);

/* ---- inertia ------------------------------------------------------------------------------------------------------- */

/* The status that poinsot_body_create, poinsot_body_create_tensor would give, and the reason as a sentence: which number, by how
 * much it is off, what is allowed; "" if it is POINSOT_OK. At most capacity bytes are written, the last a zero; buffer may be
 * NULL. */
poinsot_status poinsot_moments_check(const double moments[3], char *buffer, size_t capacity);
poinsot_status poinsot_inertia_check(const double inertia[9], char *buffer, size_t capacity);

/* Centre of mass of n point masses, x: [n][3], and their inertia tensor about it: sum of m (|r|^2 - r r^T), r = x - centre, so the
 * entries off the diagonal are -sum of m r_i r_j. Masses are zero or positive, not all zero. n = 0: POINSOT_E_SIZE. */
poinsot_status poinsot_inertia_of_points(size_t n, const double mass[], const double x[], double centre[3], double tensor[9]);

/* Principal moments, ascending, and axes of a tensor (row-major, with -sum of m r_i r_j off the diagonal; a program that has
 * +sum there changes their signs): tensor = axes diag(moments) axes^T, the columns of axes (row-major) right-handed, the largest
 * component of the first two positive. Equal moments: axes as near to those given as can be. Takes what
 * poinsot_body_create_tensor takes; tensor and axes may be one array. */
poinsot_status poinsot_principal_axes(const double tensor[9], double moments[3], double axes[9]);

/* ---- functions on arrays: rules -------------------------------------------------------------------------------------- *
 * n elements or rows, outputs last. A result may stand in the place of an argument of the same shape. An element without an answer
 * (an argument that is not finite or out of its domain, a result out of range) gives NaN and the call POINSOT_E_DOMAIN; the
 * others are right, and the same wherever they stand. n = 0: nothing is read, POINSOT_OK. */

/* ---- elliptic functions and integrals ------------------------------------------------------------------------------ *
 * m = k^2 in [0, 1]. m1 = 1 - m, for those who know it better than 1 - m (near m = 1); may be NULL. nu stands in
 * 1 - nu sin^2; of integrals through a pole (nu sin^2 = 1) there is no principal value: POINSOT_E_DOMAIN. Within a few units in the
 * last place. While the thread does not round to nearest, all of jacobi and jacobi_am is POINSOT_E_DOMAIN. */

/* sn, cn, dn of u, |u| <= 1e15, to 1e-15 max(1, |u|/50); am to 1e-15 (1 + |am|). */
poinsot_status poinsot_jacobi(size_t n, const double u[], const double m[], const double m1[],
                              double sn[], double cn[], double dn[]);
poinsot_status poinsot_jacobi_am(size_t n, const double u[], const double m[], const double m1[], double am[]);

/* Complete integrals K(m), m < 1; E(m); Pi(nu, m), nu < 1, m < 1. */
poinsot_status poinsot_elliptic_k(size_t n, const double m[], const double m1[], double k[]);
poinsot_status poinsot_elliptic_e(size_t n, const double m[], const double m1[], double e[]);
poinsot_status poinsot_elliptic_pi(size_t n, const double nu[], const double m[], const double m1[], double p[]);

/* Incomplete ones F(phi, m), E(phi, m), Pi(nu; phi, m), |phi| <= 1e15; m = 1 (not E) or nu >= 1 up to a quarter turn only. */
poinsot_status poinsot_elliptic_f(size_t n, const double phi[], const double m[], const double m1[], double f[]);
poinsot_status poinsot_elliptic_e_incomplete(size_t n, const double phi[], const double m[], const double m1[], double e[]);
poinsot_status poinsot_elliptic_pi_incomplete(size_t n, const double nu[], const double phi[], const double m[], const double m1[],
                                              double p[]);

/* Carlson's R_F(x, y, z), R_C(x, y), R_D(x, y, z), R_J(x, y, z, p): x, y, z >= 0, at most one of them 0; z > 0 of R_D. y of R_C and
 * p of R_J not 0; where they are negative: the principal value (R_J to a few units of R_F/(y - p), y the middle one of x, y, z). */
poinsot_status poinsot_carlson_rf(size_t n, const double x[], const double y[], const double z[], double r[]);
poinsot_status poinsot_carlson_rc(size_t n, const double x[], const double y[], double r[]);
poinsot_status poinsot_carlson_rd(size_t n, const double x[], const double y[], const double z[], double r[]);
poinsot_status poinsot_carlson_rj(size_t n, const double x[], const double y[], const double z[], const double p[], double r[]);

/* ---- quaternions --------------------------------------------------------------------------------------------------- *
 * Rows [n][4], scalar first, Hamilton's product. A unit quaternion is an attitude, body -> space; q and -q are the same. Where an
 * attitude is read it must be of unit norm to 1e-6. Results that are attitudes are of unit norm. Vectors [n][3], angles in
 * radians, matrices [n][9], row-major, columns the body axes in space. */

/* r = p o q (as rotations: first q, then p), r = conjugate of q, 1/q, q/|q|; zero has none of the last two. */
poinsot_status poinsot_quaternion_multiply(size_t n, const double p[], const double q[], double r[]);
poinsot_status poinsot_quaternion_conjugate(size_t n, const double q[], double r[]);
poinsot_status poinsot_quaternion_inverse(size_t n, const double q[], double r[]);
poinsot_status poinsot_quaternion_normalize(size_t n, const double q[], double r[]);

/* exp and log of quaternions, of any norm: exp((0, v)) turns by 2 |v| about v. log is the principal one, the length of its vector
 * part at most pi; of a negative real number along the first axis. q[0] of exp: at most 709.78. */
poinsot_status poinsot_quaternion_exp(size_t n, const double q[], double r[]);
poinsot_status poinsot_quaternion_log(size_t n, const double q[], double r[]);

/* w = Q v, body to space, and w = Q^T v, space to body. */
poinsot_status poinsot_quaternion_rotate(size_t n, const double q[], const double v[], double w[]);
poinsot_status poinsot_quaternion_rotate_back(size_t n, const double q[], const double v[], double w[]);

/* Rotation matrices. from_matrix takes what is a rotation to 4e-6 (|m^T m - 1|, determinant +1); nearest takes the rotation nearest
 * to any matrix that has one (least squares; any scale). Scalar part not negative. */
poinsot_status poinsot_quaternion_to_matrix(size_t n, const double q[], double m[]);
poinsot_status poinsot_quaternion_from_matrix(size_t n, const double m[], double q[]);
poinsot_status poinsot_quaternion_nearest(size_t n, const double m[], double q[]);

/* Rotation vector: angle times axis; to_: of length at most pi. */
poinsot_status poinsot_quaternion_from_rotation_vector(size_t n, const double v[], double q[]);
poinsot_status poinsot_quaternion_to_rotation_vector(size_t n, const double q[], double v[]);

/* axis [n][3], of any length but 0, angle [n]. to_: unit axes, angles in [0, pi]; the axis of the identity is the first. */
poinsot_status poinsot_quaternion_from_axis_angle(size_t n, const double axis[], const double angle[], double q[]);
poinsot_status poinsot_quaternion_to_axis_angle(size_t n, const double q[], double axis[], double angle[]);

/* Cayley vector: tan(angle/2) times axis. A half-turn has none. */
poinsot_status poinsot_quaternion_from_cayley(size_t n, const double e[], double q[]);
poinsot_status poinsot_quaternion_to_cayley(size_t n, const double q[], double e[]);

/* Euler angles [n][3] about moving axes: q = q_1(a1) o q_2(a2) o q_3(a3), turns about the axes that convention names: "xyz", "xzy",
 * "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"; another: POINSOT_E_METHOD. to_: the first and the third in
 * [-pi, pi], the second in [0, pi] if first and third axis are the same, else in [-pi/2, pi/2]. In gimbal lock the third is 0. */
poinsot_status poinsot_quaternion_from_euler(size_t n, const char *convention, const double angles[], double q[]);
poinsot_status poinsot_quaternion_to_euler(size_t n, const char *convention, const double q[], double angles[]);

/* Constant turn from p (t = 0) to q (t = 1), the shorter way round; t [n], beyond [0, 1] it goes on. */
poinsot_status poinsot_quaternion_slerp(size_t n, const double p[], const double q[], const double t[], double r[]);

/* The smallest turn that takes direction a to direction b, [n][3]. Scalar part not negative. */
poinsot_status poinsot_quaternion_shortest_arc(size_t n, const double a[], const double b[], double q[]);

/* d [n] = min(|p - q|, |p + q|), of any two quaternions; of attitudes half the angle between them, if that is small. */
poinsot_status poinsot_quaternion_distance(size_t n, const double p[], const double q[], double d[]);

/* Attitudes uniform over all rotations: row i is a function of seed and i. */
poinsot_status poinsot_quaternion_random(size_t n, int64_t seed, double q[]);

/* ---- many bodies: the view ----------------------------------------------------------------------------------------- */

/* How the library sees the caller's bodies. Set size = sizeof(poinsot_bodies) and all else to 0, then fill; or let
 * poinsot_bodies_rows or poinsot_bodies_arrays do it. Component j of body i is y[j][i*y_stride], q[j][i*q_stride]. For bindings: with
 * pointers of 8 bytes it is 26 words of 8 bytes without gaps, in this order, 208 bytes (136 in version 0.1). */
typedef struct poinsot_bodies {
  size_t size;             /* sizeof(poinsot_bodies); that of an earlier version is taken, its missing members are 0; so is a longer
                              struct that ends in zeros; another size is POINSOT_E_SIZE */
  size_t n;                /* how many bodies, at most 268435455 */
  double *y[3];            /* components of the momentum variable of the plan */
  double *q[4];            /* components of the attitude, scalar first */
  ptrdiff_t y_stride;      /* from one body to the next, in doubles, at least 1 */
  ptrdiff_t q_stride;
  const int *body_class;   /* [n] number of the class of each body; NULL: all are of the first class. A body of a negative class
                              is skipped: state kept, status OK, energy and momentum 0, no degree of freedom, no source for pairs */
  const int64_t *id;       /* [n] numbers for the random streams of a thermostat; NULL: the position */
  double *carry;           /* [n][7] compensated sums, zero at the start, kept by the caller; NULL: plain sums */
  poinsot_status *status;  /* [n] status of each body, set by each call; or NULL */
  double *y_fourth;        /* the fourth component of a conjugate momentum, same stride; else NULL */
  ptrdiff_t first_class;   /* what body_class calls the first class of the plan: 0, or 1 for hosts that count from 1 */
  /* since 0.2 */
  ptrdiff_t class_stride;  /* of body_class, in ints; 0 = 1 */
  const int *y_at, *q_at;  /* [n] rows of y (and y_fourth) and of q, from 0; NULL: body i is row i. All other arrays go by i */
  size_t rows;             /* how many rows there are: an index not below it, or negative, is POINSOT_E_SIZE; 0: only negative ones */
  const double *scale;     /* [n] moments of body i over those of its class; NULL: 1. Bodies of one shape and any size cost what
                              those of a class do (taylor: more). One that is not positive: that body's POINSOT_E_DOMAIN */
  const double *moments[3]; /* or moments for each body, about the principal axes of its class if it has one; body_class, if given,
                              says on whom effects act. A plan needs no class then. For methods "exact" and "jacobi", splittings
                              without force gradient, effects that need no moments; others: POINSOT_E_METHOD; so is scale beside it */
  ptrdiff_t moments_stride; /* in doubles; 0 = 1 */
} poinsot_bodies;

/* Fill a view of n bodies that stand in rows: momentum [n][3] (or [n][4] for a conjugate momentum), attitude [n][4].
 *   layout    "native", "lammps", "dl_poly", "hoomd": the one that the plan is set to
 *   order     of the quaternion's components: "wxyz" or "xyzw"; NULL is "wxyz"
 * Sets all of *bodies, the members that are not named here to 0. */
poinsot_status poinsot_bodies_rows(poinsot_bodies *bodies, const char *layout, const char *order, size_t n,
                                   double momentum[], double attitude[]);

/* The same for component arrays: momentum[3] (or [4]) and attitude[4] (w, x, y, z) point to arrays of n numbers. */
poinsot_status poinsot_bodies_arrays(poinsot_bodies *bodies, const char *layout, size_t n,
                                     double *const momentum[], double *const attitude[4]);

/* The same, writing `size` bytes, the size of the struct in the caller's version; another is POINSOT_E_SIZE. The two names above
 * are macros of these. (The functions of those names are for programs compiled with version 0.1, and write its 136 bytes.) */
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

/* A plan with method "exact", splitting "srkn6", native layout, torques in the body frame, one thread. */
poinsot_status poinsot_plan_create(poinsot_plan **plan);

/* Free a plan and set the handle to NULL. plan and *plan may be NULL. */
void poinsot_plan_destroy(poinsot_plan **plan);

/* Add a body class; *number is its number, counted from 0 (number may be NULL). Moments stay in the caller's order. With a tensor
 * (row-major, in the caller's body frame) y, q, torques, and every body vector of an effect (centre, dipole, rotor, axis, body
 * torque, three frictions) refer to that frame, not to the principal one. Entries of a diagonal tensor are moments. */
poinsot_status poinsot_plan_add_class(poinsot_plan *plan, const double moments[3], int *number);
poinsot_status poinsot_plan_add_class_tensor(poinsot_plan *plan, const double inertia[9], int *number);

/* The class whose moments are nearest to these, axis by axis, none further than `tolerance` times the largest (of several the one
 * of the lowest number; classes made from tensors are left out); or a new one. For codes that compute moments from coordinates,
 * where 216 molecules of water have 216 different moments: 1e-6 finds one class. Numbers depend on the order of calls: ranks share
 * the list, or use `moments` of poinsot_bodies. POINSOT_E_DOMAIN for a tolerance that is negative or not finite, a plan that is ready. */
poinsot_status poinsot_plan_find_class(poinsot_plan *plan, const double moments[3], double tolerance, int *number);

/* The principal axes of class `number` (from 0) as the columns of the rotation `axes`, row-major: x_given = axes x_principal. The
 * identity for a class made from moments. POINSOT_E_DOMAIN if there is no such class. */
poinsot_status poinsot_plan_class_axes(const poinsot_plan *plan, int number, double axes[9]);

/* Set an option by name:
 *   "method"     a free method;   "splitting"  a splitting: both see above
 *   "layout"     whose momentum variable and frame of torques the arrays have:
 *                "native"   angular momentum, body frame; torques in the body frame
 *                "lammps"   angular momentum, space frame; torques in the space frame
 *                "dl_poly"  angular velocity, body frame; torques in the space frame
 *                "hoomd"    conjugate momentum 2 q o (0, y), four components; torques in the space frame
 *   "momentum"   or one by one: "body-momentum", "space-momentum", "body-velocity", "space-velocity", "conjugate-momentum"
 *   "frame"      of the torques of poinsot_kick and of a callback: "body" or "space"
 *   "threads"    "1" (default) to "4096", or "0": as OpenMP says (OMP_NUM_THREADS, omp_set_num_threads). A team starts where each
 *                thread gets 0.2 ms of work; on a machine whose cores are busy that can cost a slice of the scheduler, 12 to 80 ms,
 *                whatever the work: docs/performance.md has a table
 *   "seed"       of random numbers, a 64-bit integer
 *   "tolerance"  of the splitting "taylor", relative: 1e-15 to 1e-2 ("1e-12")
 *   "physical"   "yes", or "no": classes added from then on may have any moments that are zero or positive, of whatever sum
 *                (where one is zero and the others differ, they become their mean: Euler's equations have no other motion)
 * Options in any case; blanks around a value do not count.
 * POINSOT_E_METHOD for an unknown option or name, POINSOT_E_DOMAIN for a number out of range or a plan that is ready. */
poinsot_status poinsot_plan_set(poinsot_plan *plan, const char *option, const char *value);

/* Add an effect by name, with keys and values as `poinsot effects` shows them, in one text: "centre = 0, 0, 1; weight = 2".
 * Names and keys in any case, numbers apart by blanks or a comma, "3*0" for three zeros, as in scene files. A key that is not
 * named has its default; the key `class` (from 1; 0 is all of them) says on which bodies it acts. Words may stand in quotes.
 * settings may be NULL or "". Wrong keys and values: POINSOT_E_METHOD, _E_SIZE, _E_DOMAIN, and see
 * poinsot_plan_message. */
poinsot_status poinsot_plan_add_effect(poinsot_plan *plan, const char *name, const char *settings);

/* Close the plan: it is checked, and from here on takes no change, so that threads may share it. */
poinsot_status poinsot_plan_ready(poinsot_plan *plan);

/* Why the last call on a plan that was not ready failed, as a sentence: what, where, what would be right; "" if it did not.
 * At most capacity bytes are written, the last a zero. Returns the length of the whole sentence. buffer may be NULL with
 * capacity 0; plan may be NULL. */
size_t poinsot_plan_message(const poinsot_plan *plan, char *buffer, size_t capacity);

/* Would poinsot_drift take these bodies with this plan? The status that it would give before it looks at any number, and the
 * reason as a sentence, as in poinsot_plan_message. */
poinsot_status poinsot_bodies_check(const poinsot_plan *plan, const poinsot_bodies *bodies, char *buffer, size_t capacity);

/* ---- many bodies: what a host calls every step --------------------------------------------------------------------- */

/* Free rotation of all bodies over h by the plan's method, with built-in rotors (gyrostats) as in poinsot_step; no other effect
 * of the plan acts (drag and thermostat: poinsot_dissipate). A rotor whose momentum is a table in time asks for the time, which
 * poinsot_step and poinsot_energy know: POINSOT_E_METHOD here, in poinsot_dissipate, and in poinsot_kick and poinsot_momentum where
 * the layout has velocities. */
poinsot_status poinsot_drift(const poinsot_plan *plan, const poinsot_bodies *bodies, double h);

/* Kick: y += h torque. torque[j][i*stride] is component j for body i, in the frame that the plan says; stride >= 1. */
poinsot_status poinsot_kick(const poinsot_plan *plan, const poinsot_bodies *bodies, double h,
                            const double *const torque[3], ptrdiff_t stride);

/* The flow of the plan's drag and thermostats over h >= 0, nothing else: what a host that runs its own steps calls in the middle of
 * kick h/2, drift h/2, dissipate h, drift h/2, kick h/2, which is "baoab". One set of random numbers for each (seed, id, step); with
 * step = k it is to the bit what step k of poinsot_step does there. It acts on I omega: y, less the momentum of built-in rotors.
 * Right after it the momenta have the temperature; those at the ends of such steps are cold by O(h^2), whereas attitudes are sampled
 * best so. h < 0: POINSOT_E_DOMAIN. A plan without such an effect: POINSOT_OK, nothing changed. */
poinsot_status poinsot_dissipate(const poinsot_plan *plan, const poinsot_bodies *bodies, double h, int64_t step);

/* The host's torques, asked for during poinsot_step. Attitudes come in the host's order and body frames, component j of body i
 * at q[j][i*q_stride]; torques, zero on entry, go to torque[j][i*torque_stride] in the frame that the plan says. The potential
 * energy of all bodies may be left in *energy. Called from the thread that called poinsot_step. Return 0, or something else to
 * stop. It must not throw nor jump out. */
typedef int poinsot_torque(void *context, double t, size_t n, const double *const q[4], ptrdiff_t q_stride,
                           double *const torque[3], ptrdiff_t torque_stride, double *energy);

/* Steps number first to first + steps - 1 of length h by the plan's splitting, with the plan's effects and the callback's
 * torques (NULL: none). Step k starts at t + k h. first also numbers the random numbers: go on with first + steps. How many
 * steps a call makes changes no bit, but with takahashi-imada, whose processor works at both ends of a call and rounds.
 * If the callback stops: POINSOT_E_CALLBACK, and all bodies have the state of before the step that was stopped. */
poinsot_status poinsot_step(const poinsot_plan *plan, const poinsot_bodies *bodies, double t, double h,
                            int64_t first, int64_t steps, poinsot_torque *callback, void *context);

/* Kinetic and potential energy of each body at time t, [n] each, either may be NULL; what two bodies have together is shared
 * between them. A callback's energy is not in it. A body that fails has zeros. */
poinsot_status poinsot_energy(const poinsot_plan *plan, const poinsot_bodies *bodies, double t,
                              double kinetic[], double potential[]);

/* Angular momentum of each body in the space frame, [n][3]. */
poinsot_status poinsot_momentum(const poinsot_plan *plan, const poinsot_bodies *bodies, double momentum[]);

/* Rotational degrees of freedom of all bodies: 3 each, 2 of a linear one; an axis without inertia has none. */
poinsot_status poinsot_degrees_of_freedom(const poinsot_plan *plan, const poinsot_bodies *bodies, size_t *count);

/* ---- for Fortran code with implicit interfaces, also fixed form ---------------------------------------------------- *
 * poinsot_..._f: subroutines for a compiler that adds one underscore (gfortran, ifort, ifx, flang); all arguments by reference,
 * INTEGER of 4 bytes, DOUBLE PRECISION, a handle in an INTEGER*8; a text comes with its length. status comes last. Names are given by their number
 * in the lists above counted from 1: method 1 = exact, 2 = jacobi, 3 = dmv2, 4 = dmv4, ... Classes count from 1. Bodies stand in
 * rows: y(3,n) (y(4,n) for a conjugate momentum), q(4,n); in the routines that end in _a_f each component is an array of its
 * own. class(n): the class of each body; with one class in the plan class(1) = 0 says all, and nothing further is read; with
 * several all 0 is all of class 1, and a 0 among others is POINSOT_E_DOMAIN for that body; -1: the body is skipped.
 * each(n): status of each body. */

/* status = POINSOT_OK, or POINSOT_E_CPU; version as poinsot_version. */
void poinsot_version_f_(int *version, int *status);
/* As poinsot_rotate, with the moments of the one kind of body, by one thread. Methods 1 and 2 (exact, jacobi) make no body of them:
 * the result is that of poinsot_rotate to rounding. */
void poinsot_rotate_f_(const double moments[3], const int *method, const double *h, const int *steps, const int *n,
                       double y[], double q[], int each[], int *status);
/* As poinsot_splitting_flows, of splitting number `splitting`. */
void poinsot_splitting_f_(const int *splitting, const int *capacity, double kick[], double drift[], int *count, int *status);
void poinsot_plan_create_f_(int64_t *plan, int *status);
void poinsot_plan_destroy_f_(int64_t *plan);
void poinsot_plan_add_class_f_(const int64_t *plan, const double moments[3], int *number, int *status);
void poinsot_plan_add_tensor_f_(const int64_t *plan, const double inertia[9], int *number, int *status);
void poinsot_plan_find_class_f_(const int64_t *plan, const double moments[3], const double *tolerance, int *number, int *status);
/* option 1 method, 2 splitting: value their number; 3 layout: 1 native, 2 lammps, 3 dl_poly, 4 hoomd; 4 momentum: 1 to 5 in the
 * order above; 5 frame: 1 body, 2 space; 6 threads; 7 seed; 8 physical: 1 yes, 2 no. */
void poinsot_plan_set_f_(const int64_t *plan, const int *option, const int *value, int *status);
/* U = weight * (Q^T up) . centre, on all classes. */
void poinsot_plan_gravity_f_(const int64_t *plan, const double centre[3], const double *weight, const double up[3], int *status);
/* The option "tolerance". */
void poinsot_plan_tolerance_f_(const int64_t *plan, const double *tolerance, int *status);
/* As poinsot_plan_add_effect; CHARACTER name*(name_length), settings*(settings_length), blanks at their ends do not count. */
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
/* Steps with the plan's effects, from number `first` on. */
void poinsot_step_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *t,
                     const double *h, const int *first, const int *steps, int each[], int *status);
/* The same and the torques of an EXTERNAL subroutine torques(t, n, q, torque, stop) with q(n,4), torque(n,3), INTEGER stop: set
 * stop to something but 0 to stop. */
typedef void poinsot_torque_f(const double *t, const int *n, const double q[], double torque[], int *stop);
void poinsot_step_torque_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *t,
                            const double *h, const int *first, const int *steps, poinsot_torque_f *torques, int each[],
                            int *status);
void poinsot_energy_f_(const int64_t *plan, const int *n, double y[], double q[], const int body_class[], const double *t,
                       double kinetic[], double potential[], int *status);
/* Component arrays, not for a conjugate momentum. */
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
