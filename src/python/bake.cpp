// envmap.bake(): bake.h in Python's words.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace envmap;

std::vector<std::string> bake_map(const GivenMap& given, const std::string& engine, const std::filesystem::path& folder,
                                  const std::string& quality, std::optional<int> size, std::optional<int> chain_size,
                                  std::optional<double> max_error, double exposure,
                                  const std::optional<std::string>& depth, bool clamp, bool force,
                                  const py::object& progress) {
  BakeOptions o{.size = size,
                .chain_size = chain_size,
                .quality = qualities[index_of_word("quality", quality, qualities, &Quality::name)],
                .max_error = max_error,
                .exposure = exposure,
                .write = {.clamp = clamp, .commit = {.force = force}}};
  if (depth) o.write.depth = depth_of(*depth);
  const Engine& wanted = engine_named(engine);
  Reporter(progress).run([&](const Run& run) { return bake(given.map->clone(), wanted, folder.string(), o, run); });
  return files_of(wanted);
}

std::vector<std::string> engine_names() {
  std::vector<std::string> names;
  for (const Engine& e : engines()) names.emplace_back(e.name);
  return names;
}

std::vector<double> roughnesses(const std::string& engine, std::optional<int> size) {
  const EngineMap& map = chain_of(engine_named(engine));
  return level_roughnesses(map, size.value_or(map.chain->size));
}

}  // namespace

void add_bake(py::module_& m) {
  m.def("bake", &bake_map, "map"_a, "engine"_a, "folder"_a, py::kw_only(), "quality"_a = "normal",
        "size"_a = py::none(), "chain_size"_a = py::none(), "max_error"_a = py::none(), "exposure"_a = 0.0,
        "depth"_a = py::none(), "clamp"_a = false, "force"_a = false, "progress"_a = py::none(),
        document("bake",
                 "map, engine, folder, *, quality='normal', size=None, chain_size=None, max_error=None, exposure=0.0, "
                 "depth=None, clamp=False, force=False, progress=None",
                 "Writes the folder that an engine loads, whole or not at all, and returns the names of its files."));
  m.def("engines", &engine_names, document("engines", "", "The names of the engines that bake() knows."));
  m.def("level_roughnesses", &roughnesses, "engine"_a, "size"_a = py::none(),
        document("level_roughnesses", "engine, size=None",
                 "The roughness that the engine's shader looks for in each level of a chain whose first level has this "
                 "size: for prefilter(roughness=)."));
}

}  // namespace envmap_python
