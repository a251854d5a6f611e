#include "envmap/io/shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <memory>
#include <optional>

#include "envmap/base/error.h"
#include "envmap/io/images/mip_chain.h"
#include "envmap/io/images/open_image.h"
#include "envmap/io/metadata.h"
#include "envmap/map/atlas.h"
#include "envmap/operate/measure.h"

namespace envmap {
namespace {

constexpr std::string_view whole = "whole-";
constexpr const char* whole_border = "whole-border";
constexpr int largest = 65536;  // Height of a face.
constexpr int max_levels = 17;  // Of that height.
// Rows of each part. Preparing a level of 32 rows for `prefilter` takes as long as making them (measured, GGX 0.6).
constexpr int worth_dividing = 32;

// A part's header.
struct Head {
  std::string path;
  Metadata data;
  int width, height;  // Of the part.
  std::map<std::string, std::string> pairs;
  std::shared_ptr<Image> standard;  // Input, which can be read once; of files nothing is kept open.
  PartNumber number = {};
  int size = 0;    // Of the whole: height of a face.
  int border = 0;  // Of the whole, which the parts lack.
  std::string job = {};
};

std::optional<int> number(std::string_view text) {
  int n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  return error == std::errc() && end == text.data() + text.size() && n > 0 ? std::optional(n) : std::nullopt;
}

std::string take(Facts& facts, const std::string& name) {
  const auto node = facts.extract(name);
  return node ? node.mapped() : std::string();
}

constexpr const char* no_part = "is no part of a map: parts are .exr files that say which they are";

std::shared_ptr<Image> open_part(const std::string& path) {
  const auto image = std::make_shared<Image>();
  try {
    open(*image, path, {.crop = true});
  } catch (const UsageError&) {  // A choice of what EXR files alone have.
    image->fail(no_part);
  }
  return image;
}

// Key/value pairs of the whole file: part_options() and write() put them into attributes.
std::map<std::string, std::string> pairs_of(const Attributes& texts) {
  constexpr std::size_t longest = 1 << 20;  // Six faces of irradiance are a fifth of it.
  std::map<std::string, std::string> pairs;
  for (const auto& [name, text] : texts)
    if (name.starts_with(pair_prefix) && is_word(name) && text.size() <= longest)
      pairs[name.substr(pair_prefix.size())] = text;
  return pairs;
}

Head read_head(const std::string& path) {
  const auto opened = open_part(path);
  const Image& image = *opened;
  const ImageFacts& facts = image.reader->facts;
  Head head{.path = path,
            .data = metadata(facts),
            .width = facts.width,
            .height = facts.height,
            .pairs = pairs_of(facts.attributes),
            .standard = path == "-" ? opened : nullptr};
  Facts& words = head.data.facts;
  const std::string part = take(words, "part");
  if (part.empty()) image.fail(no_part);
  const auto slash = std::min(part.find('/'), part.size() - 1);
  const auto index = number(std::string_view(part).substr(0, slash)),
             count = number(std::string_view(part).substr(slash + 1)), size = number(take(words, "part-size"));
  head.job = take(words, "part-of");
  if (const auto border = words.find(whole_border); border != words.end())
    head.border = number(border->second).value_or(0);
  if (!index || !count || !size || *index > *count || *size > largest || !head.data.projection ||
      (head.data.layout && *head.data.projection != Projection::cube))
    image.fail("says that it is a part of a map, but not of which: damaged");
  if (!facts.flat || facts.channels != std::vector<std::string>{"R", "G", "B"})
    image.fail("says that it is a part of a map, but holds other channels than R, G and B: damaged");
  head.number = {*index, *count}, head.size = *size;
  return head;
}

std::string words(const Head& h) { return fmt::format("part {} of {}", h.number.index, h.number.count); }

// All of one map, each once, in order. @throws InputError.
void check(std::vector<Head>& parts) {
  const Head& first = parts.front();
  for (const Head& h : parts)
    if (h.job != first.job || h.number.count != first.number.count || h.size != first.size ||
        h.data.levels != first.data.levels)
      throw InputError(h.path,
                       fmt::format("is {} of another map or command than {}, {}", words(h), first.path, words(first)));
  std::ranges::stable_sort(parts, {}, [](const Head& h) { return h.number.index; });
  for (std::size_t k = 1; k < parts.size(); ++k)
    if (parts[k].number.index == parts[k - 1].number.index)
      throw InputError(parts[k].path,
                       fmt::format("is {}, as {} is: name each once", words(parts[k]), parts[k - 1].path));
  std::string missing;
  auto next = parts.begin();
  // Of billions that a file speaks of, some are enough.
  for (int k = 1; k <= first.number.count; ++k) {
    constexpr std::size_t line = 200;
    if (next != parts.end() && next->number.index == k) {
      ++next;
    } else if (missing.size() < line) {
      missing += fmt::format("{}{}", missing.empty() ? "" : ", ", k);
    } else {
      missing += " ...";
      break;
    }
  }
  if (!missing.empty()) throw InputError(fmt::format("of {} parts these are missing: {}", first.number.count, missing));
}

// Height of a face of level k without its border, which is written round each level; 0: there is no such level.
int level_size(std::int64_t base, std::int64_t border, int k) {
  return int(std::max<std::int64_t>(0, std::max<std::int64_t>(1, (base + 2 * border) >> k) - 2 * border));
}

std::vector<int> sizes_of(const Head& h) {
  std::vector<int> sizes;
  for (int k = 0; k < h.data.levels.value_or(1); ++k) {
    if (k == max_levels || (sizes.push_back(level_size(h.size, h.border, k)), sizes.back() == 0))
      throw InputError(h.path, fmt::format("a map of {} has no {} levels: damaged", h.size, *h.data.levels));
  }
  return sizes;
}

std::vector<int> times(std::vector<int> sizes, int factor) {
  for (int& size : sizes) size *= factor;
  return sizes;
}

int row_count(std::span<const RowRange> bands) {
  int rows = 0;
  for (const RowRange& band : bands) rows += band.end - band.begin;
  return rows;
}

// Before memory is taken for the map: parts hold what they say, so that it is no larger than they are.
// @throws InputError.
void check_sizes(const std::vector<Head>& parts, const Grid& places, std::uint64_t max_pixels) {
  const Head& first = parts.front();
  const int width = places.columns * first.size * aspect(*first.data.projection), height = places.rows * first.size;
  const std::vector<int> heights = times(sizes_of(first), places.rows);
  for (const Head& h : parts) {
    const int rows = height < h.number.count ? 0 : row_count(bands_of(heights, h.number));
    if (h.width != width || h.height != rows)
      throw InputError(h.path, fmt::format("is {}x{}; {} of such a map is {}x{}: damaged", h.width, h.height, words(h),
                                           width, rows));
  }
  if (std::uint64_t(width) * std::uint64_t(height) > max_pixels)
    throw InputError(first.path, fmt::format("is part of a map of {}x{}, over {} pixels", width, height, max_pixels),
                     Remedy::allow_pixels);
}

// Those of a map are sound where they were made.
void check_radiance(const Level& level) {
  const Flaws flaws = find_flaws(level);
  if (flaws.nan + flaws.infinite > 0)
    throw InputError(fmt::format("the parts hold {} texels that are no radiance ({} NaN, {} infinite): damaged",
                                 flaws.nan + flaws.infinite, flaws.nan, flaws.infinite));
}

void read_rows(const Head& head, const Grid& places, std::vector<Level>& levels) {
  const auto image = head.standard ? head.standard : open_part(head.path);
  const std::vector<RowRange> bands = bands_of(times(sizes_of(head), places.rows), head.number);
  std::vector<Colour> rows(std::size_t(head.width) * std::size_t(head.height));
  image->read(0, 0, head.height, 0, 3, std::span(&rows.data()->x, 3 * rows.size()));
  std::span<const Colour> left = rows;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const auto [begin, end] = bands[k];
    scatter(left, head.width, begin, end, places, levels[k]);
    left = left.subspan(std::size_t(head.width) * std::size_t(end - begin));
  }
}

template <class Enum, std::size_t N>
std::optional<Enum> named(const std::string_view (&names)[N], const std::string& wanted) {
  const auto* const found = std::ranges::find(names, wanted);
  return found == std::end(names) ? std::nullopt : std::optional(static_cast<Enum>(found - names));
}

// What part_options() put down.
void restore(Facts& facts, MergedShards& joined, std::uint64_t max_pixels) {
  Facts& making = joined.making;
  for (const auto& [name, text] : Facts(facts))
    if (name.starts_with(whole)) making[name.substr(whole.size())] = take(facts, name);
  WriteOptions& w = joined.write;
  w.depth = named<Depth>(depth_names, take(making, "depth"));
  w.source_depth = named<Depth>(depth_names, take(making, "source-depth")).value_or(Depth::single);
  w.layout = layout_named(take(making, "layout"));
  w.compression = take(making, "compression");
  w.clamp = !take(making, "clamp").empty();
  w.zstd = !take(making, "zstd").empty();
  w.openexr_envmap = !take(making, "openexr-envmap").empty();
  w.border = number(take(making, "border")).value_or(0);
  w.format = take(making, "format");
  const Projection projection = joined.map.projection();
  const std::uint64_t whole_size = std::uint64_t(joined.map.base().height()) + 2 * std::uint64_t(w.border);
  if ((w.layout && projection != Projection::cube) ||
      (w.border > 0 && (!is_octahedral(projection) || whole_size > largest || whole_size * whole_size > max_pixels)))
    throw InputError(fmt::format("the parts ask for what a {} map of this size has not: damaged", name(projection)));
}

}  // namespace

std::vector<RowRange> bands_of(std::span<const int> heights, const PartNumber& part) {
  if (heights.front() < part.count)
    throw UsageError(fmt::format("{} parts: the image has {} rows", part.count, heights.front()));
  std::vector<RowRange> bands;
  int alone = 0;  // Levels that are not divided, dealt out from the last part on.
  for (const int rows : heights) {
    const auto edge = [&](int k) { return int(std::int64_t{rows} * k / part.count); };
    if (bands.empty() || rows / part.count >= worth_dividing)
      bands.push_back({edge(part.index - 1), edge(part.index)});
    else
      bands.push_back({0, part.index == part.count - alone++ % part.count ? rows : 0});
  }
  return bands;
}

Grid part_grid(const WriteOptions& options, Projection projection) {
  const bool chosen = options.layout && *options.layout != Layout::files;
  return grid(chosen ? *options.layout : default_layout(projection));
}

WriteOptions part_options(const WriteOptions& options, Projection projection, std::span<const int> sizes,
                          const PartNumber& part, const std::string& job) {
  WriteOptions o = options;
  const int base = sizes.front(), wide = aspect(projection);
  for (int k = 1; k < int(sizes.size()); ++k) {
    const int size = sizes[std::size_t(k)];
    const int width = level_size(wide * base, options.border, k), height = level_size(base, options.border, k);
    if (height == 0 || size != height || wide * size != width)
      throw UsageError(fmt::format("level {} is {}x{}, not {}x{}", k, wide * size, size, width, height),
                       Remedy::make_levels);
  }
  o.rows = bands_of(times(std::vector<int>(sizes.begin(), sizes.end()), part_grid(options, projection).rows), part);
  Facts& facts = o.facts;
  facts["part"] = fmt::format("{}/{}", part.index, part.count);
  facts["part-of"] = job;
  facts["part-size"] = std::to_string(sizes.front());
  const auto put = [&](bool given, const char* name, std::string_view text) {
    if (given) facts[std::string(whole) + name] = text;
  };
  put(!o.format.empty() && o.format != "exr", "format", o.format);
  put(o.depth.has_value(), "depth", o.depth ? name(*o.depth) : "");
  put(true, "source-depth", name(o.source_depth));
  put(o.layout.has_value(), "layout", o.layout ? name(*o.layout) : "");
  put(!o.compression.empty(), "compression", o.compression);
  put(o.clamp, "clamp", "yes");
  put(o.openexr_envmap, "openexr-envmap", "yes");
  put(o.border > 0, "border", std::to_string(o.border));
  put(o.zstd, "zstd", "yes");
  o.format.clear(), o.depth = Depth::single, o.openexr_envmap = false, o.border = 0, o.zstd = false;
  o.compression = "rle";  // ZIP makes floats 7% smaller, in three times the time of the whole conversion.
  if (o.layout == Layout::files) o.layout.reset();
  return o;
}

bool is_part(const std::string& path) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return false;  // Reading a pipe would take its bytes.
  try {
    return read_head(path).number.count > 0;
  } catch (const InputError&) {
    return false;
  }
}

MergedShards merge_shards(std::span<const std::string> paths, std::uint64_t max_pixels) {
  std::vector<Head> parts;
  for (const std::string& path : paths) parts.push_back(read_head(path));
  check(parts);
  Metadata& data = parts.front().data;
  const Grid places = grid(data.layout.value_or(default_layout(*data.projection)));
  check_sizes(parts, places, max_pixels);
  MergedShards joined{.map = {.levels = {}, .forward = data.forward.value_or(Forward::plus_z)}};
  for (const int size : sizes_of(parts.front())) joined.map.levels.emplace_back(*data.projection, size);
  for (const Head& head : parts) read_rows(head, places, joined.map.levels);
  for (const Level& level : joined.map.levels) check_radiance(level);
  restore(data.facts, joined, max_pixels);
  joined.write.facts = data.facts;
  joined.write.provenance = data.provenance;
  joined.write.pairs = parts.front().pairs;
  if (!data.space.empty()) joined.write.facts["space"] = data.space;
  return joined;
}

}  // namespace envmap
