! A program outside the tree: the installed .mod files and library serve a Fortran host.
program consumer
   use poinsot_core_version, only: version_number, version_text
   use poinsot_core_status, only: poinsot_ok, status_text
   implicit none(type, external)
   if (version_number < 100 .or. len(version_text) == 0) error stop "no version"
   if (status_text(poinsot_ok) /= "ok") error stop "status text"
   print '(a)', "consumer: ok"
end program consumer
