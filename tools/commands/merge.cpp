#include <fmt/format.h>

#include "command.h"
#include "envmap/base/error.h"
#include "envmap/engine/baked_maps.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/io/shard.h"
#include "envmap/io/texels/rounding.h"
#include "envmap/operate/levels.h"
#include "maps/depfile.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"
#include "maps/shard_options.h"

namespace tools {
namespace {

using namespace envmap;

struct MergeRequest {
  std::vector<std::string> names;
  ReadOptions read;  // Its limit of pixels.
  WriteOptions write;
};

// What the name and --format say, or what the parts were asked for. An engine's parts are for its type of file alone.
std::string format_of(const std::string& output, const WriteOptions& parts, const WriteOptions& said) {
  const std::string type = said.format.empty() ? extension_of(output) : said.format;
  if (!parts.format.empty() && !type.empty() && type != parts.format)
    throw UsageError(output,
                     fmt::format("the parts are of a .{} file: end the name in .{}", parts.format, parts.format));
  return said.format.empty() && type.empty() ? parts.format : said.format;
}

// As the parts were asked for, but for what is said here.
WriteOptions options_of(const std::string& output, const WriteOptions& parts, const WriteOptions& said) {
  WriteOptions o = parts;
  o.format = format_of(output, parts, said);
  if (said.zstd) o.zstd = true;
  if (said.layout) o.layout = said.layout;
  o.faces = said.faces;
  if (said.depth) o.depth = said.depth;
  if (said.clamp) o.clamp = true;
  if (said.openexr_envmap) o.openexr_envmap = true;
  if (!said.compression.empty()) o.compression = said.compression;
  return o;
}

// What `prefilter` and `convert` promised of the whole must be true of this file, too.
void check_promise(const std::string& output, const MergedShards& parts, const WriteOptions& now) {
  if (!parts.making.contains("max-error")) return;
  const auto was = rounding_of("-", parts.write), is = rounding_of(output, now);
  const auto most = [](const std::optional<Rounding>& r) { return r ? r->largest.value_or(1) : 1; };
  if (most(is) > most(was))
    throw UsageError(output,
                     "cannot keep the --max-error of the parts: remove --depth and --compression, and write .exr");
}

// The levels that `mipmap` was asked for.
void add_levels(EnvironmentMap& map, Facts& making, int border) {
  const auto count = making.find("levels"), weights = making.find("weights");
  if (count == making.end() || weights == making.end()) return;
  int wanted = 0;
  if (!parse_number(count->second, wanted) || wanted < 0) wanted = 1;
  const Weights w = static_cast<Weights>(std::max(0, index_of(weights->second, weight_names)));
  if (border > 0)
    add_levels_with_border(map.levels, border, w, wanted);
  else
    envmap::add_levels(map.levels, w, wanted);
}

int run(MergeRequest& o) {
  if (o.names.size() < 2) throw UsageError("needs the parts, and after them the file to write");
  const std::string& output = o.names.back();
  if (output != "-" && is_part(output)) throw UsageError(output, "is a part: name the file to write after the parts");
  const std::vector<std::string> parts(o.names.begin(), o.names.end() - 1);
  check_files({output}, parts, {o.write.faces, {}});
  MergedShards joined = merge_shards(parts, o.read.max_pixels);
  WriteOptions how = options_of(output, joined.write, o.write);
  check_promise(output, joined, how);
  add_levels(joined.map, joined.making, how.border);
  const auto mirror = MirroredAxis(std::max(0, index_of(joined.making["mirror"], mirrored_axis_names)));
  if (mirror == MirroredAxis::y || (mirror != MirroredAxis::none && joined.map.projection() != Projection::cube))
    throw InputError("the parts ask for what engines do not mirror: damaged");
  record_mirror(how.facts, mirror);
  write_map(output, mirrored(all_rows_of(joined.map), mirror), how, "merge");
  return 0;
}

}  // namespace

Action define_merge(Options& o) {
  const auto r = std::make_shared<MergeRequest>();
  o.files(r->names, File::inputs_then_output, "Parts in any order, and last the file to write, or '-' for stdout");
  add_write_options(o, r->write, "that of the parts");
  add_layout(o, "--layout", r->write.layout, "Cube faces: {} (default: that of the parts)");
  add_faces(o, r->write);
  o.group = groups::input_map;
  add_max_pixels(o, r->read);
  return [r](Report&) { return run(*r); };
}

}  // namespace tools
