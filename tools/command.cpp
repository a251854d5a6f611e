#include "command.h"

#include <fmt/format.h>
#include <tbb/info.h>

#include <chrono>
#include <cmath>

#include "colour_options.h"
#include "depfile.h"
#include "envmap/base/error.h"
#include "envmap/io/metadata.h"
#include "envmap/io/path.h"
#include "version.h"

namespace tools {

using namespace envmap;

std::vector<Command> all_commands() {
  return {convert_command(),  mipmap_command(),  prefilter_command(), sh_command(),
          render_command(),   view_command(),    info_command(),      compare_command(), tradeoff_command(),
          generate_command(), preview_command(), bake_command(),      batch_command(), merge_command(),     manual_command(),    completion_command()};
}

std::unique_ptr<CLI::App> make_app(const std::vector<Command>& commands, Common& common, std::function<int()>& run) {
  auto app = std::make_unique<CLI::App>("Convert, measure and make environment maps.", "envmap");
  app->set_version_flag("--version", [] { return version_text() + "\n" + renderer_text(); });
  app->require_subcommand(1);
  app->footer(
      "'envmap COMMAND --help' shows the options of a command and examples; 'man envmap-COMMAND' the same and more.");
  for (const Command& command : commands) {
    CLI::App* sub = app->add_subcommand(command.name, command.summary);
    const std::function<int()> action = command.define(*sub, common);
    if (command.reports) sub->add_flag("--json", common.json, "Report as JSON on standard output");
    if (command.writes) {
      sub->add_option("--depfile", common.depfile, "Write what the output depends on, in Make syntax")
          ->type_name("FILE");
      sub->add_flag("--if-changed", common.commit.if_changed,
                    "Leave an output with the same bytes as it is, and its time: for restat of Ninja");
      sub->add_flag("--fsync", common.commit.sync, "End when the outputs are on the disk, safe from a power cut");
    }
    sub->add_option("--threads", common.threads,
                    "Threads to use; the result is the same for any number (default: all cores)")
        ->type_name("N")
        ->envname("ENVMAP_THREADS")
        ->check(CLI::Range(1, 1024));
    sub->add_flag("-q,--quiet", common.quiet, "No notes and no progress, only errors and what changes the result");
    sub->add_flag("-v,--verbose", common.verbose, "Say what is done and how long it takes");
    std::string footer = "Examples:\n";
    for (const Example& e : command.examples) footer += fmt::format("  {}\n      {}\n", e.command, e.what);
    sub->footer(footer);
    sub->callback([&run, action] { run = action; });
  }
  return app;
}

std::string joined(std::span<const std::string_view> words) {
  std::string all;
  for (const std::string_view w : words) all += (all.empty() ? "" : "|") + std::string(w);
  return all;
}

CLI::Option* add_projection(CLI::App& app, const std::string& flag, std::optional<Projection>& value,
                            const std::string& help) {
  std::vector<std::string_view> names;
  for (const Projection p : all_projections) names.emplace_back(name(p));
  return add_choice(app, flag, value, joined(names), projection_named, help);
}

CLI::Option* add_layout(CLI::App& app, const std::string& flag, std::optional<Layout>& value, const std::string& help) {
  std::vector<std::string_view> names;
  for (const Layout layout : cube_layouts) names.push_back(name(layout));
  return add_choice(app, flag, value, joined(names), layout_named, help);
}

CLI::Option* add_filter(CLI::App& app, std::optional<Filter>& value, const std::string& help) {
  std::string words = "auto";
  for (const FilterInfo& f : filters()) words += fmt::format("|{}", f.name);
  return app
      .add_option_function<std::string>(
          "--filter",
          [&value, words](const std::string& word) {
            const auto found = std::ranges::find(filters(), word, &FilterInfo::name);
            if (found == filters().end() && word != "auto")
              throw CLI::ValidationError("--filter", "'" + word + "' is none of " + words);
            value = word == "auto" ? std::nullopt : std::optional(found->filter);
          },
          help)
      ->type_name(words);
}

CLI::Option* add_forward(CLI::App& app, const std::string& flag, std::optional<Forward>& value, const std::string& help) {
  return add_choice(app, flag, value, joined(forward_names), forward_named, help);
}

CLI::Option* add_depth(CLI::App& app, std::optional<Depth>& value) {
  return add_choice(app, "--depth", value, joined(depth_names), one_of<Depth>(depth_names),
                    "What the file stores for each value (default: as the input, or the nearest the format holds)");
}

void add_format(CLI::App& app, WriteOptions& options) {
  app.add_option("--format", options.format, "File type, for '-' and names without one (default: exr)")
      ->type_name("EXT");
}

void add_clamp(CLI::App& app, WriteOptions& options) {
  app.add_flag("--clamp", options.clamp, "Clamp values that the depth cannot hold, and say the flux lost");
}

void add_write_options(CLI::App& app, WriteOptions& options) {
  add_depth(app, options.depth);
  add_format(app, options);
  add_file_options(app, options);
  add_clamp(app, options);
}

CLI::Option* add_display(CLI::App& app, std::optional<Display>& value, Display otherwise) {
  return add_choice(app, "--display", value, joined(display_names), one_of<Display>(display_names),
                    fmt::format("Tone curve of files of 8 bits: clip at 1; reinhard, x / (1 + x); neutral, colours as they are and "
                                "only what is bright drawn in (default: {})",
                                display_names[static_cast<std::size_t>(otherwise)]));
}

CLI::Validator number_in(const CLI::Range& range) {
  const auto check = [range](std::string& text) {
    double number = 0;
    const bool is_nan = CLI::detail::lexical_cast(text, number) && std::isnan(number);
    return is_nan ? "Value " + text + " is no number" : range(text);
  };
  return {check, range.get_description()};
}

CLI::Option* add_size(CLI::App& app, int& size, const std::string& help) {
  return app.add_option("--size", size, help)->type_name("N")->check(CLI::Range(1, 65536));
}
CLI::Option* add_size(CLI::App& app, std::optional<int>& size, const std::string& help) {
  return app.add_option("--size", size, help)->type_name("N")->check(CLI::Range(1, 65536));
}

std::optional<Direction> triple_of(const std::string& text, bool one_for_all) {
  std::vector<double> numbers;
  for (const std::string& part : CLI::detail::split(text, ',')) {
    double number = 0;
    if (!CLI::detail::lexical_cast(part, number) || !std::isfinite(number)) return std::nullopt;
    numbers.push_back(number);
  }
  if (one_for_all && numbers.size() == 1) numbers.assign(3, numbers[0]);
  if (numbers.size() != 3) return std::nullopt;
  return Direction(numbers[0], numbers[1], numbers[2]);
}

CLI::Option* add_triple(CLI::App& app, const std::string& flag, std::optional<Direction>& value,
                        const std::string& type, bool one_for_all, const std::string& help) {
  const auto parse = [&value, flag, type, one_for_all](const std::string& text) {
    value = triple_of(text, one_for_all);
    if (!value) throw CLI::ValidationError(flag, fmt::format("'{}' is not {}", text, type));
  };
  return app.add_option_function<std::string>(flag, parse, help)->type_name(type);
}

void add_read_options(CLI::App& app, ReadOptions& options) {
  add_projection(app, "--from", options.projection, "Projection of the input (default: its metadata, then its shape)");
  add_layout(app, "--from-layout", options.layout, "Where the input's cube faces lie (default: metadata, then shape)");
  add_forward(app, "--from-forward", options.forward,
              "World axis at the centre of a latlong or angular input (default: metadata, then --forward, then +z)");
  app.add_option("--from-border", options.border,
                 "Texels on each side of an octahedral or equal-area input that repeat others (default: metadata, then 0)")
      ->type_name("N")
      ->check(CLI::Range(0, 1024));
  app.add_flag("--ignore-envmap-attribute", options.ignore_envmap_attribute,
               "Read files with OpenEXR's envmap attribute as cell-centred, not as border samples");
  app.add_option("--level", options.level, "Mip level to read, of files that have some; 0 is the finest (default: 0)")
      ->type_name("N")
      ->check(CLI::Range(0, 31));
  app.add_flag("--drop-channels", options.drop_channels, "Read R, G and B of files with more channels");
  app.add_option("--part", options.choice.part,
                 "Of an EXR file with several: its name, or its number from 0 (default: the first)")
      ->type_name("PART");
  auto* const layer =
      app.add_option("--layer", options.choice.layer, "Of an EXR file: read LAYER.R, LAYER.G and LAYER.B")
          ->type_name("LAYER");
  app.add_option("--channels", options.choice.channels, "Of an EXR file: read these three as R, G and B, or one as grey")
      ->type_name("R,G,B")
      ->excludes(layer);
  app.add_flag("--crop", options.choice.crop,
               "Of an EXR file whose data window is not its display window: read the data window as the whole image");
  add_max_pixels(app, options);
  add_input_space(app, options);
}

void add_max_pixels(CLI::App& app, ReadOptions& options) {
  app.add_option("--max-pixels", options.max_pixels,
                 "Refuse larger images, before memory is taken for them (default: 2147483648, as 65536x32768: 24 GiB)")
      ->type_name("N")
      ->transform(CLI::AsSizeValue(true))
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 50, "number of pixels, such as 100M"));
}

void add_max_memory(CLI::App& app, ReadOptions& options) {
  app.add_option(
         "--max-memory", options.max_memory,
         "Memory to take, such as 2G or 500M: a map too large for it lies in a scratch file in $TMPDIR, else in "
         "/var/tmp (default: no limit)")
      ->type_name("SIZE")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::Range(std::size_t{1} << 26, std::size_t{1} << 50, "SIZE of 64M and more"));
}

void add_file_options(CLI::App& app, WriteOptions& options) {
  app.add_flag("--openexr-envmap", options.openexr_envmap,
               "Write EXR as OpenEXR's own tools do: with the envmap attribute and samples on the border of the image");
  app.add_option("--compression", options.compression,
                 "Of EXR files: none, rle, zips, zip, piz or pxr24; b44, b44a, dwaa or dwab lose something; zip:1 ... "
                 "zip:9 and "
                 "dwaa:45 set how hard (default: zip)")
      ->type_name("KIND");
  app.add_flag("--zstd", options.zstd, "Compress a KTX2 file with Zstandard");
}

int size_inside_border(int size, const WriteOptions& options) {
  if (size <= 2 * options.border)
    throw UsageError(fmt::format("--border {}: nothing is left of a size of {}", options.border, size));
  return size - 2 * options.border;
}

void add_border(CLI::App& app, WriteOptions& options, const std::string& size) {
  app.add_option("--border", options.border,
                 "Of octahedral and equal-area maps: write every level with N texels on each side that repeat what the square "
                 "goes on with, for textures; " + size + "; envmap:border records it, and reading leaves it out (default: 0)")
      ->type_name("N")
      ->check(CLI::Range(0, 1024));
}

void add_repair(CLI::App& app, ReadOptions& options) {
  app.add_flag_callback(
      "--repair", [&options] { options.flaws = FlawPolicy::repair; },
      "Replace NaN and infinite texels by their neighbours' mean and negative values by 0");
}

Source read_map(const std::string& path, const ReadOptions& options, const Common& common) {
  const Stopwatch watch;
  Source source = read(path, options);
  if (source.repaired > 0) warn(fmt::format("{}: repaired {} texels", path, source.repaired));
  common.also_read->insert(common.also_read->end(), source.colour_files.begin(), source.colour_files.end());
  for (const std::string& what : source.notes) warn(fmt::format("{}: {}", path, what));
  if (common.verbose) {
    for (const std::string& what : source.details) note(common, fmt::format("{}: {}", path, what));
    const Level& level = source.map.base();
    note(common, fmt::format("{}: {} {}x{}{}, {} {}, read in {:.2f} s", path, name(level.projection()), level.width(),
                             level.height(), level.faces() > 1 ? fmt::format(" x {} faces", level.faces()) : "",
                             source.format, name(source.depth), watch.seconds()));
  }
  return source;
}

Written write_map(const std::string& path, const Rows& rows, const WriteOptions& options,
                  const std::vector<std::string>& inputs, const std::string& verb, const Common& common) {
  return write_map(path, std::span(&rows, 1), options, inputs, verb, common);
}

Written write_map(const std::string& path, std::span<const Rows> levels, const WriteOptions& options,
                  const std::vector<std::string>& inputs, const std::string& verb, const Common& common) {
  check_files({path}, inputs, common);
  const std::vector<std::string> colours = out_of_working(options.colour).files;
  common.also_read->insert(common.also_read->end(), colours.begin(), colours.end());
  const auto depfile = open_depfile({path}, inputs, common, static_cast<int>(levels.size()));
  const Written written = write_one_map(path, levels, options, verb, common);
  if (depfile) depfile->commit();
  return written;
}

Written write_one_map(const std::string& path, std::span<const Rows> levels, const WriteOptions& options,
                      const std::string& verb, const Common& common) {
  const Stopwatch watch;
  const Rows& rows = levels.front();
  WriteOptions how = options;
  how.commit = common.commit;
  const Written written = write(path, levels, how, progress_line(common, verb));
  if (written.clamped > 0)
    warn(fmt::format("{}: clamped {} texels, {:.3g}% of the flux lost", path, written.clamped, 100 * written.flux_lost));
  if (common.verbose)
    note(common, fmt::format("{}: {} {}x{}{}{}, {}, made and written in {:.2f} s", path, name(rows.projection),
                             rows.width(), rows.size,
                             rows.projection == Projection::cube ? fmt::format(" x 6 faces ({})", name(written.layout)) : "",
                             levels.size() > 1 ? fmt::format(", {} levels", levels.size()) : "", name(written.depth),
                             watch.seconds()));
  return written;
}

void write_text(const std::string& path, std::string_view text, const CommitOptions& how) {
  OutputFile file(path, how);
  file.write(text.data(), text.size());
  file.commit();
}

}  // namespace tools
