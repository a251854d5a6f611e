#include "maps/read_and_write_maps.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/io/files/face_names.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/read_photo.h"
#include "envmap/io/write_distances.h"
#include "envmap/io/write_plan.h"
#include "envmap/operate/brightest.h"
#include "maps/depfile.h"

namespace tools {
namespace {

using namespace envmap;

}  // namespace

bool is_prefiltered_chain(const Source& source) { return source.levels > 1 && source.facts.contains("lobe"); }

namespace {

// @param reader read() or read_photo().
Source told(Source (*reader)(const std::string&, const ReadOptions&, const Run&), const std::string& path,
            const ReadOptions& options) {
  const Stopwatch watch;
  Source source = reader(path, options, {});
  if (source.repaired > 0) warn(fmt::format("{}: repaired {} texels", path, source.repaired));
  for (const auto* files : {&source.colour_files, &source.files})
    settings().also_read.insert(settings().also_read.end(), files->begin(), files->end());
  for (const std::string& what : source.notes) warn(fmt::format("{}: {}", path, what));
  if (settings().verbose) {
    for (const std::string& what : source.details) detail(fmt::format("{}: {}", path, what));
    const Level& level = source.map.base();
    detail(fmt::format("{}: {} {}x{}{}, {} {}, read in {:.2f} s", path, name(level.projection()), level.width(),
                       level.height(), level.faces() > 1 ? fmt::format(" x {} faces", level.faces()) : "",
                       source.format, name(source.depth), watch.seconds()));
  }
  return source;
}

}  // namespace

Source read_map(const std::string& path, const ReadOptions& options) { return told(read, path, options); }
Source read_picture(const std::string& path, const ReadOptions& options) { return told(read_photo, path, options); }

std::string equal_brightest(std::string_view command, const std::string& path, const EnvironmentMap& map) {
  constexpr double bright = 4;  // Times the mean: plain maps are no lights.
  const Level& level = map.base();
  double most = 0, sum = 0;
  std::int64_t count = 0, all = 0;
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j) {
      const Columns in = level.weighted_columns(j);
      for (int i = in.first; i < in.end; ++i) {
        const double y = luminance_of(*level.texel(face, i, j));
        if (y > most) most = y, count = 0;
        count += y == most;
        sum += y, ++all;
      }
      level.trim();
    }
  if (count < 2 || most * double(all) <= bright * sum) return {};
  return fmt::format(
      "envmap {}: {}: {} texels hold the largest value, {:g}: if its light was clipped, the result is too dark "
      "(convert --restore-sun adds what is missing)",
      command, path, count, most);
}

void tell_clamping(const std::string& path, const Written& written) {
  if (written.clamped > 0)
    warn(
        fmt::format("{}: clamped {} texels, {:.3g}% of the flux lost", path, written.clamped, 100 * written.flux_lost));
}

Written write_map(const std::string& path, const Rows& rows, const WriteOptions& options, const std::string& verb) {
  return write_map(path, std::span(&rows, 1), options, verb);
}

Written write_map(const std::string& path, std::span<const Rows> levels, const WriteOptions& options,
                  const std::string& verb) {
  const Stopwatch watch;
  const std::vector<std::string> colours = out_of_working(options.colour).files;
  settings().also_read.insert(settings().also_read.end(), colours.begin(), colours.end());
  open_depfile(int(levels.size()));
  const Rows& rows = levels.front();
  WriteOptions how = options;
  how.commit = settings().commit;
  const Written written = write(path, levels, how, {.progress = progress_line(verb)});
  tell_clamping(path, written);
  if (settings().verbose)
    detail(fmt::format("{}: {} {}x{}{}{}, {}, {}written in {:.2f} s", path, name(rows.projection), rows.width(),
                       rows.size,
                       rows.projection == Projection::cube ? fmt::format(" x 6 faces ({})", name(written.layout)) : "",
                       levels.size() > 1 ? fmt::format(", {} levels", levels.size()) : "", name(written.depth),
                       verb == "write" ? "" : "made and ", watch.seconds()));
  return written;
}

void write_distances(const std::string& path, const EnvironmentMap& map, std::span<const float> distances,
                     const Direction& at, const WriteOptions& options) {
  WriteOptions how = options;
  how.commit = settings().commit;
  how.facts["at"] = fmt::format("{:.7g},{:.7g},{:.7g}", at.x, at.y, at.z);
  tell_clamping(path, write_with_distances(path, map, distances, how));
}

void tell_lost_facts(const std::string& path, const Frame& frame, const WriteOptions& options) {
  const std::string type = extension(path, options);
  const FileFormat* const format = format_with_extension(type);
  if (!format || format->frame) return;
  if (const auto& white = options.provenance.white_luminance)
    note(fmt::format("{}: .{} files do not store the unit: radiance 1 is {:.6g} cd/m^2", path, type, *white));
  if (frame.forward == Forward::plus_z) return;
  note(fmt::format("{}: .{} files do not store the axis at the centre: read it with --from-forward {}", path, type,
                   forward_names[std::size_t(frame.forward)]));
}

void write_text(const std::string& path, std::string_view text) {
  OutputFile file(path, settings().commit);
  file.write(text.data(), text.size());
  file.commit();
}

}  // namespace tools
