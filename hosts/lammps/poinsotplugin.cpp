// What LAMMPS's `plugin load` looks for: registers fix nve/poinsot.
#include "fix_nve_poinsot.h"
#include "lammpsplugin.h"
#include "version.h"

using namespace LAMMPS_NS;

static Fix *create(LAMMPS *lmp, int narg, char **arg) { return new FixNVEPoinsot(lmp, narg, arg); }

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle, void *regfunc) {
  lammpsplugin_t plugin{};
  plugin.version = LAMMPS_VERSION;
  plugin.style = "fix";
  plugin.name = "nve/poinsot";
  plugin.info = "ellipsoids by velocity Verlet with poinsot's free rotation";
  plugin.author = "the poinsot developers";
  plugin.creator.v2 = reinterpret_cast<lammpsplugin_factory2 *>(&create);
  plugin.handle = handle;
  reinterpret_cast<lammpsplugin_regfunc>(regfunc)(&plugin, lmp);
}
