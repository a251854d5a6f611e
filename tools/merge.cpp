#include <fmt/format.h>

#include "command.h"
#include "depfile.h"
#include "envmap/base/error.h"
#include "envmap/io/part.h"
#include "envmap/io/rounding.h"
#include "envmap/operate/levels.h"
#include "shard.h"

namespace tools {
namespace {

using namespace envmap;

struct Options {
  std::vector<std::string> names;
  ReadOptions read;  // Its limit of pixels.
  WriteOptions write;
};

// As the parts were asked for, but for what is said here.
WriteOptions options_of(const WriteOptions& parts, const WriteOptions& said) {
  WriteOptions o = parts;
  o.format = said.format;
  o.zstd = said.zstd;
  if (said.layout) o.layout = said.layout;
  if (said.depth) o.depth = said.depth;
  if (said.clamp) o.clamp = true;
  if (said.openexr_envmap) o.openexr_envmap = true;
  if (!said.compression.empty()) o.compression = said.compression;
  return o;
}

// What `prefilter` and `convert` promised of the whole must be true of this file, too.
void check_promise(const std::string& output, const Joined& parts, const WriteOptions& now) {
  if (!parts.making.contains("max-error")) return;
  const auto was = rounding_of("-", parts.write), is = rounding_of(output, now);
  const auto most = [](const std::optional<Rounding>& r) { return r ? r->largest.value_or(1) : 1; };
  if (most(is) > most(was))
    throw UsageError(output, "does not hold the --max-error that the parts were made with: leave out --depth and --compression, and write .exr");
}

// The levels that `mipmap` was asked for.
void add_levels(EnvironmentMap& map, Facts& making, int border) {
  const auto count = making.find("levels"), weights = making.find("weights");
  if (count == making.end() || weights == making.end()) return;
  int wanted = 0;
  if (!CLI::detail::lexical_cast(count->second, wanted) || wanted < 0) wanted = 1;
  const Weights w = one_of<Weights>(weight_names)(weights->second).value_or(Weights::solid_angle);
  if (border > 0)
    add_levels_with_border(map.levels, border, w, wanted);
  else
    envmap::add_levels(map.levels, w, wanted);
}

int run(Options& o, const Common& common) {
  if (o.names.size() < 2) throw UsageError("name the parts and the file to write");
  const std::string& output = o.names.back();
  const std::vector<std::string> parts(o.names.begin(), o.names.end() - 1);
  check_files({output}, parts, common);
  Joined joined = join_parts(parts, o.read.max_pixels);
  const WriteOptions how = options_of(joined.write, o.write);
  check_promise(output, joined, how);
  add_levels(joined.map, joined.making, how.border);
  write_map(output, all_rows_of(joined.map), how, parts, "merge", common);
  return 0;
}

}  // namespace

Command merge_command() {
  return {.name = "merge",
          .summary = "Join the parts that --shard I/N makes to the file that the whole command writes",
          .description =
              "Large jobs of convert, prefilter and mipmap can be divided among processes and machines: the same command with "
              "--shard I/N added makes part I of N, a band of the output's rows, in an .exr file of its own. merge joins them, "
              "named in any order, and writes what the command without --shard writes, byte for byte. A part that is missing, "
              "named twice, or made of another map or by another command is refused.\n\n"
              "What the command says of its file (--depth, --layout, --clamp, --compression, --openexr-envmap, --border) is put "
              "down in the parts and holds for the whole. What an .exr file cannot be is said here: another format, --zstd, "
              "depths of textures; values are rounded once, here. The levels of mipmap are made here, too. A chain of prefilter "
              "is made a level at a time; its texels are chosen methods for as in the whole map.",
          .examples = {{"for i in 1 2 3; do envmap prefilter probe.exr part-$i.exr --size 512 --shard $i/3; done", "three parts"},
                       {"envmap merge part-*.exr diffuse.exr", "the bytes of 'envmap prefilter probe.exr diffuse.exr --size 512'"},
                       {"envmap merge part-*.exr diffuse.ktx2 --depth half --zstd", "the same as a texture"}},
          .writes = true,
          .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
            auto o = std::make_shared<Options>();
            app.add_option("FILES", o->names, "Parts, in any order, and last the file to write; '-' is standard output, {face} in its name writes six files")
                ->required()
                ->type_name("");
            add_layout(app, "--layout", o->write.layout, "Where the output's cube faces lie (default: as the parts were asked for)");
            add_write_options(app, o->write);
            add_max_pixels(app, o->read);
            return [o, &common] { return run(*o, common); };
          }};
}

}  // namespace tools
