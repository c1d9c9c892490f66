#!/usr/bin/env python3
"""Write src/body/series_table.f90 and src/body/series_start.f90: the series P and R of the modified moments as
polynomials in b = a1 a2, c = a2 a3 and a2.

usage: tools/series_table.py [DEGREE]      in the root of the repository; 13 degrees take ten seconds

The recursion of docs/mathematics.md, section 3, in exact rationals. a1 - a2 + a3 = a1 a2 a3 for every body, so
that a2^2 = b + c - b c: each coefficient of p^i r^j is E(b, c) + a2 O(b, c), and that of p^j r^i in R is
E(c, b) - a2 O(c, b). Only python3 is needed; the build needs neither.
"""
import sys
from fractions import Fraction

LINE = 100       # columns
START = 4        # degrees of series_start.f90
BLOCK = 4        # rows in a block of the table

# A polynomial: {(i, k, m): coefficient of b^i c^k a2^m}, m = 0 or 1.
# A series: for each degree n a list of n + 1 polynomials, number i belonging to p^i r^(n-i).


def multiply(x, y, total):
    """total += x y"""
    for (i, k, m), u in x.items():
        for (j, l, n), v in y.items():
            if m + n < 2:
                terms = (((i + j, k + l, m + n), u*v),)
            else:
                terms = (((i + j + 1, k + l, 0), u*v), ((i + j, k + l + 1, 0), u*v),
                         ((i + j + 1, k + l + 1, 0), -u*v))
            for power, value in terms:
                total[power] = total.get(power, 0) + value


def product(x, y, n):
    """the part of degree n of a product"""
    part = [{} for _ in range(n + 1)]
    for m in range(n + 1):
        for i, u in enumerate(x[m]):
            for j, v in enumerate(y[n - m]):
                multiply(u, v, part[i + j])
    return part


def add(x, n, factor, part, i=0, j=0, by=None):
    """x_n += factor p^i r^j by part"""
    for row, polynomial in enumerate(part):
        if by is not None:
            scaled = {}
            multiply(by, polynomial, scaled)
            polynomial = scaled
        target = x[n][row + i]
        for power, value in polynomial.items():
            total = target.get(power, 0) + factor*value
            if total:
                target[power] = total
            else:
                target.pop(power, None)


def correction(degree):
    """1 + P, from the recursion of section 3 with a1 k = b K, a3 k = c K, k = a2 K"""
    def series():
        return [[{} for _ in range(n + 1)] for n in range(degree + 1)]
    a2, b, c = {(0, 0, 1): Fraction(1)}, {(1, 0, 0): Fraction(1)}, {(0, 1, 0): Fraction(1)}
    f, g, k, q0, q1, q2, q3, rho, w, p = (series() for _ in range(10))
    for x in (f, g, q0):
        x[0][0][0, 0, 0] = Fraction(1)
    for n in range(degree + 1):
        half, quarter = Fraction(1, 4*n + 2), Fraction(1, 4*n + 4)
        if n > 0:
            add(f, n, Fraction(-1, 2*n), product(k, g, n - 1), 0, 1, b)
            add(g, n, Fraction(-1, 2*n), product(k, f, n - 1), 1, 0, c)
            add(q0, n, Fraction(-1, 4*n), product(q1, f, n - 1), 1, 0)
            add(q0, n, Fraction(-1, 4*n), product(q3, g, n - 1), 0, 1)
        if n > 1:
            add(q0, n, Fraction(-1, 4*n), product(q2, k, n - 2), 1, 1, a2)
        add(k, n, 2*half, product(f, g, n))
        add(q1, n, half, product(q0, f, n))
        add(q3, n, half, product(q0, g, n))
        if n > 0:
            add(q1, n, half, product(q2, g, n - 1), 0, 1)
            add(q1, n, -half, product(q3, k, n - 1), 0, 1, a2)
            add(q3, n, half, product(q1, k, n - 1), 1, 0, a2)
            add(q3, n, -half, product(q2, f, n - 1), 1, 0)
        add(q2, n, quarter, product(q0, k, n), by=a2)
        add(q2, n, -quarter, product(q1, g, n))
        add(q2, n, quarter, product(q3, f, n))
        add(rho, n, 1, product(q0, q0, n))
        if n > 0:
            add(rho, n, -1, product(q1, q1, n - 1), 1, 0)
            add(rho, n, -1, product(q3, q3, n - 1), 0, 1)
        if n > 1:
            add(rho, n, 1, product(q2, q2, n - 2), 1, 1)
        add(w, n, 2, product(q0, q1, n))
        if n > 0:
            add(w, n, -2, product(q2, q3, n - 1), 0, 1)
    for n in range(degree + 1):
        known = product(p, f, n)
        add(p, n, 1, product(rho, w, n))
        add(p, n, -1, known)
    return [[{power: value/4**n for power, value in row.items()} for row in p[n]] for n in range(degree + 1)]


def number(value):
    """17 digits, which a double needs, or fewer where they are all"""
    return repr(value.numerator/value.denominator) + "_dp" if value else "o"


def fill(items, indent, end):
    """items over as many lines as they need"""
    lines, line = [], indent
    for n, item in enumerate(items):
        item += "," if n < len(items) - 1 else end
        if len(line) + len(item) + 2 > LINE:
            lines.append(line.rstrip() + " &")
            line = indent
        line += item + " "
    return lines + [line.rstrip()]


def columns(part, n, m):
    """the blocks of the columns b^i c^k of one part of degree n, rows k to n - i; nothing else may be there"""
    values, seen = [], 0
    for k in range(n):
        for first in range(k, n + 1, BLOCK):
            for i in range(n - first + 1):
                rows = [part[row].get((i, k, m), Fraction(0)) if row <= n - i else Fraction(0)
                        for row in range(first, first + BLOCK)]
                seen += sum(1 for value in rows if value)
                values += rows
    if seen != sum(1 for row in part for power in row if power[2] == m):
        sys.exit("a coefficient outside its rows")
    return values


def table(p):
    degree = len(p) - 1
    text = [
        "!> Generated by tools/series_table.py: not to be edited.",
        "!>",
        "!> Coefficients of 1 + P (docs/mathematics.md, section 3): that of p^i r^(n-i) is",
        "!> E(b, c) + a2 O(b, c). `even_n` and `odd_n` have those of E and O in blocks of four rows i, for",
        "!> each c^k from row k on, one block for each b^m. Exact rationals, rounded once.",
        "module poinsot_body_series_table",
        "   use poinsot_core_kinds, only: dp",
        "   implicit none(type, external)",
        "   private",
        "   public :: table_degree",
        "   public :: " + ", ".join(f"even_{n}" for n in range(START + 1, (degree + START)//2 + 1)),
        "   public :: " + ", ".join(f"even_{n}" for n in range((degree + START)//2 + 1, degree + 1)),
        "   public :: " + ", ".join(f"odd_{n}" for n in range(START + 1, (degree + START)//2 + 1)),
        "   public :: " + ", ".join(f"odd_{n}" for n in range((degree + START)//2 + 1, degree + 1)),
        "",
        f"   integer, parameter :: table_degree = {degree} !! highest power of h^2",
        "   real(dp), parameter :: o = 0.0_dp"]
    for n in range(START + 1, degree + 1):
        for m, name in ((0, "even"), (1, "odd")):
            values = columns(p[n], n, m)
            text += ["", f"   real(dp), parameter :: {name}_{n}({len(values)}) = [ &"]
            text += fill([number(value) for value in values], " "*6, "]")
    return text + ["", "end module poinsot_body_series_table"]


def horner(polynomial, outer, inner):
    """{(i, k): value} as nested Horner schemes; outer has the powers i"""
    def one(i):
        powers = {k: value for (j, k), value in polynomial.items() if j == i}
        text = None
        for k in range(max(powers, default=-1), -1, -1):
            value = powers.get(k)
            if text is None:
                text = number(value)
            else:
                text = f"{bracket(text)}*{inner}" + (plus(number(value)) if value else "")
        return text
    text = None
    for i in range(max(i for i, _ in polynomial), -1, -1):
        term = one(i)
        if text is None:
            text = term
        else:
            text = f"{bracket(text)}*{outer}" + (plus(term) if term else "")
    return text


def bracket(text):
    return f"({text})" if " " in text or text.startswith("-") else text


def plus(text):
    if " " in text:
        return f" + ({text})"
    return f" - {text[1:]}" if text.startswith("-") else f" + {text}"


def statement(text):
    """one statement over several lines"""
    words = text.split(" ")
    lines, line = [], " "*9
    for word in words:
        if len(line) + len(word) + 3 > LINE:
            lines.append(line + " &")
            line = " "*12
        line += (" " if line.strip() else "") + word
    return lines + [line]


def start(p):
    text = [
        "!> Generated by tools/series_table.py: not to be edited.",
        "!>",
        f"!> The series of the modified moments to degree {START} in h^2, for a block of bodies",
        "!> (docs/mathematics.md, section 3): what every step needs. The same statements serve a body class",
        "!> and bodies that all differ.",
        "module poinsot_body_series_start",
        "   use poinsot_core_kinds, only: dp, group, lanes",
        "   implicit none(type, external)",
        "   private",
        "   public :: start_degree, axis_series, start_series",
        "",
        f"   integer, parameter :: start_degree = {START} !! highest power of h^2 here",
        "   !> Coefficients of p^n in (1 + P)/2, and of r^n in (1 + R)/2: the same for all bodies.",
        f"   real(dp), parameter :: axis_series(0:{START}) = [ &"]
    text += fill([number(p[n][n][0, 0, 0]/2) for n in range(START + 1)], " "*6, "]")
    text += ["",
        "contains",
        "",
        "   !> Half of 1 + P and of 1 + R: coefficients (i, j) of p^i r^j, i + j <= 4, that differ from body",
        "   !> to body; no others are set.",
        "   pure subroutine start_series(nvec, b, c, a2, p, r)",
        "      integer, intent(in) :: nvec          !! groups of lanes to work on",
        "      real(dp), intent(in) :: b(lanes)     !! a1 a2",
        "      real(dp), intent(in) :: c(lanes)     !! a2 a3",
        "      real(dp), intent(in) :: a2(lanes)    !! (I3 - I1)/I2, sorted",
        f"      real(dp), intent(inout) :: p(lanes, 0:{START}, 0:{START}) !! of (1 + P)/2",
        f"      real(dp), intent(inout) :: r(lanes, 0:{START}, 0:{START}) !! of (1 + R)/2",
        "      integer :: l",
        "      !GCC$ ivdep",
        "      do l = 1, group*nvec"]
    for n in range(1, START + 1):
        for i in range(n - 1, -1, -1):
            j = n - i
            even = {(x, y): v/2 for (x, y, m), v in p[n][i].items() if m == 0}
            odd = {(x, y): v/2 for (x, y, m), v in p[n][i].items() if m == 1}
            for name, u, v, sign, place in (("p", "b(l)", "c(l)", "+", f"{i}, {j}"), ("r", "c(l)", "b(l)", "-", f"{j}, {i}")):
                value = horner(even, u, v)
                if odd:
                    value += f" {sign} a2(l)*{bracket(horner(odd, u, v))}"
                text += statement(f"{name}(l, {place}) = {value}")
    return text + ["      end do", "   end subroutine start_series", "", "end module poinsot_body_series_start"]


def main():
    p = correction(int(sys.argv[1]) if len(sys.argv) > 1 else 13)
    for name, text in (("series_table", table(p)), ("series_start", start(p))):
        with open(f"src/body/{name}.f90", "w", encoding="ascii") as file:
            file.write("\n".join(text) + "\n")


main()
