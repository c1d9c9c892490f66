# poinsot: set up, build, test, install. `make help` lists what there is.
#
# Variables: FC             the Fortran compiler (gfortran)
#            MPI=1          of make build: also the app for several processes, build/mpi/poinsot; MPIFC its compiler (mpifort)
#            PORTABLE=1     for any processor of this architecture; TARGET=levels: x86-64, -v3 and -v4 in one
#                           installation, the loader chooses (by CMake); TARGET=x86-64-v3 and the like: that one
#            BUILDER        fpm or cmake; default: fpm if found, otherwise CMake
#            BUILD          the build folder (build); another one, for read-only sources, uses CMake
#            SETUP=no       install and fetch nothing; report what is missing
#            EXTRA_FLAGS    added to the compiler's flags
#            SUITE          of make test: the suite, or suite and test, to run
#            ROUTES         of make check-routes: only these, e.g. "cmake wheel" (listed at the top of tools/routes.sh)
#            PICTURES=no    of make demo: without gnuplot
#            PREFIX         of make install and uninstall: the prefix (/usr/local); DESTDIR in front of it; LIBDIR (lib) and
#                           MODDIR, of .mod files (include/poinsot), under PREFIX or absolute

ifeq ($(origin FC),default)
FC := gfortran
endif
PREFIX ?= /usr/local
DESTDIR ?=
LIBDIR ?= lib
MODDIR ?= include/poinsot
SUITE ?=
ROUTES ?=
MPI ?=
BUILD ?= build
export FC PORTABLE TARGET EXTRA_FLAGS PICTURES BUILDER BUILD SETUP

stage := $(BUILD)/stage
out := poinsot-out

.PHONY: all setup build demo test check-deep check-routes test-mpi bench lint gallery docs install uninstall clean distclean help
.NOTPARALLEL:

all: build

build: setup ## install what is missing; build library and app (into build/stage)
	@tools/build.sh stage
	@[ "$(MPI)" != 1 ] || tools/mpi.sh

demo: build ## build, then run the free body and the heavy top, with pictures and pages
	$(stage)/bin/poinsot run free-body --out $(out)/free-body
	$(stage)/bin/poinsot run heavy-top --out $(out)/heavy-top
	@echo; echo "Pages, for any browser, and pictures:"; ls -1 $(out)/free-body/view.html $(out)/heavy-top/view.html \
	   $(out)/free-body/*.svg $(out)/free-body/*.png $(out)/heavy-top/*.svg $(out)/heavy-top/*.png 2>/dev/null | sed 's/^/   /'

test: build ## build, then run the tests in two profiles; ends with "N passed, M failed"
	@tools/test.sh $(SUITE)

check-deep: build ## all tests, including long ones; sanitizers, valgrind, flags, coverage, flang, fuzzers; an hour on two cores
	@tools/test.sh --deep $(SUITE)
	@bench/assembly.sh
	@tools/deep.sh

check-routes: build ## every way to build and to link: CMake, FetchContent, fpm, Meson, levels, both MPIs, ...; code 77 if tools are missing
	@tools/routes.sh $(ROUTES)

test-mpi: ## set up MPI, build with MPI=1, run the tests of several processes
	@$(MAKE) --no-print-directory build MPI=1
	@test/mpi.sh

bench: build ## measure the speed of every method
	@if [ -x bench/run.sh ]; then bench/run.sh; else echo "no benchmark yet"; exit 1; fi

lint: setup ## fortitude, module names, warnings as errors
	@tools/lint.sh

gallery: build ## run every shipped scene, remake docs/gallery.md
	@tools/gallery.sh

docs: setup ## make the reference with FORD (into build/docs)
	@tools/docs.sh

install: build ## install under PREFIX (and DESTDIR)
	@tools/install.sh install "$(PREFIX)" "$(DESTDIR)" "$(LIBDIR)" "$(MODDIR)"

uninstall: ## remove installed files under PREFIX
	@tools/install.sh uninstall "$(PREFIX)" "$(DESTDIR)" "$(LIBDIR)" "$(MODDIR)"

clean: ## remove build products, but not tools and dependencies
	@find $(BUILD) -mindepth 1 -maxdepth 1 ! -name tools ! -name dependencies ! -name wheels -exec rm -rf {} + 2>/dev/null; true

distclean: ## remove everything that was not in the repository
	rm -rf build $(out)

help: ## this list
	@sed -n 's/^\([a-z-]*\):[^#]*## \(.*\)/   make \1|\2/p' Makefile | awk -F'|' '{ printf "%-22s %s\n", $$1, $$2 }'
	@sed -n '/^# Variables/,/^$$/s/^# //p' Makefile

setup:
	@tools/setup.sh build $(filter demo lint docs,$(MAKECMDGOALS)) $(if $(filter 1,$(MPI)),mpi) $(if $(filter check-deep,$(MAKECMDGOALS)),deep)
