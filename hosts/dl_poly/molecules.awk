# Input of DL_POLY Classic, CONFIG and FIELD, for 216 rigid molecules on a lattice, each turned in a way of its own:
#    awk -v what=water -f molecules.awk      SPC/E water, 18.62 A        awk -v what=co2 ...      EPM2 carbon dioxide, 25.08 A
# Lennard-Jones forces are shifted (snm), as the charges' are by `shift damp` in CONTROL: both go to zero smoothly.
function say(file, text) { print text > file }
function place(name, a) { # site at the body's vector a, turned and moved
   sites++
   say("CONFIG", sprintf("%-8s%10d", name, sites))
   say("CONFIG", sprintf("%20.12f%20.12f%20.12f", x + r[1]*a[1] + r[2]*a[2] + r[3]*a[3], \
      y + r[4]*a[1] + r[5]*a[2] + r[6]*a[3], z + r[7]*a[1] + r[8]*a[2] + r[9]*a[3]))
}
function turned(k,   a, b, c, d, n) { # the rotation of a quaternion from a generator of its own
   seed = 20060301 + k*7919
   a = chance(); b = chance(); c = chance(); d = chance(); n = sqrt(a*a + b*b + c*c + d*d)
   a /= n; b /= n; c /= n; d /= n
   r[1] = a*a + b*b - c*c - d*d; r[2] = 2*(b*c - a*d); r[3] = 2*(b*d + a*c)
   r[4] = 2*(b*c + a*d); r[5] = a*a - b*b + c*c - d*d; r[6] = 2*(c*d - a*b)
   r[7] = 2*(b*d - a*c); r[8] = 2*(c*d + a*b); r[9] = a*a - b*b - c*c + d*d
}
function chance() { seed = (seed*16807) % 2147483647; return seed/2147483647 - 0.5 }
BEGIN {
   edge = 6; box = what == "co2" ? 25.08 : 18.62
   half = 0.5*109.47*atan2(0, -1)/180
   say("CONFIG", "rigid " what)
   say("CONFIG", sprintf("%10d%10d", 0, 1))
   for (i = 0; i < 3; i++) say("CONFIG", sprintf("%20.12f%20.12f%20.12f", box*(i == 0), box*(i == 1), box*(i == 2)))
   for (k = 0; k < edge^3; k++) {
      x = box*((k % edge + 0.5)/edge - 0.5); y = box*((int(k/edge) % edge + 0.5)/edge - 0.5)
      z = box*((int(k/edge^2) + 0.5)/edge - 0.5)
      turned(k)
      if (what == "co2") {
         o[1] = 0; o[2] = 0; o[3] = 0; place("C", o); o[3] = 1.149; place("O", o); o[3] = -1.149; place("O", o)
      } else {
         o[1] = 0; o[2] = 0; o[3] = 0; place("OW", o)
         o[1] = sin(half); o[3] = cos(half); place("HW", o); o[1] = -sin(half); place("HW", o)
      }
   }
   say("FIELD", "rigid " what "\nunits kJ\nmolecules 1\n" what "\nnummols 216\natoms 3")
   if (what == "co2") say("FIELD", "C       12.011   0.6512  1\nO       15.9994 -0.3256  2")
   else say("FIELD", "OW      15.9994 -0.8476  1\nHW      1.008    0.4238  2")
   say("FIELD", "rigid 1\n3 1 2 3\nfinish")
   if (what == "co2") say("FIELD", "vdw 3\nC       C       snm 0.23388 12 6 3.09454 9.0\nC       O       snm 0.39579 12 6 3.24897 9.0\n" \
      "O       O       snm 0.66935 12 6 3.40339 9.0\nclose")
   else say("FIELD", "vdw 1\nOW      OW      snm 0.65020 12 6 3.55371 9.0\nclose")
}
