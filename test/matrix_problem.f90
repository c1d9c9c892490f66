!> Problems of the matrix of entries: bodies, effects with their settings, a start, each a function
!> of a number; and the same problem put in another frame of the bodies. All that is known of an
!> effect here is the description of its keys: a new one needs no line.
module test_matrix_problem
   use poinsot_core_kinds, only: dp, i8
   use poinsot_effect_registry, only: effect_count, describe_effect
   use poinsot_effect_settings, only: setting, effect_info, effect_key, number_setting, &
      text_setting, class_vectors, per_axis
   use poinsot_scene_text, only: text_of
   use test_oracle_algebra, only: cross, quaternion_product, rotate
   implicit none(type, external)
   private
   public :: problem, acting, n, classes, steps, h, new_problem, with_rotor, random_frame, &
      permuted_frame, put_in_frame, settings_text, has_effect, total_rotor, in_table, values_of, &
      tensor_of, matrix_of

   integer, parameter :: n = 3, classes = n     !! body i is of class i, as a scene has it
   integer, parameter :: steps = 16
   real(dp), parameter :: h = 0.03125_dp        !! a power of two: no scene shortens it

   !> One effect and what is said about it.
   type :: acting
      character(:), allocatable :: name
      type(setting), allocatable :: settings(:)
      integer :: class = 0
   end type acting

   !> What every entry is told, in the body frame `frame`: x_frame = frame x_principal.
   type :: problem
      integer :: number = 0
      type(acting), allocatable :: effects(:)
      real(dp) :: principal(3, classes) = 0     !! moments along the principal axes
      real(dp) :: frame(3, 3) = 0
      logical :: by_tensor = .false.            !! else the frame is principal, of any order
      logical :: hosted = .false.               !! the host's own torque acts: a top's
      real(dp) :: centre(3) = 0                 !! of that top
      real(dp) :: y(3, n) = 0, q(4, n) = 0      !! start
      logical :: per_axis = .false.             !! an effect has numbers for each axis of the frame
      integer(i8) :: state = 0                  !! of the draws
   end type problem

contains

   !> Problem number k: the effects of these numbers in the registry, in that order; `attempt` draws
   !> other settings.
   function new_problem(k, attempt, numbers) result(made)
      integer, intent(in) :: k, attempt, numbers(:)
      type(problem) :: made
      type(effect_info) :: info
      type(acting), allocatable :: one
      integer :: i
      made%number = k
      made%state = 7919_i8*k + 104729_i8*attempt + 12345
      call draw_bodies(made)
      allocate (made%effects(0))
      do i = 1, size(numbers)
         info = describe_effect(numbers(i))
         if (info%name == "callback") then
            made%hosted = .true.
            made%centre = vector(made)
            cycle
         end if
         one = draw_effect(made, info, attempt)
         made%effects = [made%effects, one]
      end do
   end function new_problem

   !> Moments of asymmetric, symmetric, flat and spherical bodies, momenta and attitudes.
   subroutine draw_bodies(this)
      type(problem), intent(inout) :: this
      real(dp) :: part(3)
      integer :: i
      do i = 1, classes
         part = [0.2_dp + draw(this), 0.2_dp + draw(this), 0.2_dp + draw(this)]
         select case (int(8*draw(this)))
         case (0); part(2) = part(1)
         case (1); part = part(1)
         case (2); part(1) = 0
         case default ! generic
         end select
         this%principal(:, i) = sum(part) - part
      end do
      do i = 1, n
         this%y(:, i) = vector(this)
         this%q(:, i) = [vector(this), 2*draw(this) - 1]
         this%q(:, i) = this%q(:, i)/norm2(this%q(:, i))
      end do
      do i = 1, 3
         this%frame(i, i) = 1
      end do
   end subroutine draw_bodies

   !> What is required, each body vector that has a default (it would be another vector in another
   !> frame), and of the rest what chance takes; less of it from attempt to attempt.
   function draw_effect(this, info, attempt) result(made)
      type(problem), intent(inout) :: this
      type(effect_info), intent(in) :: info
      integer, intent(in) :: attempt
      type(acting) :: made
      real(dp) :: chance
      integer :: k
      logical :: needed
      made%name = trim(info%name)
      allocate (made%settings(0))
      do k = 1, size(info%keys)
         associate (key => info%keys(k))
            needed = key%default == "required" .or. (key%frame /= "" .and. key%default /= "")
            chance = draw(this)*(1 + 0.1_dp*attempt)
            if (.not. needed .and. chance > 0.5_dp) cycle
            if (key%name == "class") then
               made%class = int((classes + 1)*draw(this))
               made%settings = [made%settings, number_setting("class", [real(made%class, dp)])]
            else if (.not. key%is_text) then
               made%settings = [made%settings, number_setting(trim(key%name), numbers(this, key))]
            else if (key%units /= "") then
               made%settings = [made%settings, text_setting(trim(key%name), choice(this, key))]
            end if
         end associate
      end do
      call drop_replaced(info, made%settings)
   end function draw_effect

   !> A vector in whose place a table in time was drawn is not given.
   subroutine drop_replaced(info, settings)
      type(effect_info), intent(in) :: info
      type(setting), allocatable, intent(inout) :: settings(:)
      type(setting), allocatable :: kept(:)
      integer :: i, k
      do k = 1, size(info%keys)
         if (info%keys(k)%name /= "table" .or. info%keys(k)%instead_of == "") cycle
         if (.not. any([(settings(i)%key == "table", i=1, size(settings))])) return
         allocate (kept(0))
         do i = 1, size(settings)
            if (settings(i)%key /= info%keys(k)%instead_of) kept = [kept, settings(i)]
         end do
         call move_alloc(kept, settings)
      end do
   end subroutine drop_replaced

   !> As many numbers as a key takes: at least, at most, or for every body and class.
   function numbers(this, key) result(values)
      type(problem), intent(inout) :: this
      type(effect_key), intent(in) :: key
      real(dp), allocatable :: values(:)
      real(dp) :: turn
      integer :: count, i
      count = key%least
      if (draw(this) < 0.5_dp) count = key%most
      if (count < 0) count = key%least*merge(classes, n, key%frame == class_vectors)
      allocate (values(count))
      do i = 1, count
         if (key%units == "time") then
            values(i) = 4*i*h   ! knots of tables at ends of steps: within them the order is 2
            if (i == 2 .and. draw(this) < 0.4_dp) values(2) = values(1) ! a jump
            cycle
         end if
         values(i) = 0.2_dp + 0.6_dp*draw(this)
         turn = draw(this)
         if (count > 1 .and. key%frame /= per_axis .and. turn < 0.5_dp) values(i) = -values(i)
         ! bodies not so near to each other that steps are long beside their motion
         if (key%units == "length" .and. count == 1) values(i) = 3*values(i)
         if (key%units == "length" .and. key%most < 0 .and. mod(i, 3) == 1) then
            values(i) = values(i) + real(2*i, dp)/3
         end if
      end do
      if (key%frame == per_axis .and. count == 3) this%per_axis = .true.
   end function numbers

   function choice(this, key) result(word)
      type(problem), intent(inout) :: this
      type(effect_key), intent(in) :: key
      character(:), allocatable :: word
      integer :: skip, at
      word = trim(key%units)
      do skip = int(3*draw(this)), 1, -1
         at = index(word, " ")
         if (at > 0) word = word(at + 1:)
      end do
      word = word(:index(word//" ", " ") - 1)
   end function choice

   !> The same bodies with a wheel on all of them.
   subroutine with_rotor(this)
      type(problem), intent(inout) :: this
      type(acting) :: wheel
      wheel%name = "gyrostat"
      wheel%settings = [number_setting("rotor", vector(this))]
      this%effects = [this%effects, wheel]
   end subroutine with_rotor

   !> Axes in another order, some turned round: a rotation.
   function permuted_frame(this) result(r)
      type(problem), intent(inout) :: this
      real(dp) :: r(3, 3)
      integer :: i, j
      i = 1 + int(3*draw(this))
      j = 1 + mod(i + int(2*draw(this)), 3)
      r = 0
      r(i, 1) = sign(1.0_dp, draw(this) - 0.5_dp)
      r(j, 2) = sign(1.0_dp, draw(this) - 0.5_dp)
      r(:, 3) = cross(r(:, 1), r(:, 2))
   end function permuted_frame

   function random_frame(this) result(r)
      type(problem), intent(inout) :: this
      real(dp) :: r(3, 3), q(4)
      q = [vector(this), 0.7_dp*draw(this)]
      r = matrix_of(q/norm2(q))
   end function random_frame

   !> The same problem with bodies described in another frame: x_new = r x_old. Numbers for each
   !> axis go by the axes, which only a frame of permuted axes can follow; else they stay, and the
   !> problem is another one.
   function put_in_frame(this, r, by_tensor) result(made)
      type(problem), intent(in) :: this
      real(dp), intent(in) :: r(3, 3)
      logical, intent(in) :: by_tensor
      type(problem) :: made
      integer :: i
      real(dp) :: q(4)
      made = this
      made%by_tensor = by_tensor
      made%frame = matmul(r, this%frame)
      made%centre = matmul(r, this%centre)
      do i = 1, size(made%effects)
         call put_settings(made%effects(i), r)
      end do
      q = quaternion_of(r)
      do i = 1, n
         made%y(:, i) = matmul(r, this%y(:, i))
         made%q(:, i) = quaternion_product(this%q(:, i), [q(1), -q(2:4)])
      end do
   end function put_in_frame

   subroutine put_settings(this, r)
      type(acting), intent(inout) :: this
      real(dp), intent(in) :: r(3, 3)
      type(effect_info) :: info
      integer :: i, j, k
      info = describe_effect(index_of(this%name))
      do k = 1, size(info%keys)
         if (info%keys(k)%frame == "") cycle
         if (info%keys(k)%frame_key /= "") then
            if (said(this%settings, trim(info%keys(k)%frame_key)) == "space") cycle
         end if
         do i = 1, size(this%settings)
            if (this%settings(i)%key /= info%keys(k)%name) cycle
            associate (v => this%settings(i)%values)
               if (info%keys(k)%frame == per_axis) then
                  if (size(v) == 3 .and. count(abs(r) > 0.5_dp) == 3 .and. &
                     all(abs(r - anint(r)) <= 0)) v = matmul(abs(r), v)
               else
                  do j = 1, size(v) - 2, 3
                     v(j:j + 2) = matmul(r, v(j:j + 2))
                  end do
               end if
            end associate
         end do
      end do
   end subroutine put_settings

   !> key = values; ..., in full digits, as C and fixed form take it, or as a group of a scene.
   function settings_text(this, in_scene) result(text)
      type(acting), intent(in) :: this
      logical, intent(in) :: in_scene
      character(:), allocatable :: text
      integer :: i
      text = ""
      do i = 1, size(this%settings)
         if (i > 1) text = text//merge(", ", "; ", in_scene)
         text = text//this%settings(i)%key//" = "
         if (allocated(this%settings(i)%text)) then
            text = text//"'"//this%settings(i)%text//"'"
         else
            text = text//text_of(this%settings(i)%values)
         end if
      end do
      if (in_scene) text = "&"//this%name//" "//text//" /"//new_line("a")
   end function settings_text

   !> Is there an effect of this name?
   pure logical function has_effect(this, name)
      type(problem), intent(in) :: this
      character(*), intent(in) :: name
      integer :: i
      has_effect = .false.
      do i = 1, size(this%effects)
         if (this%effects(i)%name == name) has_effect = .true.
      end do
   end function has_effect

   !> The momentum of all wheels of a class at time t; of one that jumps there, what it has at time
   !> `within`.
   pure function total_rotor(this, class, t, within) result(s)
      type(problem), intent(in) :: this
      integer, intent(in) :: class
      real(dp), intent(in) :: t, within
      real(dp) :: s(3)
      integer :: i, k
      s = 0
      do i = 1, size(this%effects)
         if (this%effects(i)%name /= "gyrostat") cycle
         if (this%effects(i)%class /= 0 .and. this%effects(i)%class /= class) cycle
         do k = 1, size(this%effects(i)%settings)
            if (this%effects(i)%settings(k)%key == "rotor") s = s + &
               this%effects(i)%settings(k)%values
            if (this%effects(i)%settings(k)%key == "table") s = s + in_table( &
               values_of(this%effects(i), "times"), this%effects(i)%settings(k)%values, t, within)
         end do
      end do
   end function total_rotor

   !> A table at time t: linear in the piece that holds the time `within`.
   pure function in_table(times, table, t, within) result(v)
      real(dp), intent(in) :: times(:), table(:), t, within
      real(dp) :: v(3)
      integer :: k
      k = count(times <= within)
      v = table(3*max(k, 1) - 2:3*max(k, 1))
      if (k < 1 .or. k == size(times)) return
      v = v + (table(3*k + 1:3*k + 3) - v)*((t - times(k))/(times(k + 1) - times(k)))
   end function in_table

   pure function values_of(this, key) result(values)
      type(acting), intent(in) :: this
      character(*), intent(in) :: key
      real(dp), allocatable :: values(:)
      integer :: i
      allocate (values(0))
      do i = 1, size(this%settings)
         if (this%settings(i)%key == key) values = this%settings(i)%values
      end do
   end function values_of

   !> J to the power +1 or -1 of a class, in the frame.
   pure function tensor_of(this, class, power) result(j)
      type(problem), intent(in) :: this
      integer, intent(in) :: class, power
      real(dp) :: j(3, 3)
      j = matmul(this%frame*spread(this%principal(:, class)**power, 1, 3), transpose(this%frame))
   end function tensor_of

   !> The number of an effect in the registry.
   integer function index_of(name) result(i)
      character(*), intent(in) :: name
      type(effect_info) :: info
      do i = 1, effect_count
         info = describe_effect(i)
         if (info%name == name) return
      end do
      error stop "matrix: no such effect"
   end function index_of

   pure function said(settings, key) result(word)
      type(setting), intent(in) :: settings(:)
      character(*), intent(in) :: key
      character(:), allocatable :: word
      integer :: i
      word = ""
      do i = 1, size(settings)
         if (settings(i)%key == key .and. allocated(settings(i)%text)) word = settings(i)%text
      end do
   end function said

   function vector(this) result(v)
      type(problem), intent(inout) :: this
      real(dp) :: v(3)
      integer :: i
      do i = 1, 3
         v(i) = 2*draw(this) - 1
      end do
      v = v*(0.3_dp + 0.6_dp*draw(this))/norm2(v)
   end function vector

   !> The next number, in (0, 1).
   real(dp) function draw(this)
      type(problem), intent(inout) :: this
      integer :: i
      do i = 1, 3
         this%state = iand(this%state*1103515245_i8 + 12345_i8, 2147483647_i8)
      end do
      draw = (real(this%state, dp) + 0.5_dp)/2147483648.0_dp
   end function draw

   !> Columns: the body axes in space.
   pure function matrix_of(q) result(r)
      real(dp), intent(in) :: q(4)
      real(dp) :: r(3, 3), e(3)
      integer :: j
      do j = 1, 3
         e = 0
         e(j) = 1
         r(:, j) = rotate(q, e)
      end do
   end function matrix_of

   !> The quaternion of a rotation: of four that are proportional to it, each with one component
   !> twice as its scale, the longest.
   pure function quaternion_of(r) result(q)
      real(dp), intent(in) :: r(3, 3)
      real(dp) :: q(4), all(4, 4), a(3)
      a = [r(3, 2) - r(2, 3), r(1, 3) - r(3, 1), r(2, 1) - r(1, 2)]
      all(:, 1) = [1 + r(1, 1) + r(2, 2) + r(3, 3), a]
      all(:, 2) = [a(1), 1 + r(1, 1) - r(2, 2) - r(3, 3), r(1, 2) + r(2, 1), r(1, 3) + r(3, 1)]
      all(:, 3) = [a(2), r(1, 2) + r(2, 1), 1 - r(1, 1) + r(2, 2) - r(3, 3), r(2, 3) + r(3, 2)]
      all(:, 4) = [a(3), r(1, 3) + r(3, 1), r(2, 3) + r(3, 2), 1 - r(1, 1) - r(2, 2) + r(3, 3)]
      q = all(:, maxloc(sum(all**2, 1), 1))
      q = q/norm2(q)
   end function quaternion_of

end module test_matrix_problem
