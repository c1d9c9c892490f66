!> Scenes at random: bodies, effects, length, outputs and tolerance, each a function of a number.
module test_random_scenes
   use poinsot_core_kinds, only: dp, i4, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_rotation_random, only: random_uniform
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_reader, only: scan_source
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_source, only: scene_source
   use poinsot_scene_text, only: text_of
   implicit none(type, external)
   private
   public :: random_scene, harder_scene, scene_from

contains

   !> A scene from its text.
   subroutine scene_from(text, name, scene, error)
      character(*), intent(in) :: text, name
      type(scene_settings), intent(out) :: scene
      type(poinsot_error), intent(inout) :: error
      type(scene_source) :: source
      call scan_source(text, name, source, error)
      if (.not. raised(error)) call build_scene(source, scene, error)
   end subroutine scene_from

   !> The k-th random scene, and its text.
   subroutine random_scene(k, scene, text, error)
      integer, intent(in) :: k
      type(scene_settings), intent(out) :: scene
      character(:), allocatable, intent(out) :: text
      type(poinsot_error), intent(inout) :: error
      real(dp) :: turn, t_end
      character(*), parameter :: break = new_line("a")
      ! one turn takes about 6; a scene has 1 to 12 of them
      turn = 6
      t_end = turn*12**draw(k, 1)
      text = "&scene t_end = " // text_of(t_end) // ", method = 'auto', tol = " // &
             text_of(10.0_dp**(-2 - 9*draw(k, 2))) // ", seed = " // text_of(k) // " /" // break
      text = text // bodies(k) // break // effects(k) // outputs(k, t_end)
      call scene_from(text, "random-" // text_of(k) // ".nml", scene, error)
   end subroutine random_scene

   !> The k-th of the scenes that are hard to promise for, and its text: in turn long motions of
   !> tops off their axes, most of them chaotic; many bodies, up to 20000; tops with friction.
   subroutine harder_scene(k, scene, text, error)
      integer, intent(in) :: k
      type(scene_settings), intent(out) :: scene
      character(:), allocatable, intent(out) :: text
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: break = new_line("a")
      real(dp) :: t_end, part(3), moments(3)
      character(:), allocatable :: group
      integer :: digits
      part = 0.1_dp + [draw(k, 10), draw(k, 11), draw(k, 12)]
      moments = (sum(part) - part)/maxval(sum(part) - part)
      group = "&bodies moments = " // text_of(moments)
      digits = 3 + int(8*draw(k, 2))
      select case (mod(k, 3))
      case (0)
         t_end = 40*8**draw(k, 1)
         digits = min(digits, 8)
         group = group // ", y = " // vector(k, 14, 1.0_dp) // " /" // break // &
            "&gravity centre = " // vector(k, 21, 0.3_dp + draw(k, 24)) // " /"
      case (1)
         t_end = 2*6**draw(k, 1)
         group = group // ", count = " // text_of(nint(1000*20**draw(k, 17))) // &
            ", random = 'thermal', temperature = 0.5 /" // break // "&gravity centre = " // &
            vector(k, 21, draw(k, 24)) // " /"
      case default
         t_end = 4*10**draw(k, 1)
         group = group // ", count = " // text_of(nint(10*draw(k, 17)) + 1) // &
            ", random = 'thermal', temperature = 1 /" // break // "&gravity centre = " // &
            vector(k, 21, draw(k, 24)) // " /" // break // "&drag friction = " // &
            text_of(0.5_dp*draw(k, 33)**2) // " /"
      end select
      text = "&scene t_end = " // text_of(t_end) // ", method = 'auto', tol = " // &
         text_of(10.0_dp**(-digits)) // ", seed = " // text_of(k) // " /" // break // group // break
      call scene_from(text, "harder-" // text_of(k) // ".nml", scene, error)
   end subroutine harder_scene

   !> The j-th number of scene k, in (0, 1).
   real(dp) function draw(k, j)
      integer, intent(in) :: k, j
      real(dp) :: u(2)
      u = random_uniform(20131_i8, int(k, i8), int(j, i8), 40_i4)
      draw = u(1)
   end function draw

   function vector(k, j, size_of) result(text)
      integer, intent(in) :: k, j
      real(dp), intent(in) :: size_of
      character(:), allocatable :: text
      real(dp) :: v(3)
      v = 2*[draw(k, j), draw(k, j + 1), draw(k, j + 2)] - 1
      text = text_of(size_of*v/norm2(v))
   end function vector

   !> One group of one body, or of many.
   function bodies(k) result(text)
      integer, intent(in) :: k
      character(:), allocatable :: text
      real(dp) :: part(3), moments(3)
      part = 0.05_dp + [draw(k, 10), draw(k, 11), draw(k, 12)]
      moments = sum(part) - part
      text = "&bodies moments = " // text_of(moments/maxval(moments))
      if (draw(k, 13) < 0.55_dp) then
         text = text // ", y = " // vector(k, 14, 1.0_dp) // " /"
      else
         text = text // ", count = " // text_of(1 + nint(300*draw(k, 17)**2)) // &
                ", random = 'thermal', temperature = 0.5 /"
      end if
   end function bodies

   !> None, one or two effects.
   function effects(k) result(text)
      integer, intent(in) :: k
      character(:), allocatable :: text
      character(*), parameter :: break = new_line("a")
      real(dp) :: u
      u = draw(k, 20)
      text = ""
      if (u < 0.15_dp) return
      if (u < 0.45_dp .or. u > 0.93_dp) then
         text = "&gravity centre = " // vector(k, 21, draw(k, 24)) // " /" // break
      else if (u < 0.6_dp) then
         text = "&gravity_gradient rate = " // text_of(draw(k, 24)) // " /" // break
      else if (u < 0.7_dp) then
         text = "&field dipole = " // vector(k, 21, 0.7_dp) // ", strength = 0, 0, 1, " // &
                "motion = 'rotating', frequency = " // text_of(draw(k, 24)) // &
                ", axis = 1, 0, 0 /" // break
      else if (u < 0.8_dp) then
         text = "&spring stiffness = " // text_of(draw(k, 24)) // ", axis = " // &
                vector(k, 25, 1.0_dp) // " /" // break
      else if (u < 0.88_dp) then
         text = "&gyrostat rotor = " // vector(k, 21, 0.4_dp) // " /" // break
      end if
      if (u < 0.88_dp) return
      text = text // "&field dipole = " // vector(k, 28, 0.5_dp) // &
         ", strength = 1, 0, 0 /" // break
   end function effects

   !> Outputs, for half of the scenes.
   function outputs(k, t_end) result(text)
      integer, intent(in) :: k
      real(dp), intent(in) :: t_end
      character(:), allocatable :: text
      text = ""
      if (draw(k, 30) < 0.5_dp) return
      text = "&output every = " // text_of(t_end/nint(4*30**draw(k, 31))) // &
         ", pictures = 'none' /" // new_line("a")
   end function outputs

end module test_random_scenes
