/* Functions of long arguments that flang's run-time library lacks where it was built without them, as Debian's: taken from
 * gcc's libquadmath. For the check in tools/deep.sh only. */
#include <quadmath.h>
#include <stdint.h>

__float128 _FortranAAsinF128(__float128 x) { return asinq(x); }
__float128 _FortranAAtan2F128(__float128 y, __float128 x) { return atan2q(y, x); }
__float128 _FortranACeilF128(__float128 x) { return ceilq(x); }
__float128 _FortranACosF128(__float128 x) { return cosq(x); }
__float128 _FortranACoshF128(__float128 x) { return coshq(x); }
__float128 _FortranAExpF128(__float128 x) { return expq(x); }
__float128 _FortranALog10F128(__float128 x) { return log10q(x); }
__float128 _FortranALogF128(__float128 x) { return logq(x); }
int64_t _FortranALroundF128(__float128 x) { return llroundq(x); }
__float128 _FortranAPowF128(__float128 x, __float128 y) { return powq(x, y); }
__float128 _FortranASinF128(__float128 x) { return sinq(x); }
__float128 _FortranASqrtF128(__float128 x) { return sqrtq(x); }
__float128 _FortranATanhF128(__float128 x) { return tanhq(x); }
