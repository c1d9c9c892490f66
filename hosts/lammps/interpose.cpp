// LAMMPS's two rotations of a rigid body, done exactly.
//
// Preloaded (LD_PRELOAD), this library replaces LAMMPS's own MathExtra::richardson (fix rigid, fix rigid/small,
// fix nve/asphere ...) and MathExtra::no_squish_rotate (fix rigid/nve, rigid/nvt, rigid/npt ...). No header of LAMMPS is
// needed: only the two signatures and their meaning are assumed. The calls for a body go to poinsot; bodies that poinsot
// refuses, and calls that differ from what is assumed, are computed with LAMMPS's formulas below and counted.
//
//   POINSOT_LAMMPS_REPORT=1      at the end of the process: the number of calls done by poinsot, and the method
//   POINSOT_LAMMPS_METHOD=exact  the method (any of `poinsot methods`)
//   POINSOT_LAMMPS_OFF=1         LAMMPS's formulas throughout, for comparison
#include <poinsot.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<long> taken_richardson{0}, taken_no_squish{0}, refused{0}, unknown_order{0};

const char *method() {
  static const char *const name = [] {
    const char *asked = std::getenv("POINSOT_LAMMPS_METHOD");
    return asked && *asked ? asked : "exact";
  }();
  return name;
}

bool switched_off() {
  static const bool off = std::getenv("POINSOT_LAMMPS_OFF") != nullptr;
  return off;
}

struct Report {
  ~Report() {
    if (!std::getenv("POINSOT_LAMMPS_REPORT")) return;
    std::fprintf(stderr,
                 "poinsot: method %s; richardson %ld, no_squish %ld bodies turned; %ld refused, %ld sequences of axes not as "
                 "assumed (these were left to LAMMPS's formulas)\n",
                 method(), taken_richardson.load(), taken_no_squish.load(), refused.load(), unknown_order.load());
  }
} report;

// ---- bodies, known by their moments: a small table for each thread --------------------------------------------------------

struct Known {
  double moments[3];
  poinsot_body *body;
};

struct Bodies {
  static constexpr unsigned slots = 256;
  Known table[slots] = {};
  ~Bodies() {
    for (Known &k : table) poinsot_body_destroy(&k.body);
  }
  const poinsot_body *find(const double moments[3]) {
    std::uint64_t hash = 1469598103934665603u, bits;
    for (int j = 0; j < 3; j++) {
      std::memcpy(&bits, &moments[j], sizeof bits);
      hash = (hash ^ bits) * 1099511628211u;
      hash ^= hash >> 29;
    }
    Known &k = table[hash % slots];
    if (k.body && std::memcmp(k.moments, moments, sizeof k.moments) == 0) return k.body;
    poinsot_body_destroy(&k.body);
    std::memcpy(k.moments, moments, sizeof k.moments);
    if (poinsot_body_create(moments, &k.body) != POINSOT_OK) return nullptr;
    return k.body;
  }
};

thread_local Bodies bodies;

// ---- quaternions, scalar first, body to space -----------------------------------------------------------------------------

void multiply(const double a[4], const double b[4], double c[4]) {
  c[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
  c[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
  c[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
  c[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

void conjugate(const double a[4], double b[4]) {
  b[0] = a[0];
  for (int j = 1; j < 4; j++) b[j] = -a[j];
}

void turn(const double q[4], const double v[3], double w[3]) {
  const double pure[4] = {0, v[0], v[1], v[2]};
  double back[4], half[4], full[4];
  conjugate(q, back);
  multiply(q, pure, half);
  multiply(half, back, full);
  std::memcpy(w, full + 1, 3 * sizeof *w);
}

void turn_back(const double q[4], const double v[3], double w[3]) {
  double back[4];
  conjugate(q, back);
  turn(back, v, w);
}

void normalize(double q[4]) {
  const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int j = 0; j < 4; j++) q[j] /= size;
}

double inverse(double moment) { return moment > 0 ? 1 / moment : 0; }

// Angular velocity, space frame, of momentum m, space frame.
void angular_velocity(const double q[4], const double m[3], const double moments[3], double w[3]) {
  double y[3];
  turn_back(q, m, y);
  for (int j = 0; j < 3; j++) y[j] *= inverse(moments[j]);
  turn(q, y, w);
}

// Free rotation of one body over h; false: refused, q is not changed. In LAMMPS there is no rotation about an axis without
// inertia, whatever momentum rounding errors have left there.
bool rotate(const double moments[3], double h, double y[3], double q[4]) {
  for (int j = 0; j < 3; j++)
    if (!(moments[j] > 0)) y[j] = 0;
  const poinsot_body *body = bodies.find(moments);
  poinsot_status each = POINSOT_OK;
  if (body && poinsot_rotate(body, method(), h, 1, 1, y, q, &each) == POINSOT_OK) return true;
  refused++;
  return false;
}

// ---- LAMMPS's formulas: one step of q' = w q / 2 with momentum m kept, extrapolated after Richardson -----------------------------

void advance(const double w[3], double h, double q[4]) {
  const double pure[4] = {0, w[0], w[1], w[2]};
  double change[4];
  multiply(pure, q, change);
  for (int j = 0; j < 4; j++) q[j] += h * change[j];
  normalize(q);
}

void richardson_step(double q[4], const double m[3], double w[3], const double moments[3], double half_step) {
  double full[4];
  std::memcpy(full, q, sizeof full);
  advance(w, half_step, full);
  advance(w, 0.5 * half_step, q);
  angular_velocity(q, m, moments, w);
  advance(w, 0.5 * half_step, q);
  for (int j = 0; j < 4; j++) q[j] = 2 * q[j] - full[j];
  normalize(q);
}

// A rotation about body axis k by the component of the momentum along it: a factor of the splitting by Miller et al. (2002).
void turn_about(int k, double p[4], double q[4], const double moments[3], double h) {
  static const double units[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  double pk[4], qk[4], phi = 0;
  multiply(p, units[k], pk);
  multiply(q, units[k], qk);
  for (int j = 0; j < 4; j++) phi += p[j] * qk[j];
  if (std::fabs(moments[k - 1]) < 1e-14)
    phi = 0;
  else
    phi /= 4 * moments[k - 1];
  const double c = std::cos(h * phi), s = std::sin(h * phi);
  for (int j = 0; j < 4; j++) {
    p[j] = c * p[j] + s * pk[j];
    q[j] = c * q[j] + s * qk[j];
  }
}

// ---- five rotations as one: axes 3, 2, 1, 2, 3 over h/2, h/2, h, h/2, h/2 of one body are a step of h ---------------------------

const int order[5] = {3, 2, 1, 2, 3};

// A call site in LAMMPS where such a sequence begins. The first sequence from a site is computed with LAMMPS's formulas and
// checked; if it is the one above, later ones are replaced.
enum class Trust { unknown, yes, no };
struct Place {
  void *address = nullptr;
  Trust trust = Trust::unknown;
};

struct Sequence {
  Place places[64];
  Place *place = nullptr;
  int done = 0; // calls seen of the present sequence
  double *p = nullptr, *q = nullptr;
  const double *moments = nullptr;
  double h = 0; // of the first call
  bool skipping = false;

  Place *find(void *address) {
    for (Place &one : places) {
      if (one.address == address || !one.address) {
        one.address = address;
        return &one;
      }
    }
    return nullptr;
  }

  bool continues(int k, double *p_now, double *q_now, const double *moments_now, double h_now) const {
    return k == order[done] && p_now == p && q_now == q && moments_now == moments && h_now == (done == 2 ? 2 * h : h);
  }

  // Make up for the calls that were skipped.
  void catch_up() {
    if (skipping)
      for (int i = 0; i < done; i++) turn_about(order[i], p, q, moments, i == 2 ? 2 * h : h);
    skipping = false;
    if (place) place->trust = Trust::no;
    done = 0;
    unknown_order++;
  }

  void whole_step() {
    double back[4], y4[4], y[3], turned[4];
    conjugate(q, back);
    multiply(back, p, y4); // p = 2 q o (0, y)
    for (int j = 0; j < 3; j++) y[j] = 0.5 * y4[j + 1];
    std::memcpy(turned, q, sizeof turned);
    if (!rotate(moments, 2 * h, y, turned)) {
      for (int i = 0; i < 5; i++) turn_about(order[i], p, q, moments, i == 2 ? 2 * h : h);
      return;
    }
    taken_no_squish++;
    std::memcpy(q, turned, sizeof turned);
    const double pure[4] = {0, 2 * y[0], 2 * y[1], 2 * y[2]};
    multiply(q, pure, p);
  }

  void call(void *address, int k, double *p_now, double *q_now, const double *moments_now, double h_now) {
    if (done > 0 && !continues(k, p_now, q_now, moments_now, h_now)) catch_up();
    if (done == 0) {
      place = k == order[0] ? find(address) : nullptr;
      p = p_now, q = q_now, moments = moments_now, h = h_now;
      skipping = place && place->trust == Trust::yes;
      if (!place || place->trust == Trust::no) {
        turn_about(k, p_now, q_now, moments_now, h_now);
        return;
      }
    }
    if (!skipping) turn_about(k, p_now, q_now, moments_now, h_now);
    if (++done < 5) return;
    done = 0;
    if (skipping)
      whole_step();
    else
      place->trust = Trust::yes;
  }
};

thread_local Sequence sequence;

} // namespace

#define EXPORTED __attribute__((visibility("default")))

namespace MathExtra {

// q over a step of 2 half_step, with the angular momentum m (space frame) kept. w is left as LAMMPS leaves it: the angular
// velocity at the middle of the step.
EXPORTED void richardson(double *q, double *m, double *w, double *moments, double half_step) {
  if (!switched_off()) {
    double y[3], turned[4];
    turn_back(q, m, y);
    std::memcpy(turned, q, sizeof turned);
    if (rotate(moments, half_step, y, turned)) {
      double middle[3];
      angular_velocity(turned, m, moments, middle);
      if (rotate(moments, half_step, y, turned)) {
        taken_richardson++;
        std::memcpy(q, turned, sizeof turned);
        std::memcpy(w, middle, sizeof middle);
        return;
      }
    }
  }
  richardson_step(q, m, w, moments, half_step);
}

EXPORTED void no_squish_rotate(int k, double *p, double *q, double *moments, double h) {
  if (switched_off())
    turn_about(k, p, q, moments, h);
  else
    sequence.call(__builtin_return_address(0), k, p, q, moments, h);
}

} // namespace MathExtra
