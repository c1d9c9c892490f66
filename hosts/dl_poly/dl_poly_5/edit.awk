# One of DL_POLY 5's integrators (nve.F90) in, the same with poinsot's calls out. In the first stage's loop over rigid bodies the call of
# no_squish, which goes over several lines, becomes: keep the momentum and the force, end of the loop, turn all, a second loop that takes
# them back. At the end of standard error: how many calls were replaced.
/^ *Use rigid_bodies/ && !used { print "  Use poinsot_rigid,   Only: poinsot_begin, poinsot_keep, poinsot_take, poinsot_turn"; used = 1 }
/! update velocity and position of RBs/ { print; print "      Call poinsot_begin(rigid)"; begun = 1; next }
/Call no_squish/ && begun {
   while ($0 ~ /& *$/) getline # to the end of the statement
   print "          Call poinsot_keep(irgd, tstep, rigid, p0, p1, p2, p3, fmx, fmy, fmz)"
   print "        End If"
   print "      End Do"
   print "      Call poinsot_turn(tstep, rigid)"
   print "      Do irgd = 1, rigid%n_types"
   print "        rgdtyp = rigid%list(0, irgd)"
   print "        lrgd = rigid%list(-1, irgd)"
   print "        If (rigid%frozen(0, rgdtyp) < lrgd) Then"
   print "          Call poinsot_take(irgd, p0, p1, p2, p3, fmx, fmy, fmz)"
   calls++
   next
}
/^ +no_squish,&/ { next }
{ print }
END {
   print FILENAME ": " calls + 0 " calls replaced" > "/dev/stderr"
   exit calls != 1
}
