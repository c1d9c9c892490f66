!> Long runs: short ones for every day, and those of a million periods.
module test_long
   use testdrive, only: new_unittest, unittest_type
   use test_long_energy, only: test_splittings, test_splittings_deep, test_rotors, test_rotors_deep
   use test_long_thermostat, only: test_thermostat, test_thermostat_deep
   use test_sampling, only: test_bias, test_bias_deep
   implicit none(type, external)
   private
   public :: collect_long, collect_long_deep

contains

   subroutine collect_long(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("energy-of-splittings", test_splittings), &
         new_unittest("energy-of-rotors", test_rotors), &
         new_unittest("thermostat-statistics", test_thermostat), &
         new_unittest("thermostat-bias", test_bias)]
   end subroutine collect_long

   !> A million periods of each: some minutes.
   subroutine collect_long_deep(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("energy-of-splittings-million-periods", test_splittings_deep), &
         new_unittest("energy-of-rotors-million-periods", test_rotors_deep), &
         new_unittest("thermostat-statistics-long", test_thermostat_deep), &
         new_unittest("thermostat-bias-table", test_bias_deep)]
   end subroutine collect_long_deep

end module test_long
