/* A program outside the tree: what a C host does with an installed poinsot, and what it must survive. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <poinsot.h>

#define REQUIRE(condition) \
    do { if (!(condition)) { fprintf(stderr, "line %d: %s\n", __LINE__, #condition); return 1; } } while (0)

int main(void)
{
    const double moments[3] = {0.376, 0.627, 1.0}, broken[3] = {1.0, 1.0, 3.0};
    double y[2][3] = {{0.6, 0.0, 0.8}, {0.0, 0.6, 0.8}}, q[2][4] = {{1, 0, 0, 0}, {1, 0, 0, 0}};
    poinsot_status each[2] = {-1, -1};
    poinsot_body *body = NULL, *none = NULL;
    size_t i;

    REQUIRE(poinsot_version() >= 100);
    REQUIRE(sizeof(void *) != 8 || sizeof(poinsot_bodies) == 208); /* as the header says */
    REQUIRE(strcmp(poinsot_status_text(POINSOT_OK), "ok") == 0);
    REQUIRE(poinsot_status_text(-7) != NULL);
    REQUIRE(poinsot_method_count() > 0);
    for (i = 0; i < poinsot_method_count(); i++) REQUIRE(poinsot_method_name(i) != NULL);
    REQUIRE(poinsot_method_name(poinsot_method_count()) == NULL);

    REQUIRE(poinsot_has_feature("lapack") == 1 && poinsot_has_feature("release") == 1);
    REQUIRE(poinsot_has_feature("no such") == 0 && poinsot_has_feature(NULL) == 0);
    REQUIRE(poinsot_has_feature("x86-64-v3") >= poinsot_has_feature("x86-64-v4"));
    REQUIRE(poinsot_has_feature("avx2") >= poinsot_has_feature("x86-64-v3"));

    REQUIRE(poinsot_body_create(broken, &none) == POINSOT_E_DOMAIN && none == NULL);
    REQUIRE(poinsot_body_create(NULL, &none) == POINSOT_E_NULL);
    REQUIRE(poinsot_body_create(moments, &body) == POINSOT_OK && body != NULL);
    REQUIRE(poinsot_rotate(body, "exact", 0.1, 100, 2, &y[0][0], &q[0][0], each) == POINSOT_OK);
    for (i = 0; i < 2; i++) {
        const double *p = q[i], *m = y[i];
        REQUIRE(each[i] == POINSOT_OK);
        REQUIRE(fabs(p[0]*p[0] + p[1]*p[1] + p[2]*p[2] + p[3]*p[3] - 1) < 1e-13);
        REQUIRE(fabs(m[0]*m[0] + m[1]*m[1] + m[2]*m[2] - 1) < 1e-13);
    }
    REQUIRE(fabs(q[0][0]) < 0.9999); /* it did turn */
    REQUIRE(poinsot_rotate(body, "no such method", 0.1, 1, 2, &y[0][0], &q[0][0], NULL) == POINSOT_E_METHOD);
    REQUIRE(poinsot_rotate(NULL, "exact", 0.1, 1, 2, &y[0][0], &q[0][0], NULL) == POINSOT_E_NULL);

    poinsot_body_destroy(&body);
    REQUIRE(body == NULL);
    poinsot_body_destroy(&body);
    poinsot_body_destroy(NULL);
    puts("consumer: ok");
    return 0;
}
