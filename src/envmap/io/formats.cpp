#include "envmap/io/formats.h"

#include <dlfcn.h>

#include <filesystem>

#include "envmap/base/error.h"

namespace envmap {
namespace {

namespace fs = std::filesystem;

// Not by the program's run path: that of a sanitizer's dlopen() is its own.
const Formats& load() {
  std::error_code error;
  const fs::path beside = fs::read_symlink("/proc/self/exe", error).parent_path(), name = "envmap-formats.so";
  fs::path place = name;
  for (const fs::path& folder : {beside, beside / "../lib/envmap"})
    if (place == name && fs::exists(folder / name, error)) place = folder / name;
  void* module = ::dlopen(place.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (void* table = module ? ::dlsym(module, "envmap_formats") : nullptr) return *static_cast<const Formats*>(table);
  throw InputError(std::string("the module for formats other than EXR, HDR, KTX2 and DDS cannot be loaded: ") + ::dlerror());
}

}  // namespace

const Formats& formats() {
  static const Formats& loaded = load();
  return loaded;
}

}  // namespace envmap
