#include "envmap/io/formats/openimageio_module.h"

#include <dlfcn.h>

#include <filesystem>

#include "envmap/base/error.h"
#include "envmap/base/system.h"

namespace envmap {
namespace {

namespace fs = std::filesystem;

// The folder of the shared library that this code is in; of a program the system may not know where it lies.
fs::path own_folder() {
  Dl_info info = {};
  return ::dladdr(reinterpret_cast<void*>(&own_folder), &info) != 0 ? fs::path(info.dli_fname).parent_path()
                                                                    : fs::path();
}

// Not by the program's run path: that of a sanitizer's dlopen() is its own.
const Formats& load() {
  std::error_code error;
  const fs::path program = own_program().parent_path(), library = own_folder();
  const fs::path name = "envmap-formats.so";
  fs::path place = name;
  for (const fs::path& folder :
       {program, program / ENVMAP_MODULES_FROM_PROGRAM, library, library / "envmap", fs::path(ENVMAP_MODULES)})
    if (place == name && folder.is_absolute() && fs::exists(folder / name, error)) place = folder / name;
  void* module = ::dlopen(place.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (void* table = module ? ::dlsym(module, "envmap_formats") : nullptr) return *static_cast<const Formats*>(table);
  if (place == name)
    throw InputError(
        "this format needs envmap-formats.so, which is not there: install it with envmap, or unpack the archive "
        "'-formats' over the folder of the portable envmap");
  throw InputError(std::string("cannot load envmap-formats.so, which reads and writes this format: ") + ::dlerror());
}

}  // namespace

const Formats& formats() {
  static const Formats& loaded = load();
  return loaded;
}

}  // namespace envmap
