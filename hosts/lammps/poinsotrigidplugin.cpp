// What LAMMPS's `plugin load` looks for: registers fix rigid/small/poinsot. A file of its own, because it can be loaded only into a
// LAMMPS that has the package RIGID.
#include "error.h"
#include "fix_rigid_small_poinsot.h"
#include "lammpsplugin.h"
#include "version.h"

#include <vector>

using namespace LAMMPS_NS;

// `method NAME` is ours, the rest LAMMPS's. Some keywords (langevin) ask for the style's own name: it goes by rigid/small while it is made.
static Fix *create(LAMMPS *lmp, int narg, char **arg) {
  std::string method = "exact", style = "rigid/small";
  std::vector<char *> rest;
  for (int i = 0; i < narg; i++) {
    if (i > 2 && std::string(arg[i]) == "method") {
      if (++i == narg) lmp->error->all(FLERR, "fix rigid/small/poinsot: method needs a name");
      method = arg[i];
    } else
      rest.push_back(i == 2 ? &style[0] : arg[i]);
  }
  auto *fix = new FixRigidSmallPoinsot(lmp, static_cast<int>(rest.size()), rest.data(), method);
  delete[] fix->style;
  fix->style = utils::strdup(arg[2]);
  return fix;
}

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle, void *regfunc) {
  lammpsplugin_t plugin{};
  plugin.version = LAMMPS_VERSION;
  plugin.style = "fix";
  plugin.name = "rigid/small/poinsot";
  plugin.info = "rigid/small with poinsot's free rotation";
  plugin.author = "the poinsot developers";
  plugin.creator.v2 = reinterpret_cast<lammpsplugin_factory2 *>(&create);
  plugin.handle = handle;
  reinterpret_cast<lammpsplugin_regfunc>(regfunc)(&plugin, lmp);
}
