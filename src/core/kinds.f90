!> Kinds and sizes shared by all modules.
module poinsot_core_kinds
   use, intrinsic :: iso_fortran_env, only: real32, real64, real128, real_kinds, int32, int64
   implicit none(type, external)
   private
   public :: sp, dp, qp, i4, i8, lanes, group, groups, name_length

   integer, parameter :: sp = real32  !! single precision: hosts that store it, never our arithmetic
   integer, parameter :: dp = real64  !! working precision
   !> Quadruple precision, or the longest there is where the compiler has no such numbers: tables
   !> and references, never a kernel.
   integer, parameter :: qp = merge(real128, maxval(real_kinds), real128 > 0)
   integer, parameter :: i4 = int32
   integer, parameter :: i8 = int64

   !> Bodies in a block. A kernel always works on all of them: there is no remainder loop, so
   !> a body's bits do not depend on its place. Four 512-bit vectors in flight; 32 (y, q) pairs are
   !> 1.8 kB of the first-level cache.
   integer, parameter :: lanes = 32
   !> A kernel may leave out whole groups of lanes at the end of a block: few bodies cost less, with
   !> the same bits.
   integer, parameter :: group = 8
   integer, parameter :: groups = lanes/group

   !> Of the names of methods, splittings and effects, everywhere.
   integer, parameter :: name_length = 24
end module poinsot_core_kinds
