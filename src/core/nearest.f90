!> The known name nearest to one that is not known: the second half of every refusal of a name.
module poinsot_core_nearest
   implicit none(type, external)
   private
   public :: nearest_name, edit_distance

contains

   !> The known name that begins with this one, of three letters or more; else that with the
   !> smallest edit distance; the first of equals; "" if none is known.
   pure function nearest_name(name, known) result(nearest)
      character(*), intent(in) :: name     !! the unknown name, any case
      character(*), intent(in) :: known(:) !! the names that would be right
      character(:), allocatable :: nearest
      integer :: i, distance, least
      nearest = ""
      least = huge(least)
      do i = 1, size(known)
         distance = edit_distance(name, known(i))
         if (begins(known(i), name)) distance = 0
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

   !> Least number of letters to insert, delete or replace (Levenshtein 1966); case and trailing
   !> blanks do not count.
   pure integer function edit_distance(a, b) result(distance)
      character(*), intent(in) :: a, b !! two words
      integer :: row(0:len_trim(b)), i, j, diagonal, above
      row = [(j, j=0, len_trim(b))]
      do i = 1, len_trim(a)
         diagonal = row(0)
         row(0) = i
         do j = 1, len_trim(b)
            above = row(j)
            row(j) = min(above + 1, row(j - 1) + 1, &
               diagonal + merge(0, 1, same_letter(a(i:i), b(j:j))))
            diagonal = above
         end do
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
