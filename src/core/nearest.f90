!> The known name nearest to an unknown one, to be suggested in messages.
module poinsot_core_nearest
   implicit none(type, external)
   private
   public :: nearest_name, suggestion, known_names, edit_distance

   integer, parameter :: longest = 60 !! letters of an unknown name that are looked at

contains

   !> The second half of a refusal: "; the nearest known one is 'strang'", or nothing if no known
   !> name is near.
   pure function suggestion(name, known, opening, closing) result(text)
      character(*), intent(in) :: name              !! the unknown name, any case
      character(*), intent(in) :: known(:)          !! the names that would be right
      character(*), intent(in), optional :: opening !! what stands before a name, default '
      character(*), intent(in), optional :: closing !! what stands behind it, default '
      character(:), allocatable :: text
      text = nearest_name(name, known)
      if (text == "") return
      if (present(opening)) then
         text = opening//text
      else
         text = "'"//text
      end if
      if (present(closing)) then
         text = text//closing
      else
         text = text//"'"
      end if
      text = "; the nearest known one is "//text
   end function suggestion

   !> The second half of a refusal where names are few: "; there are: strang srkn6".
   pure function known_names(known) result(text)
      character(*), intent(in) :: known(:) !! the names that would be right
      character(:), allocatable :: text
      integer :: i
      text = "; there are:"
      do i = 1, size(known)
         text = text//" "//trim(known(i))
      end do
   end function known_names

   !> The known name that begins with this one, of three letters or more; else that with the
   !> smallest edit distance, the first of equals; "" if more than a third of the letters, rounded,
   !> would have to change.
   pure function nearest_name(name, known) result(nearest)
      character(*), intent(in) :: name     !! the unknown name, any case
      character(*), intent(in) :: known(:) !! the names that would be right
      character(:), allocatable :: nearest
      integer :: i, n, distance, least
      n = min(len_trim(name), longest)
      nearest = ""
      least = (n + 1)/3 + 1
      do i = 1, size(known)
         distance = edit_distance(name(:n), known(i))
         if (begins(known(i), name(:n))) distance = 0
         if (distance >= least) cycle
         least = distance
         nearest = trim(known(i))
      end do
   end function nearest_name

   !> Does a name begin with these letters, three or more?
   pure logical function begins(name, letters)
      character(*), intent(in) :: name, letters
      integer :: i
      begins = len_trim(letters) >= 3 .and. len_trim(letters) <= len_trim(name)
      do i = 1, len_trim(letters)
         if (begins) begins = same_letter(name(i:i), letters(i:i))
      end do
   end function begins

   !> Least number of letters to insert, delete, replace or, if they are neighbours, exchange
   !> (Levenshtein 1966, Damerau 1964); case and trailing blanks do not count.
   pure integer function edit_distance(a, b) result(distance)
      character(*), intent(in) :: a, b !! two words
      integer, dimension(0:len_trim(b)) :: row, next
      integer :: before(-1:len_trim(b))
      integer :: i, j
      row = [(j, j=0, len_trim(b))]
      before = 0
      do i = 1, len_trim(a)
         next(0) = i
         do j = 1, len_trim(b)
            next(j) = min(row(j) + 1, next(j - 1) + 1, &
               row(j - 1) + merge(0, 1, same_letter(a(i:i), b(j:j))))
            if (i == 1 .or. j == 1) cycle
            if (same_letter(a(i:i), b(j - 1:j - 1)) .and. same_letter(a(i - 1:i - 1), b(j:j))) then
               next(j) = min(next(j), before(j - 2) + 1)
            end if
         end do
         before(0:) = row
         row = next
      end do
      distance = row(len_trim(b))
   end function edit_distance

   pure logical function same_letter(a, b)
      character, intent(in) :: a, b
      same_letter = small(a) == small(b)
   end function same_letter

   pure character function small(letter)
      character, intent(in) :: letter
      integer :: code
      code = iachar(letter)
      if (code >= iachar("A") .and. code <= iachar("Z")) code = code + 32
      small = achar(code)
   end function small

end module poinsot_core_nearest
