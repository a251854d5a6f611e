#include "shared/map_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "envmap/base/error.h"
#include "envmap/io/file_format.h"
#include "envmap/io/rounding.h"

namespace tools {

using namespace envmap;

namespace {

// Words that have more spellings than help shows.
template <class T, class Named>
Option& add_named(Options& o, std::string_view name, std::string_view words, std::optional<T>& value, Named named,
                  std::string_view help) {
  return o.add(
      name, words,
      [&value, named](const std::string& word) {
        value = named(word);
        return value.has_value();
      },
      help);
}

std::string projection_words() {
  std::string words;
  for (const Projection p : all_projections) words += (words.empty() ? "" : "|") + std::string(name(p));
  return words;
}

std::string layout_words() {
  std::string words;
  for (const Layout l : cube_layouts) words += (words.empty() ? "" : "|") + std::string(name(l));
  return words;
}

}  // namespace

Option& add_projection(Options& o, std::string_view flag, std::optional<Projection>& value, std::string_view help) {
  return add_named(o, flag, projection_words(), value, projection_named, help);
}
Option& add_layout(Options& o, std::string_view flag, std::optional<Layout>& value, std::string_view help) {
  return add_named(o, flag, layout_words(), value, layout_named, help);
}
Option& add_forward(Options& o, std::string_view flag, std::optional<Forward>& value, std::string_view help) {
  return add_named(o, flag, joined(forward_names), value, forward_named, help);
}

Option& add_filter(Options& o, std::optional<Filter>& value, std::string_view help) {
  std::string words = "auto";
  for (const FilterInfo& f : filters()) words += fmt::format("|{}", f.name);
  return o.add(
      "--filter", words,
      [&value](const std::string& word) {
        const auto found = std::ranges::find(filters(), word, &FilterInfo::name);
        value = found == filters().end() ? std::nullopt : std::optional(found->filter);
        return value || word == "auto";
      },
      help);
}

Option& add_display(Options& o, std::optional<Display>& value, Display otherwise) {
  return o.add("--display", one_of(value, display_names),
               fmt::format("Tone curve of files of 8 bits: clip at 1; reinhard, x / (1 + x); neutral, colours as they "
                           "are and only what is bright drawn in (default: {})",
                           display_names[static_cast<std::size_t>(otherwise)]));
}
Option& add_size(Options& o, const Value& value, std::string_view help) {
  return o.add("--size", "N", value, range_of(limits::size), help);
}
Option& add_exposure(Options& o, double& stops) {
  return o.add("--exposure", "STOPS", &stops, {-100, 100}, "Multiply radiance by 2^STOPS");
}

void add_read_options(Options& o, ReadOptions& r) {
  add_projection(o, "--from", r.projection, "Projection of the input (default: its metadata, then its shape)");
  add_layout(o, "--from-layout", r.layout, "Where the input's cube faces lie (default: metadata, then shape)");
  add_forward(o, "--from-forward", r.forward,
              "World axis at the centre of a latlong or angular input (default: metadata, then --forward, then +z)");
  o.add("--from-border", "N", &r.border, range_of(limits::border),
        "Texels on each side of an octahedral or equal-area input that repeat others (default: metadata, then 0)");
  o.flag("--ignore-envmap-attribute", r.ignore_envmap_attribute,
         "Read files with OpenEXR's envmap attribute as cell-centred, not as border samples");
  o.add("--level", "N", &r.level, range_of(limits::level), "Mip level to read, of files that have some; 0 is the finest (default: 0)");
  o.flag("--drop-channels", r.drop_channels, "Read R, G and B of files with more channels");
  o.add("--part", "PART", &r.choice.part,
        "Of an EXR file with several: its name, or its number from 0 (default: the first)");
  o.add("--layer", "LAYER", &r.choice.layer, "Of an EXR file: read LAYER.R, LAYER.G and LAYER.B");
  o.add("--channels", "R,G,B", &r.choice.channels, "Of an EXR file: read these three as R, G and B, or one as grey")
      .excludes = "--layer";
  o.flag("--crop", r.choice.crop,
         "Of an EXR file whose data window is not its display window: read the data window as the whole image");
  add_max_pixels(o, r);
  o.add("--input-space", "SPACE", &r.colour.space,
        "Colour space of the input's values (default: what it says; else linear Rec.709 of floats, sRGB of integers)");
  o.add(
       "--ocio", "CONFIG",
       [&r](const std::string& file) { return r.colour.config = file == "builtin" ? "" : file, true; },
       "OpenColorIO config that names of spaces are looked up in; 'builtin' is a small one of our own: 'Linear "
       "Rec.709', sRGB, ACEScg, ACES2065-1, "
       "'Linear Rec.2020', XYZ, 'Linear P3-D65', 'Display P3' (default: $OCIO, then builtin)")
      .environment = "OCIO";
}

void add_max_pixels(Options& o, ReadOptions& r) {
  o.add("--max-pixels", "N:SIZE [b, kb(=1000b), kib(=1024b), ...]:number of pixels, such as 100M",
        Size{&r.max_pixels, true}, {1, 0x1p50},
        "Refuse larger images, before memory is taken for them (default: 2147483648, as 65536x32768: 24 GiB)");
}
void add_max_memory(Options& o, ReadOptions& r) {
  constexpr Range range{0x1p26, 0x1p50};
  o.add("--max-memory", "SIZE:SIZE [b, kb(=1024b), ...]:SIZE of 64M and more", Size{&r.max_memory, false}, range,
        "Memory to take, such as 2G or 500M: a map too large for it lies in a scratch file in $TMPDIR, else in "
        "/var/tmp (default: no limit)");
}
void add_repair(Options& o, ReadOptions& r) {
  static constexpr std::string_view help =
      "Replace NaN and infinite texels by their neighbours' mean and negative values by 0";
  o.add(
      "--repair", "", [&r](const std::string&) { return r.flaws = FlawPolicy::repair, true; }, help);
}

Option& add_depth(Options& o, WriteOptions& w) {
  return o.add("--depth", one_of(w.depth, depth_names),
               "What the file stores for each value (default: as the input, or the nearest the format holds)");
}
void add_format(Options& o, WriteOptions& w) {
  o.add("--format", "EXT", &w.format, "File type, for '-' and names without one (default: exr)");
}
void add_file_options(Options& o, WriteOptions& w) {
  o.flag("--openexr-envmap", w.openexr_envmap,
         "Write EXR as OpenEXR's own tools do: with the envmap attribute and samples on the border of the image");
  o.add("--compression", "KIND", &w.compression,
        "Of EXR files: none, rle, zips, zip, piz or pxr24; b44, b44a, dwaa or dwab lose something; zip:1 ... zip:9 and "
        "dwaa:45 set how hard (default: zip)");
  o.flag("--zstd", w.zstd, "Compress a KTX2 file with Zstandard");
}
void add_clamp(Options& o, WriteOptions& w) {
  o.flag("--clamp", w.clamp, "Clamp values that the depth cannot hold, and say the flux lost");
}
void add_write_options(Options& o, WriteOptions& w) {
  add_depth(o, w), add_format(o, w), add_file_options(o, w), add_clamp(o, w);
}
void add_border(Options& o, WriteOptions& w, std::string_view size) {
  o.add("--border", "N", &w.border, range_of(limits::border),
        fmt::format("Of octahedral and equal-area maps: write every level with N texels on each side that repeat what "
                    "the square goes on with, for textures; {}; "
                    "envmap:border records it, and reading leaves it out (default: 0)",
                    size));
}
void add_output_space(Options& o, WriteOptions& w) {
  o.add("--output-space", "SPACE", &w.colour.space,
        "Colour space of the output's values (default: linear Rec.709 of floats, sRGB of integers)");
  o.flag("--encoded", w.encoded,
         "Write an encoded --output-space, such as 'Display P3', to a format whose values other programs take for linear");
}
void add_costs(Options& o, std::string& path) {
  o.add("--costs", "FILE", &path,
        "Choose methods by the times in FILE, which 'envmap tradeoff --calibrate --save' writes: quicker on this "
        "machine, but with another file the same "
        "command may give other bytes (default: the times of a common x86-64 server)")
      .environment = "ENVMAP_COSTS";
}

int size_inside_border(int size, const WriteOptions& w) {
  if (size <= 2 * w.border)
    throw UsageError(fmt::format("--border {}: nothing is left of a size of {}", w.border, size));
  return size - 2 * w.border;
}

std::string depth_that_holds(const std::string& path, const WriteOptions& options, double max_error) {
  for (const Depth depth : {Depth::half, Depth::single}) {
    WriteOptions other = options;
    other.depth = depth, other.compression.clear(), other.openexr_envmap = false;
    try {
      const std::optional<Rounding> rounding = rounding_of(path, other);
      if (!rounding || rounding->largest.value_or(1) >= max_error) continue;
      return fmt::format("--depth {}{}{}", name(depth), options.compression.empty() ? "" : " and no --compression",
                         options.openexr_envmap ? " and no --openexr-envmap" : "");
    } catch (const UsageError&) {  // Not of this format.
    }
  }
  return "";
}

}  // namespace tools
