/* A host that opens the library, lets its threads run, closes it and goes on: OpenMP's threads are still there. */
#include <dlfcn.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { n = 4000 };
static double y[3 * n], q[4 * n];

int main(int count, char **arguments) {
  const double moments[3] = {0.6, 0.8, 1.0};
  const struct timespec moment = {0, 500000000};
  int i;
  if (count < 2) return 2;
  void *library = dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL), *body = NULL;
  int (*create)(const double *, void **), (*rotate)(void *, const char *, double, size_t, size_t, double *, double *, int *);
  void (*destroy)(void **);
  if (!library) return printf("unload: %s\n", dlerror()), 1;
  *(void **)&create = dlsym(library, "poinsot_body_create");
  *(void **)&rotate = dlsym(library, "poinsot_rotate");
  *(void **)&destroy = dlsym(library, "poinsot_body_destroy");
  for (i = 0; i < n; i++) y[3 * i] = y[3 * i + 1] = y[3 * i + 2] = q[4 * i] = 1;
  if (create(moments, &body) || rotate(body, "exact", 0.1, 4000, n, y, q, NULL)) return printf("unload: a call failed\n"), 1;
  destroy(&body);
  dlclose(library);
  nanosleep(&moment, NULL);
  if (system(":")) return 1;
  puts("unload: ok");
  return 0;
}
