/* Quaternions, elliptic functions and inertia from C: against 30 digits (test/data/functions.csv, elliptic.csv), the same bits alone
 * and in an array, in place, beside elements without an answer; round trips; degenerate cases; with traps on, in other rounding
 * modes, with subnormal numbers flushed to zero.
 *
 *   functions [FOLDER]       FOLDER holds the tables (test/data) */
#define _GNU_SOURCE
#include <fenv.h>
#include <math.h>
#include <poinsot.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if defined __SSE2__
#include <xmmintrin.h>
#endif

static const double eps = 2.220446049250313e-16, pi = 3.141592653589793;
static int checks, failures;

static void check(int good, const char *what, int line) {
  checks++;
  if (good) return;
  failures++;
  if (failures < 40) fprintf(stderr, "functions.c:%d: %s\n", line, what);
}
#define CHECK(condition) check(condition, #condition, __LINE__)

static int same(const double a[], const double b[], size_t n) { return memcmp(a, b, n * sizeof *a) == 0; }

/* ---- a table of functions ------------------------------------------------------------------------------------------ */

static const char *const conventions[] = {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"};

typedef double *const arrays[];
#define I(k) ((const double *)in[k])
#define WRAP1(name) \
  static poinsot_status call_##name(size_t n, arrays in, arrays out) { return poinsot_##name(n, I(0), out[0]); }
#define WRAP2(name) \
  static poinsot_status call_##name(size_t n, arrays in, arrays out) { return poinsot_##name(n, I(0), I(1), out[0]); }
#define WRAP3(name) \
  static poinsot_status call_##name(size_t n, arrays in, arrays out) { return poinsot_##name(n, I(0), I(1), I(2), out[0]); }
#define WRAP4(name) \
  static poinsot_status call_##name(size_t n, arrays in, arrays out) { return poinsot_##name(n, I(0), I(1), I(2), I(3), out[0]); }
WRAP2(quaternion_multiply)
WRAP1(quaternion_inverse)
WRAP1(quaternion_normalize)
WRAP1(quaternion_exp)
WRAP1(quaternion_log)
WRAP2(quaternion_rotate)
WRAP2(quaternion_rotate_back)
WRAP1(quaternion_to_matrix)
WRAP1(quaternion_nearest)
WRAP1(quaternion_from_rotation_vector)
WRAP1(quaternion_to_rotation_vector)
WRAP2(quaternion_from_axis_angle)
WRAP1(quaternion_from_cayley)
WRAP1(quaternion_to_cayley)
WRAP3(quaternion_slerp)
WRAP2(quaternion_shortest_arc)
WRAP2(quaternion_distance)
WRAP2(elliptic_k)
WRAP2(elliptic_e)
WRAP3(elliptic_pi)
WRAP3(elliptic_f)
WRAP3(elliptic_e_incomplete)
WRAP4(elliptic_pi_incomplete)
WRAP3(jacobi_am)
WRAP3(carlson_rf)
WRAP2(carlson_rc)
WRAP3(carlson_rd)
WRAP4(carlson_rj)
static poinsot_status call_to_axis_angle(size_t n, arrays in, arrays out) {
  return poinsot_quaternion_to_axis_angle(n, I(0), out[0], out[1]);
}
static poinsot_status call_jacobi(size_t n, arrays in, arrays out) {
  return poinsot_jacobi(n, I(0), I(1), I(2), out[0], out[1], out[2]);
}
/* The first argument of the table is the number of the convention. */
static poinsot_status call_from_euler(size_t n, arrays in, arrays out) {
  return poinsot_quaternion_from_euler(n, conventions[n ? (int)I(0)[0] : 0], I(1), out[0]);
}
static poinsot_status call_to_euler(size_t n, arrays in, arrays out) {
  return poinsot_quaternion_to_euler(n, conventions[n ? (int)I(0)[0] : 0], I(1), out[0]);
}

/* How far a result may be off: `bound` units of eps, of the largest component, times what the rounding of arguments costs. */
enum measure { plain, attitude, by_argument, by_vector, by_rotation_vector, by_angle, by_arc };
typedef struct {
  const char *name;
  int in[5], out[4]; /* widths of rows, 0 ends */
  double bound;
  enum measure measure;
  poinsot_status (*call)(size_t, arrays, arrays);
  int alone; /* not as an array */
} function;

static const function functions[] = {
    {"multiply", {4, 4}, {4}, 2, plain, call_quaternion_multiply, 0},
    {"inverse", {4}, {4}, 2, plain, call_quaternion_inverse, 0},
    {"normalize", {4}, {4}, 2, plain, call_quaternion_normalize, 0},
    {"exp", {4}, {4}, 2, by_vector, call_quaternion_exp, 0},
    {"log", {4}, {4}, 2, plain, call_quaternion_log, 0},
    {"rotate", {4, 3}, {3}, 4, plain, call_quaternion_rotate, 0},
    {"rotate_back", {4, 3}, {3}, 4, plain, call_quaternion_rotate_back, 0},
    {"to_matrix", {4}, {9}, 2, plain, call_quaternion_to_matrix, 0},
    {"nearest", {9}, {4}, 20, attitude, call_quaternion_nearest, 0},
    {"from_rotation_vector", {3}, {4}, 2, by_rotation_vector, call_quaternion_from_rotation_vector, 0},
    {"to_rotation_vector", {4}, {3}, 3, plain, call_quaternion_to_rotation_vector, 0},
    {"from_axis_angle", {3, 1}, {4}, 2, plain, call_quaternion_from_axis_angle, 0},
    {"to_axis_angle", {4}, {3, 1}, 2, plain, call_to_axis_angle, 0},
    {"from_cayley", {3}, {4}, 2, plain, call_quaternion_from_cayley, 0},
    {"to_cayley", {4}, {3}, 2, plain, call_quaternion_to_cayley, 0},
    {"from_euler", {1, 3}, {4}, 3, plain, call_from_euler, 1},
    {"to_euler", {1, 4}, {3}, 40, plain, call_to_euler, 1},
    {"slerp", {4, 4, 1}, {4}, 8, by_angle, call_quaternion_slerp, 0},
    {"shortest_arc", {3, 3}, {4}, 4, by_arc, call_quaternion_shortest_arc, 0},
    {"distance", {4, 4}, {1}, 2, plain, call_quaternion_distance, 0},
    {"elliptic_k", {1, 1}, {1}, 3, plain, call_elliptic_k, 0},
    {"elliptic_e", {1, 1}, {1}, 3, plain, call_elliptic_e, 0},
    {"elliptic_pi", {1, 1, 1}, {1}, 6, plain, call_elliptic_pi, 0},
    {"elliptic_f", {1, 1, 1}, {1}, 4, plain, call_elliptic_f, 0},
    {"elliptic_e_incomplete", {1, 1, 1}, {1}, 4, plain, call_elliptic_e_incomplete, 0},
    {"elliptic_pi_incomplete", {1, 1, 1, 1}, {1}, 10, plain, call_elliptic_pi_incomplete, 0},
    {"jacobi", {1, 1, 1}, {1, 1, 1}, 5, by_argument, call_jacobi, 0},
    {"jacobi_am", {1, 1, 1}, {1}, 5, plain, call_jacobi_am, 0},
    {"carlson_rf", {1, 1, 1}, {1}, 6, plain, call_carlson_rf, 0},
    {"carlson_rc", {1, 1}, {1}, 6, plain, call_carlson_rc, 0},
    {"carlson_rd", {1, 1, 1}, {1}, 6, plain, call_carlson_rd, 0},
    {"carlson_rj", {1, 1, 1, 1}, {1}, 60, plain, call_carlson_rj, 0},
};
enum { function_count = sizeof functions / sizeof *functions, most_rows = 400, widest = 12 };

static int total(const int widths[]) {
  int n = 0;
  for (; *widths; widths++) n += *widths;
  return n;
}

/* ---- tables of 30 digits ------------------------------------------------------------------------------------------- */

/* Rows of one function: arguments array by array, as a call wants them, and results. */
typedef struct {
  size_t n;
  double in[5][most_rows * 9];
  long double right[most_rows][widest];
} table;

static void add_row(table *t, const function *f, const double in[], const long double right[]) {
  int a, k, width;
  if (t->n == most_rows) return;
  for (a = 0; (width = f->in[a]); a++)
    for (k = 0; k < width; k++) t->in[a][t->n * (size_t)width + (size_t)k] = *in++;
  for (k = 0; k < total(f->out); k++) t->right[t->n][k] = right[k];
  t->n++;
}

/* A line of functions.csv: name,inputs,results,numbers. */
static void take_line(char *line, const char *name, const function *f, table *t) {
  double in[32];
  long double right[32];
  int k, inputs, results;
  char *word = strtok(line, ",");
  if (!word || strcmp(word, name) != 0) return;
  inputs = atoi(strtok(NULL, ",")), results = atoi(strtok(NULL, ","));
  if (inputs != total(f->in) || results != total(f->out)) {
    CHECK(!"as many numbers as the function has");
    return;
  }
  for (k = 0; k < inputs; k++) in[k] = strtod(strtok(NULL, ","), NULL);
  for (k = 0; k < results; k++) right[k] = strtold(strtok(NULL, ",\n"), NULL);
  add_row(t, f, in, right);
}

/* A line of elliptic.csv: kind,a1,a2,a3,a4,r1,r2,r3,r4, and which of them a function has. */
static void take_elliptic(char *line, const function *f, table *t) {
  static const struct {
    const char *kind, *name;
    int in[4], out[3];
  } meaning[] = {{"jacobi", "jacobi", {1, 2, 3}, {1, 2, 3}},        {"jacobi", "jacobi_am", {1, 2, 3}, {4}},
                 {"rf", "carlson_rf", {1, 2, 3}, {1}},              {"rc", "carlson_rc", {1, 2}, {1}},
                 {"rd", "carlson_rd", {1, 2, 3}, {1}},              {"rj", "carlson_rj", {1, 2, 3, 4}, {1}},
                 {"complete", "elliptic_k", {2, 3}, {1}},           {"complete", "elliptic_e", {2, 3}, {2}},
                 {"complete", "elliptic_pi", {1, 2, 3}, {3}},       {"legendre", "elliptic_f", {2, 3, 4}, {1}},
                 {"legendre", "elliptic_e_incomplete", {2, 3, 4}, {2}}, {"legendre", "elliptic_pi_incomplete", {1, 2, 3, 4}, {3}}};
  double a[4], in[4];
  long double r[4], right[4];
  size_t i;
  int k;
  char *kind = strtok(line, ",");
  if (!kind) return;
  for (k = 0; k < 4; k++) {
    const char *word = strtok(NULL, ",");
    a[k] = word ? strtod(word, NULL) : 0;
  }
  for (k = 0; k < 4; k++) {
    const char *word = strtok(NULL, ",\n");
    r[k] = word ? strtold(word, NULL) : 0;
  }
  for (i = 0; i < sizeof meaning / sizeof *meaning; i++) {
    if (strcmp(meaning[i].kind, kind) != 0 || strcmp(meaning[i].name, f->name) != 0) continue;
    for (k = 0; k < 4; k++) in[k] = meaning[i].in[k] ? a[meaning[i].in[k] - 1] : 0;
    for (k = 0; k < 3; k++) right[k] = meaning[i].out[k] ? r[meaning[i].out[k] - 1] : 0;
    add_row(t, f, in, right);
  }
}

static void read_table(const char *folder, const char *file, int elliptic, const char *name, const function *f, table *t) {
  char path[1024], line[2048];
  FILE *in;
  snprintf(path, sizeof path, "%s/%s", folder, file);
  in = fopen(path, "r");
  if (in == NULL) {
    CHECK(!"a table could be opened");
    return;
  }
  while (fgets(line, sizeof line, in)) elliptic ? take_elliptic(line, f, t) : take_line(line, name, f, t);
  fclose(in);
}

/* ---- how far a result is off --------------------------------------------------------------------------------------- */

static double length(const double v[], int n) {
  double sum = 0;
  int k;
  for (k = 0; k < n; k++) sum = hypot(sum, v[k]);
  return sum;
}

/* What an eps of the arguments is worth in the result. */
static double conditioning(const function *f, const table *t, size_t i) {
  switch (f->measure) {
  case by_argument: return fmax(1, fabs(t->in[0][i]) / 50);
  case by_vector: return 1 + length(t->in[0] + 4 * i + 1, 3);
  case by_rotation_vector: return 1 + length(t->in[0] + 3 * i, 3);
  case by_angle: return 1 + fabs(t->in[2][i]) * 2 * asin(fmin(1, length((double[]){t->in[0][4 * i] - t->in[1][4 * i],
                   t->in[0][4 * i + 1] - t->in[1][4 * i + 1], t->in[0][4 * i + 2] - t->in[1][4 * i + 2],
                   t->in[0][4 * i + 3] - t->in[1][4 * i + 3]}, 4) / 2));
  case by_arc: return 1 + 1 / fabs((double)t->right[i][0]);
  default: return 1;
  }
}

/* Units of eps times the conditioning. */
static double error_of(const function *f, const table *t, size_t i, double *const out[]) {
  long double largest = 0, off[2] = {0, 0};
  int a, k, j = 0, width;
  for (a = 0; (width = f->out[a]); a++)
    for (k = 0; k < width; k++, j++) {
      long double x = out[a][i * (size_t)width + (size_t)k], right = t->right[i][j];
      if (isnan((double)x)) return INFINITY;
      largest = fmaxl(largest, fabsl(right));
      off[0] = fmaxl(off[0], fabsl(x - right));
      off[1] = fmaxl(off[1], fabsl(x + right));
    }
  if (f->measure == attitude && off[1] < off[0]) off[0] = off[1];
  if (largest < 1e-307L) largest = 1e-307L;
  return (double)(off[0] / largest) / eps / conditioning(f, t, i);
}

/* ---- every function over its table --------------------------------------------------------------------------------- */

static table data;
static double results[4][most_rows * 9], again[4][most_rows * 9];
static double *const out[4] = {results[0], results[1], results[2], results[3]};
static double *const out2[4] = {again[0], again[1], again[2], again[3]};

static void call_all(const function *f, double *const where[]) {
  size_t i;
  int a;
  double *const in[5] = {data.in[0], data.in[1], data.in[2], data.in[3], data.in[4]};
  if (!f->alone) {
    CHECK(f->call(data.n, in, where) == POINSOT_OK);
    return;
  }
  for (i = 0; i < data.n; i++) {
    double *one[5] = {NULL, NULL, NULL, NULL, NULL}, *to[4] = {NULL, NULL, NULL, NULL};
    for (a = 0; f->in[a]; a++) one[a] = data.in[a] + i * (size_t)f->in[a];
    for (a = 0; f->out[a]; a++) to[a] = where[a] + i * (size_t)f->out[a];
    CHECK(f->call(1, one, to) == POINSOT_OK);
  }
}

static int same_results(const function *f) {
  int a, good = 1;
  for (a = 0; f->out[a]; a++) good = good && same(results[a], again[a], data.n * (size_t)f->out[a]);
  return good;
}

static void against_digits(const function *f, double slack) {
  double worst = 0, bound = f->bound * slack;
  size_t i, which = 0;
  for (i = 0; i < data.n; i++) {
    double e = error_of(f, &data, i, out);
    if (e > worst) worst = e, which = i;
  }
  checks++;
  if (getenv("VERBOSE")) printf("%-24s %4zu rows, %.2f of %.1f\n", f->name, data.n, worst, bound);
  if (worst <= bound) return;
  failures++;
  fprintf(stderr, "%s, row %zu: off by %.3g units, %.3g allowed\n", f->name, which, worst, bound);
}

/* The bits of an element alone, and of one that has moved. */
static void places(const function *f) {
  size_t i;
  int a;
  for (i = 0; i < data.n; i++) {
    double *one[5] = {NULL, NULL, NULL, NULL, NULL}, *to[4] = {NULL, NULL, NULL, NULL};
    for (a = 0; f->in[a]; a++) one[a] = data.in[a] + i * (size_t)f->in[a];
    for (a = 0; f->out[a]; a++) to[a] = again[a] + i * (size_t)f->out[a];
    f->call(1, one, to);
  }
  CHECK(same_results(f));
  if (f->alone || data.n < 6) return;
  for (i = 1; i < 6; i++) {
    double *rest[5] = {NULL, NULL, NULL, NULL, NULL}, *to[4] = {NULL, NULL, NULL, NULL};
    for (a = 0; f->in[a]; a++) rest[a] = data.in[a] + i * (size_t)f->in[a];
    for (a = 0; f->out[a]; a++) to[a] = again[a] + i * (size_t)f->out[a];
    f->call(data.n - i, rest, to);
    CHECK(same_results(f));
  }
}

/* A result in the place of each argument of its shape. */
static void in_place(const function *f) {
  static double copy[5][most_rows * 9];
  double *in[5] = {copy[0], copy[1], copy[2], copy[3], copy[4]}, *to[4] = {again[0], again[1], again[2], again[3]};
  int a, b;
  if (f->alone) return;
  for (a = 0; f->in[a]; a++)
    for (b = 0; f->out[b]; b++) {
      if (f->in[a] != f->out[b]) continue;
      memcpy(copy, data.in, sizeof copy);
      to[b] = copy[a];
      CHECK(f->call(data.n, in, to) == POINSOT_OK);
      CHECK(same(copy[a], results[b], data.n * (size_t)f->out[b]));
      to[b] = again[b];
    }
}

/* A NaN or an infinity in an argument: NaN there, POINSOT_E_DOMAIN, and the others as before. */
static void no_number(const function *f) {
  double *const in[5] = {data.in[0], data.in[1], data.in[2], data.in[3], data.in[4]};
  const double bad[3] = {NAN, INFINITY, -INFINITY};
  size_t at = data.n / 2, i;
  int a, b, k, j;
  if (f->alone) return;
  for (a = 0; f->in[a]; a++)
    for (k = 0; k < f->in[a]; k++)
      for (b = 0; b < 3; b++) {
        double *place = &data.in[a][at * (size_t)f->in[a] + (size_t)k], keep = *place;
        *place = bad[b];
        CHECK(f->call(data.n, in, out2) == POINSOT_E_DOMAIN);
        *place = keep;
        for (j = 0; f->out[j]; j++) {
          size_t width = (size_t)f->out[j];
          for (i = 0; i < width; i++) CHECK(isnan(again[j][at * width + i]));
          memcpy(again[j] + at * width, results[j] + at * width, width * sizeof(double));
        }
        CHECK(same_results(f));
      }
}

/* What is NULL is answered, and of nothing nothing is asked. */
static void nothing_there(const function *f) {
  double *in[5] = {data.in[0], data.in[1], data.in[2], data.in[3], data.in[4]}, *to[4] = {again[0], again[1], again[2], again[3]};
  double *none[5] = {NULL, NULL, NULL, NULL, NULL};
  int a, optional = f->in[1] == 1 && (strncmp(f->name, "elliptic", 8) == 0 || strncmp(f->name, "jacobi", 6) == 0);
  CHECK(f->call(0, none, none) == POINSOT_OK);
  if (f->alone) return;
  CHECK(f->call((size_t)-1, in, to) == POINSOT_E_SIZE);
  for (a = 0; f->in[a]; a++) {
    int last = optional && !f->in[a + 1]; /* m1 */
    double *keep = in[a];
    in[a] = NULL;
    CHECK((f->call(1, in, to) == POINSOT_E_NULL) == !last);
    in[a] = keep;
  }
  for (a = 0; f->out[a]; a++) {
    double *keep = to[a];
    to[a] = NULL;
    CHECK(f->call(1, in, to) == POINSOT_E_NULL);
    to[a] = keep;
  }
}

static void load(const char *folder, const function *f) {
  data.n = 0;
  read_table(folder, "functions.csv", 0, f->name, f, &data);
  read_table(folder, "elliptic.csv", 1, f->name, f, &data);
  CHECK(data.n >= 5);
}

static int rounds_by_trick(const function *f) { return strncmp(f->name, "jacobi", 6) == 0; }

static void directed_rounding(const function *f) {
  const int modes[3] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
  double *const in[5] = {data.in[0], data.in[1], data.in[2], data.in[3], data.in[4]};
  size_t i;
  int k, a;
  for (k = 0; k < 3; k++) {
    poinsot_status s;
    if (rounds_by_trick(f)) {
      fesetround(modes[k]);
      s = f->call(data.n, in, out);
      fesetround(FE_TONEAREST);
      CHECK(s == POINSOT_E_DOMAIN);
      for (a = 0; f->out[a]; a++)
        for (i = 0; i < data.n; i++) CHECK(isnan(results[a][i]));
    } else {
      fesetround(modes[k]);
      call_all(f, out);
      fesetround(FE_TONEAREST);
      against_digits(f, 8);
    }
  }
}

/* Of rows with numbers that are flushed nothing is asked: the results themselves take the place of the right ones. */
static void drop_subnormal(const function *f) {
  size_t i;
  int a, k, j, width;
  for (i = 0; i < data.n; i++) {
    int subnormal = 0;
    for (a = 0; (width = f->in[a]); a++)
      for (k = 0; k < width; k++) subnormal |= fpclassify(data.in[a][i * (size_t)width + (size_t)k]) == FP_SUBNORMAL;
    for (j = 0; j < total(f->out); j++) subnormal |= data.right[i][j] != 0 && fabsl(data.right[i][j]) < 1e-290L;
    for (j = 0, a = 0; subnormal && (width = f->out[a]); a++)
      for (k = 0; k < width; k++, j++) {
        double *x = &out[a][i * (size_t)width + (size_t)k];
        if (isnan(*x)) *x = 0;
        data.right[i][j] = *x;
      }
  }
}

static void flushed(const function *f) {
#if defined __SSE2__
  double *const in[5] = {data.in[0], data.in[1], data.in[2], data.in[3], data.in[4]};
  unsigned mode = _mm_getcsr();
  _mm_setcsr(mode | 0x8040); /* subnormal results and arguments are zero */
  f->alone ? call_all(f, out) : (void)f->call(data.n, in, out);
  _mm_setcsr(mode);
  drop_subnormal(f);
  against_digits(f, 1);
#else
  (void)f;
#endif
}

static void over_tables(const char *folder) {
  size_t k;
  for (k = 0; k < function_count; k++) {
    const function *f = functions + k;
    load(folder, f);
    call_all(f, out);
    against_digits(f, 1);
    places(f);
    in_place(f);
    no_number(f);
    nothing_there(f);
    directed_rounding(f);
  }
}

/* ---- round trips and degenerate cases ------------------------------------------------------------------------------ */

enum { many = 2000 };
static double qa[many][4], qb[many][4], v[many][3], u[many][3], m[many][9], x[many], apart[many];

static double largest(const double a[], size_t n) {
  double most = 0;
  size_t i;
  for (i = 0; i < n; i++) most = isnan(a[i]) ? INFINITY : fmax(most, fabs(a[i]));
  return most;
}

static double difference(const double a[], const double b[], size_t n) {
  double most = 0;
  size_t i;
  for (i = 0; i < n; i++) most = fmax(most, fabs(a[i] - b[i]));
  return most;
}

static double distance(void) {
  CHECK(poinsot_quaternion_distance(many, qa[0], qb[0], apart) == POINSOT_OK);
  return largest(apart, many) / eps;
}

static void round_trips(void) {
  int c, i;
  double worst;
  CHECK(poinsot_quaternion_random(many, 2024, qa[0]) == POINSOT_OK);
  CHECK(poinsot_quaternion_random(many / 2, 2024, qb[0]) == POINSOT_OK && same(qa[0], qb[0], 4 * many / 2));
  CHECK(poinsot_quaternion_random(many, 2025, qb[0]) == POINSOT_OK && distance() > 0.1 / eps);
  CHECK(poinsot_quaternion_to_matrix(many, qa[0], m[0]) == POINSOT_OK);
  CHECK(poinsot_quaternion_from_matrix(many, m[0], qb[0]) == POINSOT_OK && distance() < 4);
  CHECK(poinsot_quaternion_nearest(many, m[0], qb[0]) == POINSOT_OK && distance() < 10);
  CHECK(poinsot_quaternion_to_rotation_vector(many, qa[0], v[0]) == POINSOT_OK);
  CHECK(poinsot_quaternion_from_rotation_vector(many, v[0], qb[0]) == POINSOT_OK && distance() < 4);
  CHECK(poinsot_quaternion_to_axis_angle(many, qa[0], v[0], x) == POINSOT_OK);
  CHECK(poinsot_quaternion_from_axis_angle(many, v[0], x, qb[0]) == POINSOT_OK && distance() < 4);
  CHECK(poinsot_quaternion_log(many, qa[0], qb[0]) == POINSOT_OK);
  CHECK(poinsot_quaternion_exp(many, qb[0], qb[0]) == POINSOT_OK && distance() < 4);
  CHECK(poinsot_quaternion_to_cayley(many, qa[0], v[0]) == POINSOT_OK);
  CHECK(poinsot_quaternion_from_cayley(many, v[0], qb[0]) == POINSOT_OK && distance() < 4);
  for (c = 0; c < 12; c++) {
    CHECK(poinsot_quaternion_to_euler(many, conventions[c], qa[0], v[0]) == POINSOT_OK);
    CHECK(poinsot_quaternion_from_euler(many, conventions[c], v[0], qb[0]) == POINSOT_OK && distance() < 8);
    for (worst = 0, i = 0; i < many; i++) /* in gimbal lock, or 1e-9 off it */
      v[i][1] = c < 6 ? (i % 2 ? pi / 2 : -pi / 2) : (i % 2 ? pi : 0), v[i][1] += i % 3 == 2 ? 1e-9 : 0;
    CHECK(poinsot_quaternion_from_euler(many, conventions[c], v[0], qa[0]) == POINSOT_OK);
    CHECK(poinsot_quaternion_to_euler(many, conventions[c], qa[0], v[0]) == POINSOT_OK);
    for (i = 0; i < many; i++)
      if (i % 3 != 2) worst = fmax(worst, fabs(v[i][2]));
    CHECK(worst == 0);
    CHECK(poinsot_quaternion_from_euler(many, conventions[c], v[0], qb[0]) == POINSOT_OK && distance() < 8);
    CHECK(poinsot_quaternion_random(many, 2024, qa[0]) == POINSOT_OK);
  }
  for (i = 0; i < many; i++) v[i][0] = qa[i][1], v[i][1] = qa[i][2], v[i][2] = 1e3 * qa[i][3];
  CHECK(poinsot_quaternion_rotate(many, qa[0], v[0], u[0]) == POINSOT_OK);
  CHECK(poinsot_quaternion_shortest_arc(many, v[0], u[0], qb[0]) == POINSOT_OK);
  CHECK(poinsot_quaternion_rotate(many, qb[0], v[0], m[0]) == POINSOT_OK);
  CHECK(difference(m[0], u[0], 3 * many) < 1e-12);
  CHECK(poinsot_quaternion_rotate_back(many, qa[0], u[0], u[0]) == POINSOT_OK);
  CHECK(difference(v[0], u[0], 3 * many) < 1e-12);
  CHECK(poinsot_quaternion_inverse(many, qa[0], qb[0]) == POINSOT_OK);
  CHECK(poinsot_quaternion_multiply(many, qa[0], qb[0], qb[0]) == POINSOT_OK);
  for (i = 0; i < many; i++) qa[i][0] = 1, qa[i][1] = qa[i][2] = qa[i][3] = 0;
  CHECK(distance() < 4);
}

#define NAN4(q) (isnan((q)[0]) && isnan((q)[1]) && isnan((q)[2]) && isnan((q)[3]))

static void without_answer(void) {
  const double zero[4] = {0, 0, 0, 0}, unit[4] = {0.6, 0, 0.8, 0}, off[4] = {1.00001, 0, 0, 0}, slack[4] = {1 + 9e-7, 0, 0, 0};
  const double half_turn[4] = {0, 0.6, 0.8, 0}, huge[4] = {1e200, 1e200, 0, 0}, tiny[4] = {1e-309, 0, 0, 0};
  const double mirror[9] = {1, 0, 0, 0, 1, 0, 0, 0, -1}, skewed[9] = {1, 1e-5, 0, 0, 1, 0, 0, 0, 1}, none[9] = {0};
  const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, one = 1, hot[4] = {710, 1, 0, 0}, e1[3] = {1, 0, 0}, minus[3] = {-2, 0, 0};
  const double angles[3] = {0.1, 0.2, 0.3};
  double r[9], t, w[3];
  CHECK(poinsot_quaternion_inverse(1, zero, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_inverse(1, tiny, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_normalize(1, zero, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_normalize(1, tiny, r) == POINSOT_OK && r[0] == 1);
  CHECK(poinsot_quaternion_log(1, zero, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_exp(1, hot, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_multiply(1, huge, huge, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_multiply(1, huge, tiny, r) == POINSOT_OK);
  CHECK(poinsot_quaternion_multiply(1, zero, huge, r) == POINSOT_OK && r[0] == 0 && r[3] == 0);
  CHECK(poinsot_quaternion_conjugate(1, unit, r) == POINSOT_OK && r[0] == 0.6 && r[2] == -0.8);
  CHECK(poinsot_quaternion_rotate(1, off, e1, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_quaternion_rotate(1, slack, e1, r) == POINSOT_OK);
  CHECK(poinsot_quaternion_rotate_back(1, zero, e1, r) == POINSOT_E_DOMAIN && isnan(r[2]));
  CHECK(poinsot_quaternion_to_matrix(1, off, r) == POINSOT_E_DOMAIN && isnan(r[8]));
  CHECK(poinsot_quaternion_to_rotation_vector(1, off, r) == POINSOT_E_DOMAIN && isnan(r[2]));
  CHECK(poinsot_quaternion_to_axis_angle(1, off, r, &t) == POINSOT_E_DOMAIN && isnan(r[2]) && isnan(t));
  CHECK(poinsot_quaternion_to_axis_angle(1, (const double[4]){-1, 0, 0, 0}, r, &t) == POINSOT_OK && r[0] == 1 && t == 0);
  CHECK(poinsot_quaternion_to_axis_angle(1, half_turn, r, &t) == POINSOT_OK && fabs(t - pi) < 2 * eps && fabs(r[1] - 0.8) < eps);
  CHECK(poinsot_quaternion_to_cayley(1, half_turn, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_quaternion_to_euler(1, "zxz", off, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_quaternion_slerp(1, unit, off, &one, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_slerp(1, zero, unit, &one, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_from_matrix(1, mirror, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_from_matrix(1, skewed, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_from_matrix(1, identity, r) == POINSOT_OK && r[0] == 1);
  CHECK(poinsot_quaternion_nearest(1, skewed, r) == POINSOT_OK && fabs(r[0] - 1) < 1e-10);
  CHECK(poinsot_quaternion_nearest(1, none, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_from_axis_angle(1, zero, &one, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_shortest_arc(1, zero, e1, r) == POINSOT_E_DOMAIN && NAN4(r));
  CHECK(poinsot_quaternion_shortest_arc(1, e1, minus, r) == POINSOT_OK && r[0] == 0);
  CHECK(poinsot_quaternion_rotate(1, r, e1, w) == POINSOT_OK && fabs(w[0] + 1) < 2 * eps);
  CHECK(poinsot_quaternion_from_euler(1, "zxw", angles, r) == POINSOT_E_METHOD);
  CHECK(poinsot_quaternion_from_euler(1, "ZXZ", angles, r) == POINSOT_E_METHOD);
  CHECK(poinsot_quaternion_from_euler(1, "zzx", angles, r) == POINSOT_E_METHOD);
  CHECK(poinsot_quaternion_to_euler(1, "", unit, r) == POINSOT_E_METHOD);
  CHECK(poinsot_quaternion_from_euler(1, NULL, angles, r) == POINSOT_E_NULL);
  CHECK(poinsot_quaternion_to_euler(1, NULL, unit, r) == POINSOT_E_NULL);
  CHECK(poinsot_quaternion_from_euler(1, "zxz", NULL, r) == POINSOT_E_NULL);
  CHECK(poinsot_quaternion_to_euler(1, "zxz", unit, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_quaternion_random(1, 0, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_quaternion_random((size_t)-1, 0, r) == POINSOT_E_SIZE);
}

static void elliptic_ends(void) {
  const double mm[6] = {0, 1, -0.1, 1.5, 0.25, -0.0}, zero[1] = {0}, half[1] = {0.5}, far[1] = {3}, two[1] = {2}, nu[1] = {1};
  double r[6], s[6];
  CHECK(poinsot_elliptic_k(6, mm, NULL, r) == POINSOT_E_DOMAIN);
  CHECK(fabs(r[0] - pi / 2) < eps && isnan(r[1]) && isnan(r[2]) && isnan(r[3]) && fabs(r[4] - 1.6857503548125961) < 4 * eps && r[5] == r[0]);
  CHECK(poinsot_elliptic_e(6, mm, NULL, r) == POINSOT_E_DOMAIN);
  CHECK(fabs(r[0] - pi / 2) < 2 * eps && r[1] == 1 && isnan(r[2]) && isnan(r[3]) && fabs(r[4] - 1.4674622093394272) < 4 * eps);
  CHECK(poinsot_elliptic_pi(1, nu, half, NULL, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_elliptic_pi(1, two, half, NULL, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_elliptic_f(1, far, (const double[]){1}, NULL, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_elliptic_f(1, half, (const double[]){1}, NULL, r) == POINSOT_OK && fabs(r[0] - 0.52223810327844029) < 4 * eps);
  CHECK(poinsot_elliptic_e_incomplete(1, far, (const double[]){1}, NULL, r) == POINSOT_OK && fabs(r[0] - 2 + sin(3)) < 8 * eps);
  CHECK(poinsot_elliptic_pi_incomplete(1, two, half, half, NULL, r) == POINSOT_OK && isfinite(r[0]));
  CHECK(poinsot_elliptic_pi_incomplete(1, two, (const double[]){1}, half, NULL, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_elliptic_pi_incomplete(1, two, far, half, NULL, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_elliptic_f(1, (const double[]){2e15}, half, NULL, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_elliptic_k(1, half, (const double[]){-0.5}, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_elliptic_k(1, two, half, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_jacobi_am(1, two, zero, NULL, r) == POINSOT_OK && fabs(r[0] - 2) < 4 * eps);
  CHECK(poinsot_jacobi_am(1, (const double[]){6e9}, (const double[]){1}, NULL, r) == POINSOT_OK && fabs(r[0] - pi / 2) < eps);
  CHECK(poinsot_jacobi(1, (const double[]){2e10}, (const double[]){1}, NULL, r, s, s + 1) == POINSOT_OK && r[0] == 1 && s[0] >= 0);
  CHECK(poinsot_jacobi_am(1, (const double[]){2e15}, half, NULL, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_carlson_rf(1, zero, zero, half, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_carlson_rc(1, half, zero, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_carlson_rd(1, half, half, zero, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_carlson_rj(1, half, half, half, zero, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  /* a sum that loses three digits, of arguments 1e600 apart */
  CHECK(poinsot_carlson_rj(1, zero, (const double[]){1e-300}, (const double[]){1e300}, (const double[]){-1e-300}, r) == POINSOT_OK);
  CHECK(fabs(r[0] / -1.8696757204206914e150 - 1) < 1e-12);
  *s = 1e-250; /* the value is 1e375 */
  CHECK(poinsot_carlson_rd(1, s, s, s, r) == POINSOT_E_DOMAIN && isnan(r[0]));
  CHECK(poinsot_carlson_rj(1, s, s, s, s, r) == POINSOT_E_DOMAIN && isnan(r[0]));
}

/* ---- inertia ------------------------------------------------------------------------------------------------------- */

static void inertia(const char *folder) {
  static char line[4096];
  char path[1024];
  double in[64], centre[3], tensor[9], moments[3], axes[9], back, worst = 0;
  long double right[16];
  int rows = 0, n, k, i, j, results_there;
  FILE *file;
  snprintf(path, sizeof path, "%s/functions.csv", folder);
  file = fopen(path, "r");
  CHECK(file != NULL);
  while (file && fgets(line, sizeof line, file)) {
    const char *name = strtok(line, ",");
    int points = strcmp(name, "points") == 0;
    if (!points && strcmp(name, "principal") != 0) continue;
    n = atoi(strtok(NULL, ",")), results_there = atoi(strtok(NULL, ","));
    for (k = 0; k < n; k++) in[k] = strtod(strtok(NULL, ","), NULL);
    for (k = 0; k < results_there; k++) right[k] = strtold(strtok(NULL, ",\n"), NULL);
    rows++;
    if (points) {
      double size = largest(in + n / 4, (size_t)(3 * (n / 4)));
      CHECK(poinsot_inertia_of_points((size_t)n / 4, in, in + n / 4, centre, tensor) == POINSOT_OK);
      for (k = 0; k < 3; k++) worst = fmax(worst, (double)fabsl(centre[k] - right[k]) / size / eps);
      for (size = 0, k = 0; k < 9; k++) size = fmax(size, fabs(tensor[k]));
      for (k = 0; k < 9; k++) worst = fmax(worst, (double)fabsl(tensor[k] - right[3 + k]) / size / eps);
      continue;
    }
    CHECK(poinsot_principal_axes(in, moments, axes) == POINSOT_OK);
    for (k = 0; k < 3; k++) worst = fmax(worst, (double)fabsl(moments[k] - right[k]) / moments[2] / eps / 4);
    for (i = 0; i < 3; i++)
      for (j = 0; j < 3; j++) {
        for (back = 0, k = 0; k < 3; k++) back += axes[3 * i + k] * moments[k] * axes[3 * j + k];
        worst = fmax(worst, fabs(back - in[3 * i + j]) / moments[2] / eps / 8);
      }
    memcpy(tensor, in, sizeof tensor);
    CHECK(poinsot_principal_axes(tensor, moments, tensor) == POINSOT_OK && same(tensor, axes, 9));
  }
  if (file) fclose(file);
  CHECK(rows > 10);
  CHECK(worst < 4);
}

static void inertia_misused(void) {
  const double mass[2] = {1, 2}, negative[2] = {1, -2}, at[6] = {0, 0, 0, 1, 0, 0}, nothing[2] = {0, 0};
  const double good[3] = {0.6, 0.8, 1}, thin[3] = {1, 1, 3}, skew[9] = {1, 0.5, 0, 0, 1, 0, 0, 0, 1};
  double centre[3] = {7, 7, 7}, tensor[9] = {7, 7, 7, 7, 7, 7, 7, 7, 7}, moments[3], axes[9], products[9] = {2, -1, 0, -1, 2, 0, 0, 0, 4};
  char text[200], few[10];
  poinsot_body *body;
  CHECK(poinsot_inertia_of_points(0, mass, at, centre, tensor) == POINSOT_E_SIZE);
  CHECK(poinsot_inertia_of_points(2, NULL, at, centre, tensor) == POINSOT_E_NULL);
  CHECK(poinsot_inertia_of_points(2, mass, NULL, centre, tensor) == POINSOT_E_NULL);
  CHECK(poinsot_inertia_of_points(2, mass, at, NULL, tensor) == POINSOT_E_NULL);
  CHECK(poinsot_inertia_of_points(2, mass, at, centre, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_inertia_of_points(2, negative, at, centre, tensor) != POINSOT_OK);
  CHECK(poinsot_inertia_of_points(2, nothing, at, centre, tensor) == POINSOT_E_DOMAIN);
  CHECK(centre[0] == 7 && tensor[8] == 7);
  CHECK(poinsot_inertia_of_points(2, mass, at, centre, tensor) == POINSOT_OK);
  CHECK(fabs(centre[0] - 2.0 / 3) < eps && fabs(tensor[4] - 2.0 / 3) < eps && tensor[0] == 0);
  CHECK(poinsot_principal_axes(NULL, moments, axes) == POINSOT_E_NULL);
  CHECK(poinsot_principal_axes(products, NULL, axes) == POINSOT_E_NULL);
  CHECK(poinsot_principal_axes(products, moments, NULL) == POINSOT_E_NULL);
  CHECK(poinsot_principal_axes(skew, moments, axes) != POINSOT_OK);
  /* -1 off the diagonal: the axis of least inertia is the diagonal between x and y */
  CHECK(poinsot_principal_axes(products, moments, axes) == POINSOT_OK && fabs(moments[0] - 1) < 4 * eps && axes[0] * axes[3] > 0.49);
  CHECK(poinsot_moments_check(good, text, sizeof text) == POINSOT_OK && text[0] == 0);
  CHECK(poinsot_moments_check(thin, text, sizeof text) == poinsot_body_create(thin, &body) && strstr(text, "I3") != NULL);
  CHECK(poinsot_moments_check(thin, few, sizeof few) != POINSOT_OK && strlen(few) == 9);
  CHECK(poinsot_moments_check(thin, NULL, 0) != POINSOT_OK);
  CHECK(poinsot_moments_check(NULL, text, sizeof text) == POINSOT_E_NULL && text[0] != 0);
  CHECK(poinsot_inertia_check(products, text, sizeof text) == POINSOT_OK && text[0] == 0);
  CHECK(poinsot_inertia_check(skew, text, sizeof text) == poinsot_body_create_tensor(skew, &body, NULL) &&
        strstr(text, "not symmetric") != NULL);
  CHECK(poinsot_inertia_check(NULL, text, sizeof text) == POINSOT_E_NULL && text[0] != 0);
}

int main(int count, char **argument) {
  const char *folder = count > 1 ? argument[1] : "test/data";
  size_t k;
#if defined __GLIBC__ && defined FE_INVALID
  feenableexcept(FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO);
#endif
  over_tables(folder);
  for (k = 0; k < function_count; k++) {
    load(folder, functions + k);
    flushed(functions + k);
  }
  round_trips();
  without_answer();
  elliptic_ends();
  inertia(folder);
  inertia_misused();
  printf("functions: %d checks, %d failed\n", checks, failures);
  return failures != 0;
}
