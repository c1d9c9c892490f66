/* Before main, and before anything compiled from Fortran: on a processor that the program was not compiled for, a sentence and
 * exit code 1. This file, as src/api/*.c, is never compiled for a newer processor. */
#include <unistd.h>

int poinsot_processor_fits(void);

__attribute__((constructor)) static void check_processor(void) {
  static const char text[] =
      "poinsot: this program was compiled for a newer processor than this one; build it here, or with PORTABLE=1\n";
  if (poinsot_processor_fits()) return;
  if (write(2, text, sizeof text - 1) < 0) {
  }
  _exit(1);
}
