// envmap.bake(): bake.h in Python's words.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace envmap;

std::vector<std::string> bake_map(const Map& map, const std::string& engine, const std::string& folder,
                                  const std::string& quality, std::optional<int> size, std::optional<int> chain_size,
                                  std::optional<double> max_error, double exposure,
                                  const std::optional<std::string>& depth, bool clamp, bool force, bool suns,
                                  const py::object& progress) {
  BakeOptions o{.size = size,
                .chain_size = chain_size,
                .quality = qualities[index_of_word("quality", quality, qualities, &Quality::name)],
                .max_error = max_error,
                .exposure = exposure,
                .write = {.clamp = clamp, .commit = {.force = force}}};
  if (depth) o.write.depth = depth_of(*depth);
  const Engine& wanted = engine_named(engine);
  return run_operation(progress, [=, &wanted](const Run& run) {
    BakeOptions options = o;
    if (suns) options.suns = find_lights(*map, {}, {.stop = run.stop, .threads = run.threads});
    if (suns && options.suns->lights.empty()) options.suns.reset();
    bake(map->clone(), wanted, folder, options, run);
    return files_of(wanted, options);
  });
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
  m.def("bake", &bake_map);
  m.def("engines", &engine_names);
  m.def("level_roughnesses", &roughnesses);
}

}  // namespace envmap_python
