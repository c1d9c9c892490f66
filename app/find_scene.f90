!> The search for scenes, by file or by name in the folders of scenes, and for other files that
!> belong to this program.
module app_find_scene
   use poinsot_core_nearest, only: suggestion
   use app_arguments, only: word, word_list
   use app_terminal, only: executable_folder, environment
   implicit none(type, external)
   private
   public :: find_scene, missing_scene, scene_folders, shipped_scenes, find_shared

   character(*), parameter :: ending = ".nml"

   !> The scenes that are shipped, in the order of the list.
   character(16), parameter :: shipped_scenes(19) = [character(16) :: &
      "free-body", "tennis-racket", "toutatis", "heavy-top", "sleeping-top", "lagrange", &
      "kovalevskaya", "gyrocompass", "satellite", "hyperion", "rotating-field", "kapitza", &
      "dipole-chain", "chaotic-pair", "own-potential", "gyrostat", "thermostat", "mixture", &
      "large-ensemble"]

contains

   !> The file of a scene: - is the standard input, `scene` itself if there is such a file, else
   !> NAME.nml in the folders.
   subroutine find_scene(scene, file, found)
      character(*), intent(in) :: scene
      character(:), allocatable, intent(out) :: file
      logical, intent(out) :: found
      type(word_list) :: folders
      logical :: is_folder
      integer :: i
      file = scene
      if (scene == "-") file = "/dev/stdin"
      inquire (file=file, exist=found)
      inquire (file=file // "/.", exist=is_folder)
      if (found .and. .not. is_folder .or. index(scene, "/") > 0) return
      call scene_folders(folders)
      do i = 1, size(folders%at)
         file = folders%at(i)%text // "/" // scene // ending
         if (folders%at(i)%text == ".") file = scene // ending
         inquire (file=file, exist=found)
         if (found) return
      end do
      file = scene
   end subroutine find_scene

   !> Message for a scene that was not found.
   function missing_scene(scene) result(message)
      character(*), intent(in) :: scene
      character(:), allocatable :: message
      if (any(shipped_scenes == scene)) then
         message = "the scene '" // scene // "' is a shipped scene, but was not found; set " // &
            "POINSOT_SCENES to the folder of the scenes"
      else
         message = "there is no file '" // scene // "' and no scene of that name" // &
            suggestion(scene, shipped_scenes) // " (poinsot scenes lists them)"
      end if
   end function missing_scene

   !> The folders, in the order they are searched.
   subroutine scene_folders(folders)
      type(word_list), intent(out) :: folders
      character(:), allocatable :: list, above
      integer :: colon, i
      folders%at = [word(".")]
      list = environment("POINSOT_SCENES")
      do while (len(list) > 0)
         colon = index(list // ":", ":")
         if (colon > 1) call add(folders, list(:colon - 1))
         list = list(min(colon, len(list)) + 1:)
      end do
      above = executable_folder() ! without links and dots, so folders go up name by name
      do i = 1, 4 ! PREFIX/bin; build/COMPILER_HASH/app, build/stage/bin
         above = above(:max(index(above, "/", back=.true.) - 1, 0))
         if (i == 1) call add(folders, above // "/share/poinsot/scenes")
         call add(folders, above // "/scenes")
      end do
   end subroutine scene_folders

   !> A folder or file of share/poinsot by its name there: in POINSOT_SHARE, else in PREFIX or the
   !> source tree that this program stands in; "" if it is not found.
   subroutine find_shared(name, path)
      character(*), intent(in) :: name
      character(:), allocatable, intent(out) :: path
      character(:), allocatable :: above
      logical :: found
      integer :: i
      above = executable_folder()
      path = environment("POINSOT_SHARE") // "/" // name
      do i = 0, 4 ! as in scene_folders
         if (len(path) > len(name) + 1) then
            inquire (file=path, exist=found)
            if (found) return
         end if
         above = above(:max(index(above, "/", back=.true.) - 1, 0))
         path = above // "/share/poinsot/" // name
      end do
      path = ""
   end subroutine find_shared

   !> One more, if it is a folder.
   subroutine add(folders, name)
      type(word_list), intent(inout) :: folders
      character(*), intent(in) :: name
      type(word), allocatable :: more(:)
      logical :: there
      inquire (file=name // "/.", exist=there)
      if (.not. there) return
      allocate (more(size(folders%at) + 1))
      more(:size(folders%at)) = folders%at
      more(size(more))%text = name
      call move_alloc(more, folders%at)
   end subroutine add

end module app_find_scene
