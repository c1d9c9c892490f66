# DL_POLY Classic's source with poinsot's calls in it: vv_rotation1_module.f and vv_rotation2_module.f in, the same out.
#
#   - a loop that does nothing but turn each body by NOSQUISH becomes one call for all of them; where a loop does more, the call
#     in it becomes one for that body;
#   - with -v stages=1, in routine nveqvv_1: lengths of kicks and drifts come from POINSOT_STAGE.
# At the end of standard error: how many calls were replaced.

function turn(indent, first, last, h) {
   printf "%scall poinsot_turn(%s,%s,ngrp,%s,\n", indent, first, last, h
   printf "     x  mxungp,rotinx,rotiny,rotinz,lstgtp,\n"
   printf "     x  q0,q1,q2,q3,p0,p1,p2,p3)\n"
   calls++
}

# A line on its own.
function show(line) {
   if (line ~ /call nosquish\(ig,/) {
      match(line, / *call/)
      turn(substr(line, 1, RLENGTH - 4), "ig", "ig", routine == "nveqvv_1" && stages ? "hdrift" : "tstep")
   } else if (routine == "nveqvv_1" && stages) {
      gsub(/pt5\*tstep/, "hkick", line)
      if (line ~ /^ +(gcm[xyz]\(ig\)|[xyz][xyz][xyz]\(i\))=.*\+tstep\*/) sub(/\+tstep\*/, "+hdrift*", line)
      print line
      if (line ~ /^ +implicit none/) print "      real(8) hkick,hdrift"
      if (line ~ /^ +newjob=.false./) print "      call poinsot_stage(isw,tstep,hkick,hdrift)"
      if (line ~ /if\(isw.eq.1\)then/) marks++
   } else
      print line
}

function flush_held(   i) {
   for (i = 1; i <= held; i++) show(hold[i])
   held = 0
}

/^ +subroutine / { routine = $2; sub(/\(.*/, "", routine) }
/^ +do ig=igrp1,igrp2/ { flush_held(); hold[held = 1] = $0; others = 0; found = 0; next }
held {
   hold[++held] = $0
   if ($0 ~ /call nosquish\(ig,/) found = 1
   else if ($0 ~ /^ +enddo/) {
      if (found && !others) {
         match(hold[1], / *do/)
         turn(substr(hold[1], 1, RLENGTH - 2), "igrp1", "igrp2", routine == "nveqvv_1" && stages ? "hdrift" : "tstep")
         held = 0
      } else flush_held()
   } else if ($0 !~ /^ *$/ && $0 !~ /^c/) { others = 1; flush_held() }
   next
}
{ show($0) }
END { flush_held(); print FILENAME ": " calls + 0 " calls of poinsot_turn" > "/dev/stderr" }
