#include "commands/tradeoff/tasks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>

#include "cli/options.h"
#include "envmap/base/error.h"
#include "envmap/io/files/scratch_file.h"
#include "envmap/io/write.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/levels.h"
#include "envmap/prefilter/prefilter.h"

namespace tools {
namespace {

using namespace envmap;

Outcome whole(Level level) { return {std::move(level)}; }

// ---- convert --------------------------------------------------------------------------------------------------------

Outcome converted(const EnvironmentMap& map, const ConvertOptions& options) {
  return whole(level_of(Resampler(map, options).rows()));
}

void add_conversions(const EnvironmentMap& map, const ConvertOptions& options, Task& task) {
  const auto add = [&](const FilterInfo& filter, const std::string& setting, const ConvertOptions& how) {
    task.ways.push_back({std::string(filter.name), setting, [&map, how] { return converted(map, how); }});
  };
  for (const FilterInfo& filter : filters()) {
    ConvertOptions how = options;
    how.filter = filter.filter;
    if (filter.filter == Filter::area) {
      for (const double error : {1e-1, 1e-2, 1e-3, 1e-4}) {
        how.area_error = error;
        add(filter, fmt::format("--area-error {:g}", error), how);
      }
    } else if (filter.filter == Filter::nearest || filter.filter == Filter::bilinear ||
               filter.filter == Filter::bicubic) {
      for (const int samples : {1, 2, 4, 8}) {
        how.samples = samples;
        add(filter, samples > 1 ? fmt::format("--samples {}", samples) : "", how);
      }
    } else {
      add(filter, "", how);
    }
  }
  task.reference = "--filter area --area-error 1e-6";
  ConvertOptions exact = options;
  exact.filter = Filter::area, exact.area_error = 1e-6;
  task.truth = [&map, exact] { return converted(map, exact); };
}

// ---- prefilter ------------------------------------------------------------------------------------------------------

Outcome prefiltered(const EnvironmentMap& map, const PrefilterOptions& wanted) {
  Prefiltered done = Prefilterer(borrowed(map)).make(wanted);
  Outcome out = whole(std::move(done.map.base()));
  out.steps = std::move(done.work);
  return out;
}

void add_prefilters(const EnvironmentMap& map, const PrefilterOptions& wanted, Task& task) {
  check_method(wanted);
  for (const Method method : {Method::treecode, Method::automatic}) {
    for (const double error : {1e-1, 1e-2, 1e-3, 1e-4}) {
      PrefilterOptions how = wanted;
      how.method = method, how.max_error = error;
      task.ways.push_back({std::string(method_names[std::size_t(method)]), fmt::format("--max-error {:g}", error),
                           [&map, how] { return prefiltered(map, how); }});
    }
  }
  // Products of texels that the exact sum takes: some seconds of them.
  constexpr double few = 1e8;
  const bool summed = texel_count(wanted.to, wanted.size) * texel_count(map.projection(), map.base().height()) <= few;
  task.reference =
      summed ? "--method exact" : "--method treecode --max-error 1e-5, within 1e-5 of the exact sum in every texel";
  PrefilterOptions reference = wanted;
  reference.method = summed ? Method::exact : Method::treecode, reference.max_error = 1e-5;
  task.truth = [&map, reference] { return prefiltered(map, reference); };
}

// ---- mipmap ---------------------------------------------------------------------------------------------------------

void add_mipmaps(const EnvironmentMap& map, int level, Task& task) {
  const int width = std::max(1, map.base().width() >> level), height = std::max(1, map.base().height() >> level);
  if (std::max(map.base().width(), map.base().height()) >> level == 0)
    throw UsageError(fmt::format("--task mipmap:{}: the map has no level that small", level));
  for (const Weights weights : {Weights::solid_angle, Weights::uniform})
    task.ways.push_back(
        {"levels", fmt::format("--weights {}", weight_names[std::size_t(weights)]), [&map, level, weights] {
           std::vector<Level> levels;
           levels.push_back(map.base().clone());
           add_levels(levels, weights, level + 1);
           return whole(std::move(levels.back()));
         }});
  task.reference = "means over level 0 by solid angle";
  task.truth = [&map, width, height] { return whole(coarser_level(map.base(), width, height)); };
}

// ---- depth ----------------------------------------------------------------------------------------------------------

Outcome written(const EnvironmentMap& map, const std::string& extension, const WriteOptions& options) {
  const ScratchFile file(extension);
  write(file.path(), rows_of(map), options);
  const auto bytes = std::int64_t(std::filesystem::file_size(file.path()));
  return {std::move(read(file.path(), {.projection = map.projection(), .flaws = FlawPolicy::keep}).map.base()), bytes};
}

void add_depths(const EnvironmentMap& map, Task& task) {
  const auto add = [&](const char* extension, Depth depth, const std::string& compression, bool zstd) {
    const WriteOptions how{.depth = depth, .clamp = true, .compression = compression, .zstd = zstd};
    std::string setting = fmt::format("--depth {}", name(depth));
    if (!compression.empty()) setting += " --compression " + compression;
    if (zstd) setting += " --zstd";
    task.ways.push_back({fmt::format(".{}", extension), setting,
                         [&map, extension = std::string(extension), how] { return written(map, extension, how); }});
  };
  for (const Depth depth : {Depth::single, Depth::half}) {
    for (const char* compression : {"none", "zip", "piz", "b44", "dwaa"}) add("exr", depth, compression, false);
    for (const bool zstd : {false, true}) add("ktx2", depth, "", zstd);
  }
  for (const Depth depth : {Depth::rgb9e5, Depth::bc6h})
    for (const bool zstd : {false, true}) add("ktx2", depth, "", zstd);
  task.ways.push_back({".hdr", "", [&map] { return written(map, "hdr", {.clamp = true}); }});
  task.reference = "the map as it was read";
  task.truth = [&map] { return whole(map.base().clone()); };
}

// ---- sizes ----------------------------------------------------------------------------------------------------------

Outcome resized(const EnvironmentMap& map, Projection to, int size) {
  Level level = std::move(convert(map, {.to = {to}, .size = size}).base());
  constexpr int half_rgb = 6;
  const std::int64_t bytes = half_rgb * std::int64_t{level.faces()} * level.width() * level.height();
  return {std::move(level), bytes};
}

// @return how far a smaller map is off when it is converted back.
Difference loss(const EnvironmentMap& map, const Level& level) {
  EnvironmentMap small;
  small.levels.push_back(level.clone());
  return compare(convert(small, {.to = map.frame(), .size = map.base().height()}).base(), map.base());
}

void add_sizes(const EnvironmentMap& map, const std::vector<int>& sizes, Task& task) {
  for (const Projection to : all_projections)
    for (const int size : sizes)
      task.ways.push_back({std::string(name(to)), fmt::format("--size {}", size),
                           [&map, to, size] { return resized(map, to, size); },
                           [&map](const Outcome& out) { return loss(map, out.level); }});
  task.reference = "the map, to which each smaller map is converted back";
}

// ---- names ----------------------------------------------------------------------------------------------------------

template <class T>
T number_of(const std::string& task, const std::string& text, T least, T most) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= least && value <= most))
    throw UsageError(fmt::format("--task {}: '{}' must be a number from {} to {}", task, text, least, most));
  return value;
}

std::optional<LobeShape> shape_named(std::string_view word) {
  const int shape = index_of(word, parametric_lobe_names);
  return shape < 0 ? std::nullopt : std::optional(static_cast<LobeShape>(shape));
}

}  // namespace

std::vector<std::string> parts_of(const std::string& name) { return split(name, ':'); }

Projection projection_of(const std::string& task, const std::string& text) {
  if (const auto p = projection_named(text)) return *p;
  throw UsageError(fmt::format("--task {}: '{}' is not a projection", task, text));
}

int size_of(const std::string& task, const std::string& text) { return number_of(task, text, 1, 1 << 15); }

std::string task_words() {
  return "convert:P[:N] mipmap:K diffuse[:P:N] phong:M[:P:N] ggx:R[:P:N] blinn-phong:M[:P:N] charlie:R[:P:N] "
         "sizes:N,... depth bake:ENGINE "
         "render:P[:N] view[:N]";
}

Task make_task(const std::string& name, const EnvironmentMap& map) {
  const std::vector<std::string> parts = parts_of(name);
  Task task{.name = name};
  const auto expect = [&](bool right) {
    if (!right) throw UsageError(fmt::format("--task '{}' must be one of {}", name, task_words()));
  };
  if (const auto shape = shape_named(parts[0])) {
    const std::size_t first = *shape == LobeShape::diffuse ? 1 : 2;
    expect(parts.size() == first || parts.size() == first + 2);
    PrefilterOptions wanted{.size = 16};
    if (first == 2) wanted.lobe = Lobe(*shape, number_of(name, parts[1], 0.0, 1e9));
    if (parts.size() > first)
      wanted.to = projection_of(name, parts[first]), wanted.size = size_of(name, parts[first + 1]);
    add_prefilters(map, wanted, task);
  } else if (parts[0] == "convert") {
    expect(parts.size() == 2 || parts.size() == 3);
    ConvertOptions options{.to = {projection_of(name, parts[1])}};
    if (parts.size() == 3) options.size = size_of(name, parts[2]);
    add_conversions(map, options, task);
  } else if (parts[0] == "mipmap") {
    expect(parts.size() == 2);
    add_mipmaps(map, number_of(name, parts[1], 1, 16), task);
  } else if (parts[0] == "sizes") {
    expect(parts.size() == 2);
    std::vector<int> sizes;
    for (const std::string& text : split(parts[1], ',')) sizes.push_back(size_of(name, text));
    add_sizes(map, sizes, task);
  } else {
    expect(name == "depth");
    add_depths(map, task);
  }
  return task;
}

}  // namespace tools
