!> The page that shows a motion: the search for its template, and `poinsot view`.
module app_view
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_files, only: is_folder
   use poinsot_scene_view, only: remake_view, page_name
   use app_arguments, only: word_list, is_option
   use app_codes, only: exit_ok, exit_usage, exit_runtime
   use app_find_scene, only: find_shared
   use app_terminal, only: say, print_error
   implicit none(type, external)
   private
   public :: find_template, remake_page

contains

   !> The template, "" if it is not beside this program (which is said).
   subroutine find_template(path, quiet)
      character(:), allocatable, intent(out) :: path
      logical, intent(in) :: quiet
      call find_shared(page_name, path)
      if (len(path) > 0 .or. quiet) return
      call print_error("no page of the motion: share/poinsot/" // page_name // " was not " // &
                       "found; set POINSOT_SHARE to the folder share/poinsot")
   end subroutine find_template

   !> `poinsot view FOLDER`: the page of an earlier run made anew. `done` is false if the one word
   !> is no folder: then it is a scene, to be run.
   subroutine remake_page(words, code, done)
      type(word_list), intent(in) :: words
      integer, intent(out) :: code
      logical, intent(out) :: done
      type(poinsot_error) :: error
      character(:), allocatable :: template
      code = exit_usage
      done = .true.
      if (size(words%at) == 0) then
         call print_error("view: no folder or scene given")
         return
      end if
      associate (folder => words%at(1)%text)
         done = .not. is_option(folder) .and. is_folder(folder)
         if (.not. done) return
         if (size(words%at) > 1) then
            call print_error("view: unexpected argument '" // words%at(2)%text // "'")
            return
         end if
         code = exit_runtime
         call find_template(template, .false.)
         if (len(template) == 0) return
         call remake_view(template, folder, error)
         if (raised(error)) then
            call print_error(error%message)
            return
         end if
         code = exit_ok
         call say(folder // "/" // page_name)
      end associate
   end subroutine remake_page

end module app_view
