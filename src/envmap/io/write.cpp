#include "envmap/io/write.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/part_progress.h"
#include "envmap/base/run_operation.h"
#include "envmap/io/claims/icc_profile.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/io/files/face_names.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/fit_gain_map.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/io/images/bands.h"
#include "envmap/io/images/exif_orientation.h"
#include "envmap/io/images/image_writer.h"
#include "envmap/io/images/mip_chain.h"
#include "envmap/io/metadata.h"
#include "envmap/io/texels/api_orientation.h"
#include "envmap/io/texels/rounding.h"
#include "envmap/io/texels/texels.h"
#include "envmap/io/texels/texture_file.h"
#include "envmap/io/texels/value_range.h"
#include "envmap/io/write_distances.h"
#include "envmap/io/write_gain_map.h"
#include "envmap/io/write_plan.h"
#include "envmap/map/atlas.h"
#include "envmap/map/check_chain.h"
#include "envmap/map/image_view.h"
#include "envmap/map/octahedral_border.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/border_samples.h"
#include "envmap/operate/levels.h"
#include "envmap/operate/measure.h"

namespace envmap {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

// ---- one file -------------------------------------------------------------------------------------------------------

// Nothing where the values are sRGB; empty where their space has no primaries or another curve than a profile can say
// here.
std::optional<std::string> profile_of(const ColourOptions& colour) {
  if (colour.space.empty()) return std::nullopt;
  const std::optional<Primaries> p = primaries_of(colour.config, colour.space);
  const Curve curve = curve_of(colour.config, colour.space);
  if (!p || curve == Curve::other) return "";
  if (curve == Curve::srgb && same(*p, rec709)) return std::nullopt;
  return icc_profile(colour.space, *p, curve);
}

// Image rows of the distances, which all three channels hold.
void gather_distances(const Atlas& atlas, int begin, int end, std::span<float> out) {
  std::vector<Colour> rows(out.size());
  atlas.gather(begin, end, rows);
  std::ranges::transform(rows, out.begin(), &Colour::x);
}

// One image, or all levels of one, the largest first: then in tiles, as renderers' texture caches want them.
// @param distances null, or of the one level.
void write_image(OutputFile& file, const std::string& path, const std::string& ext, std::span<const Atlas> levels,
                 Depth depth, const Metadata& data, const WriteOptions& options, const Rows* distances,
                 const Progress& progress) {
  const bool cube = data.projection == Projection::cube;
  ImagePlan plan{.depth = depth,
                 .attributes = attributes(data),
                 .provenance = data.provenance,
                 .compression = options.compression,
                 .icc_profile = is_integer(depth) ? profile_of(options.colour) : std::nullopt,
                 .latlong_envmap = options.openexr_envmap && !cube,
                 .cube_envmap = options.openexr_envmap && cube};
  if (!options.rows.empty())
    for (const auto& [name, text] : options.pairs) plan.attributes[std::string(pair_prefix) + name] = text;
  for (const Atlas& level : levels) plan.levels.push_back({level.width(), level.height()});
  if (options.rows.size() == 1) plan.rows = options.rows.front();
  if (distances)
    plan.distances = [atlas = Atlas{*distances, levels[0].grid, -1, 0, 0, Colour(infinity)}](int begin, int end,
                                                                                             std::span<float> out) {
      gather_distances(atlas, begin, end, out);
    };
  const ImageWriter writer = make_writer(file, path, ext, plan);
  PartsOfProgress shares(progress, levels);
  for (std::size_t k = 0; k < levels.size(); ++k)
    for_each_band(levels[k], plan.rows.value_or(RowRange{0, levels[k].height()}), shares.next(levels[k]),
                  [&](int begin, int end, std::vector<Colour>& band) {
                    if (is_integer(depth) && options.colour.space.empty()) encode_srgb(band);
                    writer.write(int(k), begin, end, band);
                  });
  writer.close();
}

// What goes into the one JPEG file of a gain map.
struct GainMapJob {
  const GainMapOptions& how;
  GainMapWritten& done;
};

// The picture of a gain map is encoded. Empty: it is sRGB.
std::string picture_profile(const ColourOptions& colour) {
  const std::optional<Primaries> p = primaries_of(colour.config, colour.space);
  if (!p) throw OutputError(colour.space + " has no primaries, which the picture of a gain map needs");
  const std::string name = encoded_space_with(*p);
  return same(*p, rec709) ? "" : icc_profile(name.empty() ? colour.space : name, *p, Curve::srgb);
}

// All of an image, since what is best for it is known of all of it alone.
void write_gain_map_image(OutputFile& file, const Atlas& atlas, const Metadata& data, const WriteOptions& options,
                          const GainMapJob& job) {
  std::vector<Colour> texels(std::size_t(atlas.width()) * std::size_t(atlas.height()));
  atlas.gather(0, atlas.height(), texels);
  const Attributes texts = attributes(data);
  const FittedGainMap made =
      fit_gain_map({atlas.width(), atlas.height(), texels}, job.done.floor, job.how,
                   {picture_profile(options.colour), texts.at(description), data.provenance.owner});
  job.done.map = made.map, job.done.error = made.error, job.done.bytes = made.bytes.size();
  job.done.picture_quality = made.picture_quality, job.done.gain_quality = made.gain_quality;
  file.put(made.bytes.data(), made.bytes.size());
}

// A format that rounds its floats has a shared exponent and no sign, and gains multiply what has none.
Range range_of(const OutputPlan& plan) {
  constexpr double most_of_gains = 0x1p64;
  Range range = range_of(plan.depth, plan.gain_map ? most_of_gains : plan.format.largest);
  range.has_sign = range.has_sign && !plan.format.round && !plan.gain_map;
  return range;
}

// Whether the format has floats, which were not chosen, and they hold the value.
bool fits_float(const FileFormat& format, Depth chosen, double value) {
  return chosen != Depth::single && value <= format.largest &&
         std::ranges::find(format.depths, Depth::single) != format.depths.end();
}

// By how many stops, in tenths: so much less light fits.
std::string too_bright(const ClampStatistics& level, double largest, Depth depth) {
  const double stops = std::ceil(10 * portable::log2(level.brightest / largest)) / 10;
  const std::string of = is_integer(depth) ? "the white of a picture" : fmt::format("the maximum of {}", name(depth));
  return fmt::format("{} texels exceed {:g}, {}, by up to {:.1f} stops", level.over, largest, of, stops);
}

// Refuses a level of which the depth loses light, or notes how much.
void check_fit(const std::string& path, const OutputPlan& plan, const ClampStatistics& level,
               const WriteOptions& options, Written& done) {
  const FileFormat& format = plan.format;
  const Range range = range_of(plan);
  if (level.nan > 0) throw OutputError(path, fmt::format("{} texels are NaN", level.nan), Remedy::repair);
  if (level.negative > 0 && !options.clamp)
    throw OutputError(path,
                      fmt::format("{} texels are negative, and {} has no sign: clamp them, or choose half or .exr",
                                  level.negative,
                                  plan.gain_map  ? "a gain map"
                                  : format.round ? format.title
                                                 : name(done.depth)));
  if (level.over > 0 && !options.clamp)
    throw OutputError(path, too_bright(level, range.largest, done.depth),
                      fits_float(format, done.depth, level.brightest) ? Remedy::clamp_or_deepen
                      : is_integer(done.depth)                        ? Remedy::clamp_or_darken
                                                                      : Remedy::clamp_or_dim);
  // Less than what all values are rounded by anyway is no loss.
  const bool dark = level.rounded > range.precision * level.flux;
  if (dark && !options.clamp)
    throw OutputError(path,
                      fmt::format("{} texels below {:.2g} are too dark for {}, which changes {:.3g}% of the light",
                                  level.dark, range.fine, name(done.depth), 100 * level.rounded / level.flux),
                      fits_float(format, done.depth, 0) ? Remedy::clamp_or_brighten : Remedy::clamp_or_light_up);
  done.clamped += level.over + level.negative + (dark ? level.dark : 0);
  const double lost = level.cut + (dark ? level.rounded : 0);
  if (level.flux > 0) done.flux_lost = std::max(done.flux_lost, lost / level.flux);
}

// Rows of the map's space in that of the file.
Rows in_space(Rows rows, const ColourTransform& colours) {
  if (colours.apply)
    rows.fill = [fill = std::move(rows.fill), colours](int face, int row, std::span<Colour> out) {
      fill(face, row, out);
      colours.apply(out);
    };
  return rows;
}

// Says what space the values are in, where it was asked for; the word only where it is another than would be taken
// anyway.
void record_space(Metadata& data, const ColourOptions& colour, bool integers) {
  if (colour.space.empty()) return;
  const std::optional<Primaries> stored = primaries_of(colour.config, colour.space);
  data.provenance.chromaticities = stored ? std::optional(chromaticities(*stored)) : std::nullopt;
  const std::string word = space_word(colour.config, colour.space);
  if (word != (integers ? "sRGB" : "lin_rec709")) data.space = word;
}

// The primaries and the curve of the stored values, as KTX2 has them.
std::optional<KhrColour> described(const Metadata& data, const ColourOptions& colour) {
  const Curve curve = curve_of(colour.config, colour.space);
  const auto& said = data.provenance.chromaticities;
  if (!said && colour.space.empty()) return khr_colour(rec709, curve);
  return khr_colour(said ? std::optional(primaries(*said)) : std::nullopt, curve);
}

// Names the file at fault.
template <class F>
void naming(const std::string& path, F&& action) {
  try {
    action();
  } catch (const OutputError& e) {
    if (!e.file().empty()) throw;
    throw OutputError(path, e.what(), e.remedy());
  }
}

// Bytes that texels surely take in a file.
std::uint64_t least_bytes(std::span<const Rows> levels, const FileFormat& format, Depth depth,
                          const WriteOptions& options) {
  double texels = 0;
  for (const Rows& rows : levels) texels += texel_count(rows.projection, rows.size);
  return format.least_bytes ? std::uint64_t(texels * format.least_bytes(depth, options)) : 0;
}

// Where the bytes of a map go instead of files, and what goes with it. Null: into files, nothing.
struct Destination {
  std::vector<std::byte>* memory = nullptr;  // Takes the bytes of the one file.
  const Rows* distances = nullptr;           // For the channel Z of the one EXR file.
  const GainMapJob* gain_map = nullptr;
};

// The levels as the files store them: in their space, within the range of their depth, in their orientation.
class StoredLevels {
 public:
  StoredLevels(std::span<const Rows> levels, const OutputPlan& plan, const WriteOptions& options) {
    const ColourTransform colours = out_of_working(options.colour);
    const Range range = range_of(plan);
    for (const Rows& level : levels) in_space_.push_back(in_space(level, colours));
    for (const Rows& level : in_space_) {
      limited_.push_back(std::make_unique<ClampedRows>(level, range, options.clamp));
      const Rows limited = limited_.back()->rows();
      rows_.push_back(plan.layout == Layout::api ? in_api_orientation(limited) : limited);
    }
  }

  [[nodiscard]] std::span<const Rows> rows() const { return rows_; }
  // Once all rows are written. @throws OutputError where the depth loses light, and clamping was not asked for.
  void check_fit_of(const std::string& path, const OutputPlan& plan, const WriteOptions& options, Written& done) const {
    for (const auto& level : limited_) check_fit(path, plan, level->total(), options, done);
  }

 private:
  std::vector<Rows> in_space_, rows_;
  std::vector<std::unique_ptr<ClampedRows>> limited_;
};

// What the files say of the map.
Metadata metadata_of(const Rows& base, const OutputPlan& plan, const WriteOptions& options) {
  Metadata data{.projection = base.projection, .facts = options.facts, .provenance = options.provenance};
  if (base.projection == Projection::cube && plan.layout != Layout::api) data.layout = plan.layout;
  if (has_forward(base.projection)) data.forward = base.forward;
  if (options.border > 0) data.border = options.border;
  if (const auto convention = convention_of(options.faces); !convention.empty())
    data.facts[std::string(faces_fact)] = convention;
  record_space(data, options.colour, is_integer(plan.depth));
  return data;
}

// The files of a map: all are written before the first appears.
class MapFiles {
 public:
  MapFiles(const OutputPlan& plan, const Metadata& data, const WriteOptions& options, const Destination& destination,
           std::uint64_t least)
      : plan_(plan),
        data_(data),
        options_(options),
        destination_(destination),
        least_(least),
        colour_(described(data, options.colour).value_or(KhrColour{})) {}

  void write(const std::string& name, std::span<const Atlas> atlases, const Progress& progress) {
    files_.push_back(destination_.memory ? std::make_unique<OutputFile>()
                                         : std::make_unique<OutputFile>(name, options_.commit));
    if (files_.size() == 1 && options_.rows.empty()) files_.back()->expect(least_);
    try {
      write_into(*files_.back(), name, atlases, progress);
    } catch (const OutputError&) {
      files_.back()->check();  // What the disk says is more than what an encoder makes of it.
      throw;
    }
  }

  void appear() {
    for (const auto& file : files_) destination_.memory ? (void)(*destination_.memory = file->bytes()) : file->commit();
  }

 private:
  void write_into(OutputFile& file, const std::string& name, std::span<const Atlas> atlases, const Progress& progress) {
    if (destination_.gain_map)
      return naming(name,
                    [&] { write_gain_map_image(file, atlases.front(), data_, options_, *destination_.gain_map); });
    if (!plan_.format.write)
      return write_image(file, name, plan_.extension, atlases, plan_.depth, data_, options_, destination_.distances,
                         progress);
    const TexturePlan texture{texels_of(plan_.depth), plan_.layout == Layout::api, options_.zstd, colour_, data_,
                              options_.pairs};
    naming(name, [&] { plan_.format.write(file, atlases, texture, progress); });
  }

  const OutputPlan& plan_;
  const Metadata& data_;
  const WriteOptions& options_;
  const Destination& destination_;
  std::uint64_t least_;  // Bytes that the first file surely gets.
  KhrColour colour_;     // Of textures.
  std::vector<std::unique_ptr<OutputFile>> files_;
};

// All levels in one file, or the rows of them that were asked for.
void write_chain(MapFiles& files, const std::string& path, std::span<const Rows> rows, const OutputPlan& plan,
                 const WriteOptions& options, const Progress& progress) {
  if (options.rows.empty())
    return files.write(path, MipChain(rows, plan.layout, !plan.format.texture).atlases(), progress);
  const Rows stack = stacked(rows, grid(plan.layout), options.rows);
  const Atlas atlas{stack, {1, 1, {}}, 0};
  files.write(path, std::span(&atlas, 1), progress);
}

// A file a level, or a file a face.
void write_each(MapFiles& files, const std::string& path, std::span<const Rows> rows, const OutputPlan& plan,
                const Progress& progress) {
  const int count = plan.layout == Layout::files ? faces(rows.front().projection) : 1;
  for (std::size_t level = 0; level < rows.size(); ++level)
    for (int k = 0; k < count; ++k) {
      const std::string one = level_path(path, int(level));
      const Rows face = count == 6 ? stored_rows(rows[level], k, plan.faces[std::size_t(k)].stored) : rows[level];
      const Atlas atlas{face, grid(plan.layout), count > 1 ? k : -1};
      const Progress part = level > 0 ? Progress() : part_progress(progress, double(k) / count, 1.0 / count);
      files.write(count > 1 ? face_path(one, k, plan.faces) : one, std::span(&atlas, 1), part);
    }
}

// All files of a map, whose samples lie where the files want them.
Written write_files(const std::string& path, std::span<const Rows> levels, const OutputPlan& plan,
                    const WriteOptions& options, const Progress& progress, const Destination& destination) {
  check_space(path, plan.format, plan.depth, options);
  const StoredLevels stored(levels, plan, options);
  const bool chain = levels.size() > 1 && !has_level(path);
  Metadata data = metadata_of(levels.front(), plan, options);
  if (chain && !plan.format.texture) data.levels = int(levels.size());
  MapFiles files(plan, data, options, destination, least_bytes(levels, plan.format, plan.depth, options));
  if (chain)
    write_chain(files, path, stored.rows(), plan, options, progress);
  else
    write_each(files, path, stored.rows(), plan, progress);
  Written done{.depth = plan.depth, .layout = plan.layout};
  stored.check_fit_of(path, plan, options, done);
  files.appear();
  return done;
}

void check_sizes(const std::string& path, std::span<const Rows> levels) {
  std::vector<LevelSize> faces;
  for (const Rows& rows : levels) faces.push_back({rows.width(), rows.size});
  check_halving(faces, path);
}

// A file for each level may hold what no chain of a graphics API does: further lobes at one texel.
void check_count(const std::string& path, std::span<const Rows> levels, int border) {
  const Rows& base = levels.front();
  if (!has_level(path)) check_level_count({base.width() + 2 * border, base.size + 2 * border}, levels.size(), path);
}

// A range for each level. Sizes are those of the whole, whose border may be missing here.
void check_row_ranges(const std::string& path, std::span<const Rows> levels, const OutputPlan& plan,
                      const WriteOptions& options) {
  if (options.rows.size() != levels.size())
    throw UsageError(path, fmt::format("{} ranges of rows for {} levels", options.rows.size(), levels.size()));
  const Grid places = grid(plan.layout);
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const auto [begin, end] = options.rows[k];
    const int height = places.rows * levels[k].size;
    if (begin < 0 || begin > end || end > height || (k == 0 && begin == end))
      throw UsageError(path, fmt::format("rows must lie within 0 to {}, not {} to {}", height, begin, end));
  }
}

// The levels with their border, with OpenEXR's samples on the border, or as they are.
Written write_as_planned(const std::string& path, std::span<const Rows> levels, const OutputPlan& plan,
                         const WriteOptions& options, const Progress& progress, const Destination& destination) {
  EnvironmentMap map;  // Where samples are not those of the rows.
  if (options.border > 0) {
    for (const Rows& rows : levels) map.levels.push_back(with_border(level_of(rows), options.border));
    check_sizes(path, all_rows_of(map));
    return write_files(path, all_rows_of(map), plan, options, progress, destination);
  }
  if (!options.rows.empty())
    check_row_ranges(path, levels, plan, options);
  else
    check_sizes(path, levels);
  if (!options.openexr_envmap) return write_files(path, levels, plan, options, progress, destination);
  if (levels.front().forward != Forward::plus_z)
    throw UsageError(path, "OpenEXR's envmap files have +z at the centre", Remedy::choose_plus_z);
  for (const Rows& rows : levels) map.levels.push_back(level_of(rows));
  if (levels.size() > 1) add_levels(map.levels);
  for (Level& level : map.levels) level = to_border(level);
  return write_files(path, all_rows_of(map), plan, options, progress, destination);
}

OutputPlan with_gain_map(OutputPlan plan, bool gain_map) {
  if (gain_map) plan.depth = Depth::single, plan.gain_map = true;
  return plan;
}

Written write_map(const std::string& path, std::span<const Rows> levels, const WriteOptions& options, const Run& run,
                  const Destination& destination) {
  if (levels.empty()) throw UsageError(path, "nothing to write: the map has no levels");
  for (const Rows& rows : levels) check_rows(rows);
  check_range(limits::border, options.border);
  const Rows& base = levels.front();
  for (const Rows& rows : levels)
    if (rows.projection != base.projection || rows.forward != base.forward)
      throw UsageError(path, "levels of one map must have one projection and forward axis");
  const OutputPlan plan =
      with_gain_map(plan_output(path, options, base.projection, levels.size() > 1), destination.gain_map != nullptr);
  check_count(path, levels, options.border);
  return run_operation(run, [&](const Progress& progress) {
    return write_as_planned(path, levels, plan, options, progress, destination);
  });
}

}  // namespace

Written write(const std::string& path, const Rows& rows, const WriteOptions& options, const Run& run) {
  return write(path, std::span(&rows, 1), options, run);
}

Written write(const std::string& path, const EnvironmentMap& map, const WriteOptions& options, const Run& run) {
  return write(path, all_rows_of(map), options, run);
}

Written write(const std::string& path, std::span<const Rows> levels, const WriteOptions& options, const Run& run) {
  return write_map(path, levels, options, run, {});
}

std::vector<std::byte> encode(const EnvironmentMap& map, const WriteOptions& options, const Run& run) {
  return encode(all_rows_of(map), options, run);
}

std::vector<std::byte> encode(std::span<const Rows> levels, const WriteOptions& options, const Run& run) {
  std::vector<std::byte> bytes;
  write_map("", levels, options, run, {.memory = &bytes});  // Errors name no file.
  return bytes;
}

void check_output(const std::string& path, const WriteOptions& options, Projection projection, bool levels) {
  (void)plan_output(path, options, projection, levels);
}

void check_distances(const std::string& path, const WriteOptions& options) {
  const FileFormat* const format = format_with_extension(extension(path, options));
  if (!format || !format->can(FileFormat::row_range) || has_face(path) || options.openexr_envmap || options.border > 0)
    throw UsageError(path, "distances are written to one .exr file, without borders or OpenEXR's envmap attribute");
}

Written write_with_distances(const std::string& path, const EnvironmentMap& map, std::span<const float> distances,
                             const WriteOptions& options, const Run& run) {
  check_distances(path, options);
  const Level& level = map.base();
  const ImageView<const float> view(distances, level.width(), level.height(), level.faces());
  Rows rows = rows_of(level, map.forward);
  rows.fill = [view](int face, int row, std::span<Colour> out) {
    std::ranges::transform(view.row(face, row), out.begin(), [](float z) { return Colour(z); });
  };
  return write_map(path, all_rows_of(map), options, run, {.distances = &rows});
}

void check_gain_map(const std::string& path, const GainMapOptions& how, const WriteOptions& options,
                    Projection projection) {
  if (how.channels != 1 && how.channels != 3)
    throw UsageError(fmt::format("a gain map has 1 or 3 channels, not {}", how.channels));
  if (how.display) check_enumerator("display", *how.display);
  if (how.max_error && !(*how.max_error > 0)) throw UsageError("the error of a gain map must be above 0");
  const OutputPlan plan = plan_output(path, options, projection, false);
  if (!plan.format.can(FileFormat::gain_map) || plan.layout == Layout::files || has_level(path))
    throw UsageError(path, "a gain map is written to one .jpg file");
  if (options.depth) throw UsageError(path, "a gain map has no depth to choose");
  if (!options.colour.space.empty() && curve_of(options.colour.config, options.colour.space) != Curve::linear)
    throw UsageError(path, fmt::format("{} is encoded, and a gain map makes linear light", options.colour.space),
                     Remedy::choose_linear);
}

GainMapWritten write_gain_map(const std::string& path, const Rows& rows, const GainMapOptions& how,
                              const WriteOptions& options, const Run& run) {
  check_gain_map(path, how, options, rows.projection);
  check_rows(rows);
  GainMapWritten done;
  const Level level = run_operation(run, [&](const Progress&) { return level_of(rows); });
  const double mean = mean_radiance(level);
  done.floor = mean > 0 ? 0.001 * mean : 1;
  const GainMapJob job{how, done};
  const Rows held = rows_of(level, rows.forward);
  done.written = write_map(path, std::span(&held, 1), options, run, {.gain_map = &job});
  return done;
}

}  // namespace envmap
