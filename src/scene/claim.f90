!> Output files of a study (cost, hard, properties, reproduce) in a folder that may contain the
!> user's own files: a list says which are the program's, and only these are replaced.
module poinsot_scene_claim
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io
   use poinsot_scene_files, only: out_file, file_exists, make_folder, open_out, put, finish_out
   use poinsot_scene_folder, only: file_name, old_files, listed_files, is_one_of, &
      study_list, study_head
   implicit none(type, external)
   private
   public :: claim_files, picture_claims

   integer, parameter :: longest = 64

contains

   !> Make the folder, and note that these files in it are the program's from here on. Error:
   !> POINSOT_E_IO, and nothing changed, for one that is there and that no study or run wrote.
   subroutine claim_files(out, names, error)
      character(*), intent(in) :: out        !! the folder
      character(*), intent(in) :: names(:)   !! of files in it
      type(poinsot_error), intent(inout) :: error
      type(file_name), allocatable :: of_run(:), of_study(:)
      type(out_file) :: file
      integer :: i
      call make_folder(out, error)
      if (raised(error)) return
      call old_files(out // "/summary.txt", of_run)
      call listed_files(out // "/" // study_list, of_study)
      call check_name(study_list)
      do i = 1, size(names)
         call check_name(trim(names(i)))
      end do
      if (raised(error)) return
      call open_out(out // "/" // study_list, file, error)
      call put(file, study_head, error)
      do i = 1, size(of_study)
         if (of_study(i)%text /= study_list) call put(file, of_study(i)%text, error)
      end do
      do i = 1, size(names)
         if (.not. is_one_of(trim(names(i)), of_study)) call put(file, trim(names(i)), error)
      end do
      call finish_out(file, error)

   contains

      subroutine check_name(name)
         character(*), intent(in) :: name
         if (raised(error) .or. is_one_of(name, of_run) .or. is_one_of(name, of_study)) return
         if (file_exists(out // "/" // name)) call raise(error, poinsot_e_io, &
            out // "/" // name // ": this command would replace it, and no earlier one wrote " // &
            "it; move it away, or choose another --out")
      end subroutine check_name

   end subroutine claim_files

   !> What drawing pictures leaves in their folder: scripts, those that they load, pictures, logs.
   pure function picture_claims(pictures) result(names)
      character(*), intent(in) :: pictures(:)
      character(longest), allocatable :: names(:)
      integer :: i
      ! element by element: gfortran 12 writes beyond constructors of texts of several lengths
      allocate (names(4*(size(pictures) + 1)))
      names(1) = "common.gp"
      names(2) = "ends.gp"
      names(3) = "study.gp"
      names(4) = "cost_curves.gp"
      do i = 1, size(pictures)
         names(4*i + 1) = "plot_" // trim(pictures(i)) // ".gp"
         names(4*i + 2) = "plot_" // trim(pictures(i)) // ".log"
         names(4*i + 3) = trim(pictures(i)) // ".svg"
         names(4*i + 4) = trim(pictures(i)) // ".png"
      end do
   end function picture_claims

end module poinsot_scene_claim
