/* One period of the polhode, with the array functions: a water molecule's momentum recurs after four quarter periods, 4 K(m) in
 * Jacobi's time; its attitude does not. cc one_turn.c $(pkg-config --cflags --libs poinsot) -lm */
#include <math.h>
#include <poinsot.h>
#include <stdio.h>

static int failed(poinsot_status status) {
  fprintf(stderr, "%s\n", poinsot_status_text(status));
  return 1;
}

int main(void) {
  const double mass[3] = {15.999, 1.008, 1.008};
  const double atoms[3][3] = {{0, 0, 0}, {0.757, 0.586, 0}, {-0.757, 0.586, 0}};
  const double angles[3] = {0.3, 1.1, -0.4}, before[3] = {0.5, 0.4, 1.0};
  double centre[3], tensor[9], axes[9], i[3], y[3], q[4], start[4], back[4], turn[4], axis[3], l[3];
  double energy = 0, l2 = 0, m, k, rate, period, angle, off = 0, along = 0;
  poinsot_body *body;
  poinsot_status status;
  int j;

  if ((status = poinsot_inertia_of_points(3, mass, atoms[0], centre, tensor)) || (status = poinsot_principal_axes(tensor, i, axes)) ||
      (status = poinsot_body_create(i, &body)) || (status = poinsot_quaternion_from_euler(1, "zxz", angles, start)))
    return failed(status);

  for (j = 0; j < 3; j++) {
    energy += before[j]*before[j]/i[j]/2;
    l2 += before[j]*before[j];
    y[j] = before[j];
  }
  for (j = 0; j < 4; j++) q[j] = start[j];
  /* Landau and Lifshitz, Mechanics, section 37; here l2 > 2 energy i[1] */
  m = (i[1] - i[0])*(2*energy*i[2] - l2)/((i[2] - i[1])*(l2 - 2*energy*i[0]));
  rate = sqrt((i[2] - i[1])*(l2 - 2*energy*i[0])/(i[0]*i[1]*i[2]));
  if ((status = poinsot_elliptic_k(1, &m, NULL, &k))) return failed(status);
  period = 4*k/rate;

  if ((status = poinsot_rotate(body, "exact", period, 1, 1, y, q, NULL)) ||
      (status = poinsot_quaternion_conjugate(1, start, back)) || (status = poinsot_quaternion_multiply(1, q, back, turn)) ||
      (status = poinsot_quaternion_to_axis_angle(1, turn, axis, &angle)) || (status = poinsot_quaternion_rotate(1, start, before, l)))
    return failed(status);
  for (j = 0; j < 3; j++) {
    off = fmax(off, fabs(y[j] - before[j]));
    along += axis[j]*l[j]/sqrt(l2);
  }
  printf("moments          %10.6f%10.6f%10.6f\n", i[0], i[1], i[2]);
  printf("period           %10.6f\n", period);
  printf("turned by        %10.6f\n", angle);
  printf("momentum is back: %c\n", off < 1e-14 ? 'T' : 'F');
  printf("turned about it:  %c\n", fabs(fabs(along) - 1) < 1e-14 ? 'T' : 'F'); /* about the angular momentum, in space */
  poinsot_body_destroy(&body);
  return 0;
}
