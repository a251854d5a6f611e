#include "envmap/io/formats.h"

#include <dlfcn.h>

#include <filesystem>

#include "envmap/error.h"

namespace envmap {
namespace {

namespace fs = std::filesystem;

// Not by the program's run path: that of a sanitizer's dlopen() is its own.
const Formats& load() {
  std::error_code error;
  const fs::path beside = fs::read_symlink("/proc/self/exe", error).parent_path(), name = "envmap-formats.so";
  for (const fs::path& place : {beside / name, beside / "../lib/envmap" / name, name}) {
    if (place.has_parent_path() && !fs::exists(place, error)) continue;
    void* module = ::dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (void* table = module ? ::dlsym(module, "envmap_formats") : nullptr) return *static_cast<const Formats*>(table);
    throw InputError(std::string("the module for formats other than EXR cannot be loaded: ") + ::dlerror());
  }
  throw InputError("no envmap-formats.so, which formats other than EXR need: install envmap again");
}

}  // namespace

const Formats& formats() {
  static const Formats& loaded = load();
  return loaded;
}

}  // namespace envmap
