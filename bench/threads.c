/* What threads bring, by the work of a call: on the machine as it is, and with another program on each processor.
 *
 * usage: threads [--quick]     wall time; medians and the worst of calls that take turns with those of one thread */
#define _GNU_SOURCE
#include <poinsot.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { most_bodies = 262144, most_calls = 200, most_spinners = 256 };

static double y[3 * most_bodies], q[4 * most_bodies], took[2][most_calls];

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

static poinsot_plan *plan_of(const char *threads) {
  const double moments[3] = {0.376, 0.627, 1};
  poinsot_plan *plan = NULL;
  if (poinsot_plan_create(&plan) || poinsot_plan_set(plan, "threads", threads) || poinsot_plan_add_class(plan, moments, NULL) ||
      poinsot_plan_ready(plan))
    exit(1);
  return plan;
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, z = *(const double *)b;
  return (x > z) - (x < z);
}

/* Calls of n bodies and so many steps: seconds of one thread and of all, the middle and the worst. */
static void measure(poinsot_plan *one, poinsot_plan *all, int n, int steps, int calls, double middle[2], double worst[2]) {
  poinsot_plan *plans[2];
  poinsot_bodies view;
  int i, k;
  plans[0] = one, plans[1] = all;
  for (i = 0; i < n; i++) {
    y[3 * i] = 0.3, y[3 * i + 1] = 0.5, y[3 * i + 2] = 0.8;
    for (k = 0; k < 4; k++) q[4 * i + k] = 0.5;
  }
  if (poinsot_bodies_rows(&view, "native", NULL, (size_t)n, y, q)) exit(1);
  for (i = 0; i < calls; i++)
    for (k = 0; k < 2; k++) {
      const double start = now();
      if (poinsot_step(plans[k], &view, 0, 0.03, 0, steps, NULL, NULL)) exit(1);
      took[k][i] = now() - start;
    }
  for (k = 0; k < 2; k++) {
    qsort(took[k], (size_t)calls, sizeof took[k][0], ascending);
    middle[k] = took[k][calls / 2], worst[k] = took[k][calls - 1];
  }
}

static void table(poinsot_plan *one, poinsot_plan *all, int quick) {
  static const struct { int n, steps; } work[] = {{300, 1},      {4096, 10},     {32768, 10},   {131072, 10},
                                                  {262144, 20},  {262144, 100}};
  size_t i;
  printf("   bodies  steps    one thread, ms        all threads, ms   gain of medians\n");
  for (i = 0; i < sizeof work / sizeof *work; i++) {
    const double ns = 7.0 * work[i].n * work[i].steps;
    int calls = (int)((quick ? 2e8 : 1e9) / ns);
    double middle[2], worst[2];
    if (calls > most_calls) calls = most_calls;
    if (calls < 5) calls = 5;
    measure(one, all, work[i].n, work[i].steps, calls, middle, worst);
    printf("%9d %6d   %9.4f (%9.4f)  %9.4f (%9.4f)   %6.2f\n", work[i].n, work[i].steps, 1e3 * middle[0], 1e3 * worst[0],
           1e3 * middle[1], 1e3 * worst[1], middle[0] / middle[1]);
  }
}

int main(int argc, char **argv) {
  const int quick = argc > 1 && !strcmp(argv[1], "--quick");
  const long processors = sysconf(_SC_NPROCESSORS_ONLN);
  poinsot_plan *one = plan_of("1"), *all = plan_of("0");
  pid_t spinner[most_spinners];
  int i, spinners = processors > most_spinners ? most_spinners : (int)processors;
  printf("median (worst) wall time of a call; %ld processors\n\nthe machine as it is\n", processors);
  table(one, all, quick);
  fflush(stdout);
  for (i = 0; i < spinners; i++) {
    spinner[i] = fork();
    if (spinner[i] == 0)
      for (;;) {
        volatile double x = 1;
        x *= 1.0000001;
      }
  }
  printf("\nanother program on each processor\n");
  table(one, all, quick);
  for (i = 0; i < spinners; i++)
    if (spinner[i] > 0) kill(spinner[i], SIGKILL), waitpid(spinner[i], NULL, 0);
  poinsot_plan_destroy(&one);
  poinsot_plan_destroy(&all);
  return 0;
}
