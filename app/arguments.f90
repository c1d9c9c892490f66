!> The command line as a list of words, and options taken out of it.
module app_arguments
   implicit none(type, external)
   private
   public :: word, word_list, command_words, option_value, is_option, append_word

   !> One word.
   type :: word
      character(:), allocatable :: text
   end type word

   !> Several.
   type :: word_list
      type(word), allocatable :: at(:)
   end type word_list

contains

   !> All arguments of the program.
   subroutine command_words(words)
      type(word_list), intent(out) :: words
      integer :: i, length
      allocate (words%at(command_argument_count()))
      do i = 1, size(words%at)
         call get_command_argument(i, length=length)
         allocate (character(length) :: words%at(i)%text)
         if (length > 0) call get_command_argument(i, words%at(i)%text)
      end do
   end subroutine command_words

   !> Does the word begin with a dash? A single dash does not count.
   pure logical function is_option(text)
      character(*), intent(in) :: text
      is_option = .false.
      if (len(text) > 1) is_option = text(1:1) == "-"
   end function is_option

   !> The value of an option at place i, "--name value" or "--name=value"; moves i to the last word
   !> used. Not found: no value follows.
   subroutine option_value(words, i, value, found)
      type(word_list), intent(in) :: words !! what follows the command
      integer, intent(inout) :: i
      character(:), allocatable, intent(out) :: value
      logical, intent(out) :: found
      integer :: equals
      equals = index(words%at(i)%text, "=")
      found = .true.
      if (equals > 0) then
         value = words%at(i)%text(equals + 1:)
      else if (i < size(words%at)) then
         i = i + 1
         value = words%at(i)%text
      else
         value = ""
         found = .false.
      end if
   end subroutine option_value

   !> A list with one more text.
   subroutine append_word(list, text)
      type(word), allocatable, intent(inout) :: list(:)
      character(*), intent(in) :: text
      type(word), allocatable :: more(:)
      allocate (more(size(list) + 1))
      more(:size(list)) = list
      more(size(more))%text = text
      call move_alloc(more, list)
   end subroutine append_word

end module app_arguments
