# CMake toolchain: for 64-bit ARM under Linux, by the cross compilers that Debian and Ubuntu have (gfortran-aarch64-linux-gnu), tests
# under qemu-user. LAPACK of that kind is looked for where those systems put it (liblapack-dev:arm64).
#
#    cmake -B build/aarch64 -DCMAKE_TOOLCHAIN_FILE=tools/install/aarch64.cmake -DPOINSOT_TARGET=portable
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_Fortran_COMPILER aarch64-linux-gnu-gfortran)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64;-L;/usr/aarch64-linux-gnu)
