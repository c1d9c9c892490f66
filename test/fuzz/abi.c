/* Calls of the C interface in any order with any arguments. After each call: the status is one of the list; after a refusal no
 * array has changed; a body that failed has the state of before, one that did not has finite numbers and a unit quaternion. */
#include "fuzz.h"
#include <math.h>
#include <poinsot.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { room = 80, calls_each = 24, plans = 3, kinds = 3 };

static const unsigned char *bytes, *end;
static poinsot_plan *plan[plans];
static poinsot_body *body[kinds];
static double y[4 * room * 4], q[4 * room * 4], carry[7 * room], torque[3 * room], extra[4 * room];
static double y_before[4 * room * 4], q_before[4 * room * 4], carry0[7 * room];
static int each[room], class_of[room];
static int64_t id[room];

static void wrong(const char *what) {
  fprintf(stderr, "abi: %s\n", what);
  abort();
}

static unsigned byte(void) { return bytes < end ? *bytes++ : 0; }
static unsigned below(unsigned n) { return (byte() | byte() << 8) % n; }

static double number(void) {
  static const double strange[] = {0.0, -0.0, 1, -1, 0.5, 1e-300, 1e300, -1e300, 4.9e-324, 2.3e-308, 1.7e308, 1e-16, 1e15, 1e-46, 1e70,
                                   1e150, 1e-150, 3.14159, 1e9, 1e-9};
  union {
    uint64_t bits;
    double value;
  } u;
  int k;
  switch (below(12)) {
  case 0: return NAN;
  case 1: return below(2) ? INFINITY : -INFINITY;
  case 2:
    for (u.bits = 0, k = 0; k < 8; k++) u.bits = u.bits << 8 | byte();
    if ((u.bits & 0x7ff0000000000000ULL) == 0x7ff0000000000000ULL) u.bits |= 0x0008000000000000ULL; /* no signalling NaN */
    return u.value;
  case 3:
  case 4: return strange[below(sizeof strange / sizeof *strange)];
  default: return (below(20001) - 10000.0) / 5000;
  }
}

static const char *word(const char *const *good, unsigned n) {
  static char text[300];
  unsigned i, length;
  switch (below(10)) {
  case 0: return NULL;
  case 1: return "";
  case 2:
    length = below(sizeof text);
    for (i = 0; i < length; i++) text[i] = (char)(1 + byte() % 255);
    text[length] = 0;
    return text;
  default: return good[below(n)];
  }
}

static const char *method(void) {
  size_t i = below(20);
  const char *name = poinsot_method_name(i);
  if ((name == NULL) != (i >= poinsot_method_count())) wrong("method names and their count differ");
  return below(12) ? name : word(&name, 1);
}

static void moments(double m[3]) {
  static const double good[][3] = {{0.6, 0.8, 1}, {1, 0.6, 0.8}, {1, 1, 1}, {0.6, 0.6, 1}, {0.4, 0.6, 1}, {1, 1, 0}, {0, 1, 1},
                                   {1e-46, 1.2e-46, 1.9e-46}, {1e150, 1.5e150, 2e150}, {1, 1, 1e-16}, {1, 1 + 1e-15, 1}};
  unsigned i, k = below(16);
  if (k < sizeof good / sizeof *good) memcpy(m, good[k], sizeof good[k]);
  else
    for (i = 0; i < 3; i++) m[i] = number();
}

static void tensor(double t[9]) {
  unsigned i;
  static const double good[9] = {0.9, 0.1, -0.05, 0.1, 0.7, 0.08, -0.05, 0.08, 1.0};
  memcpy(t, good, sizeof good);
  if (below(3) == 0) {
    i = below(9);
    t[i] = number();
    if (below(2)) t[3 * (i % 3) + i / 3] = t[i];
  } else if (below(3) == 0) {
    double scale = pow(10, (int)below(600) - 300.0);
    for (i = 0; i < 9; i++) t[i] *= scale;
  }
}

static void before(void) {
  memcpy(y_before, y, sizeof y);
  memcpy(q_before, q, sizeof q);
  memcpy(carry0, carry, sizeof carry);
}

static void states(void) {
  unsigned i, j;
  double norm;
  for (i = 0; i < sizeof y / sizeof *y; i++) y[i] = (i * 37 % 101) / 50.0 - 1;
  for (i = 0; i + 3 < sizeof q / sizeof *q; i += 4) {
    for (j = 0; j < 4; j++) q[i + j] = (i * 13 + j * 29) % 17 - 7.5;
    norm = sqrt(q[i] * q[i] + q[i + 1] * q[i + 1] + q[i + 2] * q[i + 2] + q[i + 3] * q[i + 3]);
    for (j = 0; j < 4; j++) q[i + j] /= norm;
  }
  memset(carry, 0, sizeof carry);
  for (i = 0; i < room; i++) class_of[i] = i % 3, id[i] = i;
  for (i = below(6); i > 0; i--) y[below(3 * room)] = number();
  for (i = below(4); i > 0; i--) q[below(4 * room)] = number();
  for (i = 0; i < 3 * room; i++) torque[i] = (i * 7 % 11) / 5.0 - 1;
  for (i = below(3); i > 0; i--) torque[below(3 * room)] = number();
  for (i = below(3); i > 0; i--) class_of[below(room)] = (int)below(65536) - 32768;
  if (below(8) == 0) carry[below(7 * room)] = number();
  before();
}

static void judge_status(poinsot_status s) {
  if (s < 0 || s > POINSOT_E_AXIS_MOMENTUM) wrong("an unknown status");
  if (s != POINSOT_OK && s != POINSOT_E_PARTIAL && s != POINSOT_E_CALLBACK &&
      (memcmp(y, y_before, sizeof y) || memcmp(q, q_before, sizeof q) || memcmp(carry, carry0, sizeof carry)))
    wrong("refused, and an array has changed");
}

/* Bodies in native rows, with a status for each; one of a negative class is skipped, whatever it holds. */
static void judge_rows(size_t n, const int *classes, poinsot_status s) {
  size_t i, j;
  int bad = 0;
  if (s != POINSOT_OK && s != POINSOT_E_PARTIAL) return;
  for (i = 0; i < n; i++) {
    if (each[i] < 0 || each[i] > POINSOT_E_AXIS_MOMENTUM) wrong("an unknown status of a body");
    if (each[i] != POINSOT_OK) {
      bad = 1;
      if (memcmp(y + 3 * i, y_before + 3 * i, 3 * sizeof *y) || memcmp(q + 4 * i, q_before + 4 * i, 4 * sizeof *q))
        wrong("a body failed, and its state has changed");
      continue;
    }
    if (classes && classes[i] < 0) {
      if (memcmp(y + 3 * i, y_before + 3 * i, 3 * sizeof *y) || memcmp(q + 4 * i, q_before + 4 * i, 4 * sizeof *q))
        wrong("a body was skipped, and its state has changed");
      continue;
    }
    for (j = 0; j < 3; j++)
      if (!isfinite(y[3 * i + j])) wrong("a momentum that is not finite, and no status");
    for (j = 0; j < 4; j++)
      if (!isfinite(q[4 * i + j]) || fabs(q[4 * i + j]) > 1.00001) wrong("an attitude that is not a unit quaternion, and no status");
  }
  if (bad != (s == POINSOT_E_PARTIAL)) wrong("the statuses of the bodies are not that of the call");
}

static int push(void *context, double t, size_t n, const double *const at[4], ptrdiff_t q_stride, double *const g[3], ptrdiff_t stride,
                double *energy) {
  size_t i;
  double norm;
  int *left = context;
  (void)t;
  for (i = 0; i < n; i++) {
    norm = at[0][i * q_stride] * at[0][i * q_stride] + at[1][i * q_stride] * at[1][i * q_stride] +
           at[2][i * q_stride] * at[2][i * q_stride] + at[3][i * q_stride] * at[3][i * q_stride];
    if (!(fabs(norm - 1) < 1e-4)) wrong("the callback sees an attitude that is not a unit quaternion");
    g[0][i * stride] = 0.1 * at[1][i * q_stride];
    g[2][i * stride] = -0.2;
  }
  if (below(16) == 0 && n) g[below(3)][below((unsigned)n) * stride] = number();
  *energy = 1;
  return left && --*left < 0;
}

static void one_rotate(void) {
  size_t n = below(5) ? below(room + 1) : (size_t)-1 >> below(36), steps = below(8) ? below(6) : (size_t)-1 >> below(32);
  poinsot_status s;
  const char *name = method();
  double h = below(3) ? number() : 0.05;
  if (n > room) {
    n = n < 268435456 ? room : n;
  } else if (n > 0 && steps > 100 && steps < (size_t)1 << 31) {
    steps = 3;
  }
  before();
  memset(each, -1, sizeof each);
  s = poinsot_rotate(body[below(kinds)], name, h, steps, n, below(20) ? y : NULL, below(20) ? q : NULL, each);
  judge_status(s);
  if (n <= room) judge_rows(n, NULL, s);
}

static void one_set(void) {
  static const char *const keys[] = {"method", "splitting", "layout", "momentum", "frame", "threads", "seed"};
  static const char *const values[] = {"exact",  "jacobi", "dmv10", "three-rotations", "strang", "omelyan4", "mclachlan4", "native", "lammps",
                                       "dl_poly", "hoomd",  "body-momentum", "space-momentum", "body-velocity", "space-velocity",
                                       "conjugate-momentum", "body", "space", "0", "1", "2", "4096", "4097", "-1", "9223372036854775807"};
  judge_status(poinsot_plan_set(plan[below(plans)], word(keys, 7), word(values, sizeof values / sizeof *values)));
}

static void one_effect(void) {
  static const char *const settings[] = {
      "centre = 0, 0, 1; weight = 2", "centre = 0 0 1", "dipole = 1, 0, 0; strength = 0, 0, 1", "gamma = 0.1",
      "friction = 0.1; temperature = 1", "rotor = 0, 0, 1", "stiffness = 1; axis = 0, 0, 1", "gm = 1; radius = 2", "drag = 0.1, 0.2, 0.3",
      "dipole = 1 0 0; coupling = 1; spacing = 1", "times = 0 1; table = 0 0 0 1 1 1", "body = 1 0 0", "mu = 1; radius = 3", "class = 2"};
  char text[400] = "";
  size_t i = below(16);
  const char *name = below(10) ? poinsot_effect_name(i) : word(&settings[0], 1), *what;
  unsigned k = below(3);
  do {
    what = word(settings, sizeof settings / sizeof *settings);
    if (what) strncat(text, what, sizeof text - strlen(text) - 8);
    strcat(text, ";");
  } while (k-- > 0 && strlen(text) < 300);
  if (below(4) == 0) snprintf(text + strlen(text), sizeof text - strlen(text), "weight = %g", number());
  judge_status(poinsot_plan_add_effect(plan[below(plans)], name, below(16) ? text : NULL));
}

static int view_of(poinsot_bodies *v) {
  static const char *const layouts[] = {"native", "lammps", "dl_poly", "hoomd"}, *const orders[] = {"wxyz", "xyzw"};
  static const ptrdiff_t strides[] = {0, -1, PTRDIFF_MIN, (ptrdiff_t)1 << 40, 3, 4, 1, 2};
  double *columns[4] = {y, y + room, y + 2 * room, y + 3 * room}, *attitudes[4] = {q, q + room, q + 2 * room, q + 3 * room};
  size_t n = below(room + 1);
  poinsot_status s;
  int plain = 0, k;
  before();
  if (below(2)) {
    const char *layout = word(layouts, 4);
    s = poinsot_bodies_rows(below(20) ? v : NULL, layout, word(orders, 2), n, below(20) ? y : NULL, below(20) ? q : NULL);
  } else {
    if (below(16) == 0) columns[below(4)] = NULL;
    s = poinsot_bodies_arrays(v, word(layouts, 4), n, below(20) ? columns : NULL, below(20) ? attitudes : NULL);
  }
  judge_status(s);
  if (s != POINSOT_OK || below(3) == 0) {
    memset(v, 0, sizeof *v);
    v->size = sizeof *v;
    v->n = n;
    for (k = 0; k < 3; k++) v->y[k] = y + k;
    for (k = 0; k < 4; k++) v->q[k] = q + k;
    v->y_stride = 3;
    v->q_stride = 4;
    plain = 1;
  }
  v->status = each;
  if (below(2)) v->carry = carry;
  if (below(3) == 0) v->body_class = class_of;
  if (below(3) == 0) v->id = id;
  if (below(8) == 0) v->first_class = (ptrdiff_t)below(5) - 2;
  if (below(10) == 0) { /* spoiled */
    plain = 0;
    switch (below(6)) {
    case 0: v->size = below(2) ? 0 : sizeof *v - 8; break;
    case 1: v->n = (size_t)-1 >> below(30); break; /* more than the library takes */
    case 2: v->y[below(3)] = NULL; break;
    case 3: v->q[below(4)] = NULL; break;
    case 4: v->y_stride = strides[below(8)]; break;
    default: v->q_stride = strides[below(8)]; break;
    }
  }
  return plain;
}

static void one_move(void) {
  poinsot_bodies v;
  poinsot_plan *p = plan[below(plans)];
  poinsot_status s;
  const double *g[3] = {torque, torque + room, torque + 2 * room};
  static const ptrdiff_t strides[] = {1, 1, 1, 1, 0, -1};
  int left = (int)below(12);
  double h = below(3) ? number() : 0.1, t = below(3) ? number() : 0;
  int64_t first = below(3) ? below(100) : (int64_t)((uint64_t)-1 >> below(64)), steps = below(8) ? below(5) : -(int64_t)below(9);
  size_t count;
  char text[120];
  view_of(&v);
  if (below(40) == 0) steps = INT64_MAX; /* too many, unless there are no bodies */
  if (steps > 100 && v.n > 0) first = INT64_MAX;
  before();
  memset(each, -1, sizeof each);
  switch (below(8)) {
  case 0: s = poinsot_drift(p, &v, h); break;
  case 1:
    if (below(16) == 0) g[below(3)] = NULL;
    s = poinsot_kick(p, &v, h, below(20) ? g : NULL, strides[below(6)]);
    break;
  case 2: s = poinsot_step(p, &v, t, h, first, steps, NULL, NULL); break;
  case 3:
  case 4: s = poinsot_step(p, &v, t, h, first, steps, push, below(2) ? &left : NULL); break;
  case 5: s = poinsot_energy(p, &v, t, below(8) ? extra : NULL, below(8) ? extra + room : NULL); break;
  case 6: s = poinsot_momentum(p, &v, below(8) ? extra : NULL); break;
  default:
    s = poinsot_bodies_check(p, &v, text, sizeof text);
    judge_status(s);
    s = poinsot_degrees_of_freedom(p, &v, below(8) ? &count : NULL);
  }
  judge_status(s);
}

/* One plan that works, in native rows: here the arrays can be judged. */
static void one_native(void) {
  poinsot_plan *p = NULL;
  poinsot_bodies v;
  poinsot_status s;
  double m[3];
  size_t n = below(room + 1);
  int left = (int)below(9), wants = (int)below(4), k;
  const double *const g[3] = {torque, torque + room, torque + 2 * room};
  if (poinsot_plan_create(&p) != POINSOT_OK) wrong("no plan");
  for (k = 0; k < 3; k++) {
    moments(m);
    if (poinsot_plan_add_class(p, m, NULL) != POINSOT_OK) poinsot_plan_add_class(p, (double[]){0.6, 0.8, 1}, NULL);
  }
  poinsot_plan_set(p, "method", method());
  if (below(2)) poinsot_plan_set(p, "splitting", poinsot_splitting_name(below(12)));
  if (below(2)) {
    char text[200];
    snprintf(text, sizeof text, "centre = 0, 0.1, 1; weight = %.17g", below(2) ? number() : 1.0);
    poinsot_plan_add_effect(p, "gravity", text);
  }
  if (below(3) == 0) poinsot_plan_add_effect(p, "langevin", "friction = 0.1; temperature = 1");
  if (poinsot_plan_ready(p) == POINSOT_OK) {
    if (poinsot_bodies_rows(&v, "native", NULL, n, y, q) != POINSOT_OK) wrong("rows");
    v.status = each;
    if (below(2)) v.body_class = class_of;
    if (below(2)) v.carry = carry;
    before();
    memset(each, -1, sizeof each);
    if (wants == 0) s = poinsot_drift(p, &v, number());
    else if (wants == 1) s = poinsot_step(p, &v, number(), number(), below(100), below(4), NULL, NULL);
    else if (wants == 2) s = poinsot_step(p, &v, number(), number(), below(100), below(4), push, &left);
    else s = poinsot_kick(p, &v, number(), g, 1);
    judge_status(s);
    judge_rows(n, v.body_class, s);
  }
  poinsot_plan_destroy(&p);
}

static void one_other(void) {
  double m[9], axes[9], u[5], k[5], k1[5], sn[5], cn[5], dn[5];
  char text[64];
  int i, number_of = -7;
  poinsot_status s;
  before();
  switch (below(10)) {
  case 0: poinsot_plan_destroy(below(8) ? &plan[below(plans)] : NULL); break;
  case 1:
    i = (int)below(plans);
    poinsot_plan_destroy(&plan[i]);
    judge_status(poinsot_plan_create(&plan[i]));
    break;
  case 2:
    moments(m);
    judge_status(poinsot_plan_add_class(plan[below(plans)], below(20) ? m : NULL, below(2) ? &number_of : NULL));
    break;
  case 3:
    tensor(m);
    judge_status(poinsot_plan_add_class_tensor(plan[below(plans)], below(20) ? m : NULL, below(2) ? &number_of : NULL));
    break;
  case 4: judge_status(poinsot_plan_ready(plan[below(plans)])); break;
  case 5: poinsot_plan_message(plan[below(plans)], below(2) ? text : NULL, below(2) ? 0 : below(sizeof text + 1)); break;
  case 6:
    i = (int)below(kinds);
    poinsot_body_destroy(&body[i]);
    moments(m);
    s = poinsot_body_create(below(20) ? m : NULL, &body[i]);
    judge_status(s);
    if ((s == POINSOT_OK) != (body[i] != NULL)) wrong("a handle and a failure, or none and none");
    break;
  case 7:
    i = (int)below(kinds);
    poinsot_body_destroy(&body[i]);
    tensor(m);
    s = poinsot_body_create_tensor(m, &body[i], below(2) ? axes : NULL);
    judge_status(s);
    if ((s == POINSOT_OK) != (body[i] != NULL)) wrong("a handle and a failure, or none and none");
    break;
  case 8:
    for (i = 0; i < 5; i++) u[i] = number(), k[i] = number(), k1[i] = below(2) ? 1 - k[i] : number();
    s = poinsot_jacobi(below(8) ? 5 : (size_t)-1, u, k, below(2) ? k1 : NULL, sn, cn, dn);
    judge_status(s);
    if (s == POINSOT_OK)
      for (i = 0; i < 5; i++)
        if (!(fabs(sn[i]) <= 1 + 1e-15 && fabs(cn[i]) <= 1 + 1e-15 && fabs(dn[i]) <= 1 + 1e-15)) wrong("sn, cn, dn out of range");
    break;
  default:
    poinsot_status_text((int)below(65536) - 32768);
    poinsot_has_feature(method());
    poinsot_splitting_name((size_t)-1 >> below(64));
  }
}

int fuzz_abi(const unsigned char *input, size_t length) {
  int k;
  bytes = input;
  end = input + length;
  states();
  for (k = 0; k < plans; k++)
    if (poinsot_plan_create(&plan[k]) != POINSOT_OK) wrong("no plan");
  poinsot_plan_add_class(plan[0], (double[]){0.6, 0.8, 1}, NULL);
  poinsot_plan_add_class(plan[0], (double[]){1, 1, 0}, NULL);
  poinsot_plan_add_class(plan[1], (double[]){0.6, 0.8, 1}, NULL);
  if (poinsot_body_create((double[]){0.8, 0.6, 1}, &body[0]) != POINSOT_OK) wrong("no body");
  for (k = 0; k < calls_each && bytes < end; k++) {
    if (k == calls_each / 3) poinsot_plan_ready(plan[0]);
    before();
    switch (below(8)) {
    case 0: one_rotate(); break;
    case 1: one_set(); break;
    case 2: one_effect(); break;
    case 3:
    case 4: one_move(); break;
    case 5: one_native(); break;
    case 6: states(); break;
    default: one_other();
    }
  }
  for (k = 0; k < plans; k++) poinsot_plan_destroy(&plan[k]);
  for (k = 0; k < kinds; k++) poinsot_body_destroy(&body[k]);
  return 0;
}
