#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "commands/tradeoff/tasks.h"
#include "engines/engine_options.h"
#include "envmap/base/error.h"
#include "envmap/engine/baked_maps.h"
#include "envmap/engine/engines.h"
#include "envmap/engine/level_roughness.h"
#include "envmap/io/files/scratch_file.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/io/texels/rounding.h"
#include "envmap/operate/convert.h"

namespace tools {
namespace {

using namespace envmap;

constexpr double closer = 0.1;  // The reference is, than what a quality asks for.

// ---- the reference --------------------------------------------------------------------------------------------------

// Each level as float64 has it, nearly, at the size that it has in the file. Made once for each size.
class Truths {
 public:
  explicit Truths(const EnvironmentMap& source) : source_(source), prepared_(borrowed(source)) {}

  const Level& of(const EngineMap& map, double roughness, int size, double error) {
    const auto key = std::tuple(map.file, roughness, size, error);
    const auto known = levels_.find(key);
    return known != levels_.end() ? known->second
                                  : levels_.emplace(key, made(map, roughness, size, error)).first->second;
  }

 private:
  [[nodiscard]] Level made(const EngineMap& map, double roughness, int size, double error) const {
    const bool lobe = map.diffuse > 0 || roughness > 0;
    const Level level =
        lobe ? std::move(prepared_.make(options_of(map, roughness, size, error)).map.base())
             : level_of(Resampler(source_, {.to = map.frame, .size = size, .filter = Filter::area, .area_error = 1e-6})
                            .rows());
    return level_of(mirrored({rows_of(level, map.frame.forward)}, map.mirror).front());
  }
  static PrefilterOptions options_of(const EngineMap& map, double roughness, int size, double error) {
    PrefilterOptions wanted{.to = map.frame.projection, .size = size, .forward = map.frame.forward, .max_error = error};
    if (map.diffuse == 0) wanted.lobe = Lobe::ggx(roughness);
    return wanted;
  }

  const EnvironmentMap& source_;
  Prefilterer prepared_;
  std::map<std::tuple<std::string_view, double, int, double>, Level> levels_;
};

// ---- a folder -------------------------------------------------------------------------------------------------------

struct Baking {
  const Engine& engine;
  const Source& source;
  Truths truths{source.map};

  [[nodiscard]] WriteOptions how(const EngineMap& map, std::optional<Depth> depth) const {
    WriteOptions how{.depth = depth ? depth : map.depth, .clamp = true};
    how.source_depth = is_integer(source.depth) ? Depth::half : source.depth;
    how.provenance = source.provenance;
    how.zstd = map.zstd;
    return how;
  }

  // Whether all files hold it.
  [[nodiscard]] bool is_possible(Depth depth) const try {
    for (const EngineMap& map : engine.maps)
      if (map.only_depth) return false;
    for (const EngineMap& map : engine.maps)
      check_output(std::string(map.file), how(map, depth), map.frame.projection, map.chain.has_value());
    return true;
  } catch (const Error&) {
    return false;
  }

  [[nodiscard]] Outcome bake(const Quality& quality, std::optional<Depth> depth) const {
    const BakeOptions wanted{.quality = quality};
    Baker maker(source.map, wanted);
    Outcome out{.level = Level(Projection::latlong, 1), .bytes = 0};
    for (const EngineMap& map : engine.maps) {
      auto file = std::make_shared<const ScratchFile>(extension_of(map.file));
      WriteOptions options = how(map, depth);
      const BakedMap made = maker.make(map, rounding_of(file->path(), options));
      options.pairs = made.pairs, options.facts = made.facts;
      write(file->path(), made.rows, options);
      *out.bytes += std::int64_t(std::filesystem::file_size(file->path()));
      out.files.push_back(std::move(file));
    }
    return out;
  }

  // The worst of all levels of all files.
  [[nodiscard]] Difference judge(const Outcome& out, const Quality& quality) {
    Difference worst{};
    for (std::size_t k = 0; k < engine.maps.size(); ++k) {
      const EngineMap& map = engine.maps[k];
      const ReadOptions all{.projection = map.frame.projection,
                            .flaws = FlawPolicy::keep,
                            .all_levels = map.chain.has_value()};
      const Source read_back = read(out.files[k]->path(), all);
      const std::vector<Level>& levels = read_back.map.levels;
      const std::vector<double> roughnesses =
          map.chain ? level_roughnesses(map, levels.front().height(), {}, "--chain-size") : std::vector<double>{0};
      for (std::size_t level = 0; level < roughnesses.size(); ++level) {
        const Difference d = compare(levels[level], truths.of(map, roughnesses[level], levels[level].height(),
                                                              closer * quality.max_error));
        worst.maximum = std::max(worst.maximum, d.maximum), worst.rms = std::max(worst.rms, d.rms);
        if (d.largest_flux() > worst.largest_flux()) worst.flux = d.flux;
      }
    }
    return worst;
  }
};

}  // namespace

Task make_bake_task(const std::string& name, const Source& source) {
  const std::vector<std::string> parts = parts_of(name);
  const Engine* const engine = find_engine(parts.size() == 2 ? parts[1] : "");
  if (engine == nullptr) throw UsageError(fmt::format("--task {}: bake:ENGINE, one of {}", name, engine_names()));
  const auto baking = std::shared_ptr<Baking>(new Baking{*engine, source});
  Task task{.name = name,
            .reference =
                "area to 1e-6, and lobes within a tenth of what the quality asks for, at each file's own size"};
  const auto add = [&](const Quality& quality, std::optional<Depth> depth) {
    task.ways.push_back({fmt::format("--quality {}", quality.name),
                         depth ? fmt::format("--depth {}", envmap::name(*depth)) : "",
                         [baking, quality, depth] { return baking->bake(quality, depth); },
                         [baking, quality](const Outcome& out) { return baking->judge(out, quality); }});
  };
  for (const Quality& quality : qualities) {
    add(quality, {});
    for (const Depth depth : {Depth::rgb9e5, Depth::bc6h, Depth::half, Depth::single})
      if (baking->is_possible(depth)) add(quality, depth);
  }
  return task;
}

}  // namespace tools
