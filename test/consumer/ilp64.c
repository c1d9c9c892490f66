/* A host that has brought a LAPACK of 8-byte integers, whose symbols come before the library's own: the library calls it with
 * integers that it reads right. (A LAPACK of 4-byte integers is what all other tests link.) */
#include "poinsot.h"
#include <stdio.h>

static int calls, wrong;

/* Eigenvalues and eigenvectors as far as the test needs them: of [[2, 1, 0], [1, 2, 0], [0, 0, 3]]. */
void dsyev_(const char *jobz, const char *uplo, const int64_t *n, double *a, const int64_t *lda, double *w, double *work,
            const int64_t *lwork, int64_t *info) {
  const double r = 0.70710678118654752;
  calls++;
  if (*n != 3 || *lda != 3 || *lwork < 8 || *lwork > 1000 || *jobz != 'V' || (*uplo != 'U' && *uplo != 'L')) wrong++;
  *info = 0;
  w[0] = 1, w[1] = w[2] = 3;
  a[0] = r, a[1] = -r, a[2] = 0, a[3] = r, a[4] = r, a[5] = 0, a[6] = a[7] = 0, a[8] = 1;
  (void)work;
}

int main(void) {
  const double inertia[9] = {2, 1, 0, 1, 2, 0, 0, 0, 3};
  double axes[9];
  poinsot_body *body;
  poinsot_status status = poinsot_body_create_tensor(inertia, &body, axes);
  if (status || calls != 1 || wrong) {
    printf("ilp64: status %d, %d calls, %d of them with wrong integers\n", status, calls, wrong);
    return 1;
  }
  poinsot_body_destroy(&body);
  puts("ilp64: ok");
  return 0;
}
