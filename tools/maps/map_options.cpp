#include "maps/map_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "envmap/base/error.h"
#include "envmap/base/words.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/io/texels/rounding.h"

namespace tools {

using namespace envmap;

namespace {

// Those of the built-in config by names without a blank, which shells complete.
constexpr std::string_view spaces[] = {"ACEScg",    "ACES2065-1", "lin_rec709", "lin_rec2020",
                                       "lin_p3d65", "display_p3", "sRGB",       "XYZ"};

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

}  // namespace

std::string projection_words() {
  return joined(all_projections, "|", [](Projection p) { return name(p); });
}

Option& add_projection(Options& o, std::string_view flag, std::optional<Projection>& value, std::string_view help) {
  return add_named(o, flag, projection_words(), value, projection_named, help);
}
Option& add_layout(Options& o, std::string_view flag, std::optional<Layout>& value, std::string_view help) {
  return add_named(o, flag, joined(cube_layouts, "|", [](Layout l) { return name(l); }), value, layout_named, help);
}
void add_faces(Options& o, WriteOptions& w) {
  const std::string names = joined(face_conventions(), " ", &FaceConvention::name);
  o.add("--faces", "NAMES", &w.faces, fmt::format("Names for {{face}}: {}, or a,b,c,d,e,f", names));
}
Option& add_forward(Options& o, std::string_view flag, std::optional<Forward>& value, std::string_view help) {
  return add_named(o, flag, joined(forward_names, "|"), value, forward_named, help);
}

Option& add_filter(Options& o, std::optional<Filter>& value, std::string_view help) {
  const std::string words = "auto|" + joined(filters(), "|", &FilterInfo::name);
  return o.add(
      "--filter FILTER", words,
      [&value](const std::string& word) {
        const auto found = std::ranges::find(filters(), word, &FilterInfo::name);
        value = found == filters().end() ? std::nullopt : std::optional(found->filter);
        return value || word == "auto";
      },
      help);
}

Option& add_display(Options& o, std::optional<Display>& value, Display otherwise) {
  return o.add("--display CURVE", one_of(value, display_names),
               fmt::format("Tone curve of files of 8 or 16 bits: {{}} (default: {})",
                           display_names[std::size_t(otherwise)]));
}
Option& add_size(Options& o, const Value& value, std::string_view help) {
  return o.add("--size", "N", value, range_of(limits::size), help);
}
Option& add_exposure(Options& o, double& stops) {
  return o.add("--exposure", "STOPS", &stops, range_of(limits::exposure), "Multiply radiance by 2^STOPS (default: 0)");
}

void add_read_options(Options& o, ReadOptions& r) {
  o.group = groups::input_map;
  add_projection(o, "--from PROJECTION", r.projection, "Projection of the input (default: metadata, then image shape)");
  add_forward(o, "--from-forward AXIS", r.forward,
              "Axis at the centre (default: metadata, --forward, +z), see also --apply-pose");
  add_layout(o, "--from-layout LAYOUT", r.layout,
             "Layout of the input's cube faces (default: metadata, then image shape)");
  o.add("--from-faces", "NAMES", &r.faces, "Names for {face} of the input (default: metadata, then px,nx,...)");
  o.add("--from-border", "N", &r.border, range_of(limits::border),
        "Wrapped texels per side of the input (default: metadata, then 0)");
  o.add("--level", "N", &r.level, range_of(limits::level), "Mip level to read, 0 is the finest (default: 0)");
  o.flag("--drop-channels", r.drop_channels, "Read R, G and B of a file that has more channels");
  o.add("--part", "PART", &r.choice.part, "EXR: name of a part, or its number from 0 (default: the first)");
  o.add("--layer", "LAYER", &r.choice.layer, "EXR: read LAYER.R, LAYER.G and LAYER.B");
  o.add("--channels", "R,G,B", &r.choice.channels, "EXR: read these channels as R, G and B, or one channel as grey")
      .excludes = "--layer";
  o.add("--headroom", "STOPS", &r.choice.headroom, range_of(limits::headroom),
        "Highlights to read from a JPEG gain map, in stops above white (default: all)")
      .folded = true;
  o.flag("--crop", r.choice.crop, "EXR, TIFF: read the data window as the whole image");
  o.flag("--ignore-envmap-attribute", r.ignore_envmap_attribute,
         "Treat samples as texel centres, see also --border-samples");
  Option& border = o.flag("--border-samples", r.border_samples,
                          "Treat samples as lying on the image border, as OpenEXR's envmap attribute says");
  border.excludes = "--ignore-envmap-attribute", border.folded = true;
  o.flag("--apply-pose", r.apply_pose, "Rotate a panorama by the camera's heading, pitch and roll in its GPano XMP")
      .folded = true;
  add_max_pixels(o, r);
  o.group = groups::colour;
  o.add("--input-space", "SPACE", &r.colour.space,
        "Colour space of the input (default: the file's, else Rec.709 or sRGB)")
      .suggested = spaces;
  o.add(
       "--ocio", "CONFIG",
       [&r](const std::string& file) { return r.colour.config = file == "builtin" ? "" : file, true; },
       "OpenColorIO config, or 'builtin' (default: $OCIO, then builtin)")
      .environment = "OCIO";
}

void add_max_pixels(Options& o, ReadOptions& r) {
  o.add("--max-pixels", "N", Size{&r.max_pixels, true}, {1, 0x1p50},
        "Reject larger images before memory is allocated (default: 2147483648)");
}
void add_max_memory(Options& o, ReadOptions& r) {
  o.group = groups::builds;
  constexpr Range range{0x1p26, 0x1p50};
  o.add("--max-memory", "SIZE", Size{&r.max_memory, false}, range,
        "Memory limit, such as 2G (larger maps use a scratch file) (default: none)");
}
void add_repair(Options& o, ReadOptions& r) {
  o.group = groups::input_map;
  static constexpr std::string_view help = "Replace NaN and infinity by the mean of neighbours, negatives by 0";
  o.add(
      "--repair", "", [&r](const std::string&) { return r.flaws = FlawPolicy::repair, true; }, help);
}

Option& add_depth(Options& o, WriteOptions& w, std::string_view otherwise) {
  return o.add("--depth", one_of(w.depth, depth_names), fmt::format("{{}} (default: {})", otherwise));
}
void add_format(Options& o, WriteOptions& w) {
  o.add("--format", "EXT", &w.format, "File type for '-' or a name without extension (default: exr)");
}
void add_file_options(Options& o, WriteOptions& w) {
  o.add("--compression", "KIND", &w.compression,
        "EXR: none rle zips zip[:1-9] piz pxr24 b44 b44a dwaa[:N] dwab[:N] (zip)");
  o.flag("--zstd", w.zstd, "Compress KTX2 with Zstandard");
  o.flag("--openexr-envmap", w.openexr_envmap, "Write OpenEXR's envmap attribute, with samples on the image border");
}
void add_clamp(Options& o, WriteOptions& w) {
  o.flag("--clamp", w.clamp, "Clamp values that the depth cannot store, and report the lost flux");
}
void add_write_options(Options& o, WriteOptions& w, std::string_view depth) {
  o.group = groups::output_file;
  add_depth(o, w, depth), add_format(o, w), add_clamp(o, w), add_file_options(o, w);
}
void add_border(Options& o, WriteOptions& w, std::string_view size) {
  o.add("--border", "N", &w.border, range_of(limits::border),
        fmt::format("Octahedral, equal-area: wrapped texels per side, {} (default: 0)", size));
}
void add_output_space(Options& o, WriteOptions& w) {
  o.group = groups::colour;
  o.add("--output-space", "SPACE", &w.colour.space,
        "Colour space; encoded in floats with --encoded (default: Rec.709 or sRGB)")
      .suggested = spaces;
  o.flag("--encoded", w.encoded, "Allow an encoded --output-space, such as 'Display P3', in float files").folded = true;
}

int size_inside_border(int size, const WriteOptions& w) {
  if (size <= 2 * w.border)
    throw UsageError(fmt::format("--border {}: nothing is left of a size of {}", w.border, size));
  return size - 2 * w.border;
}

std::string depth_for_error(const std::string& path, const WriteOptions& options, double max_error) {
  for (const Depth depth : {Depth::half, Depth::single}) {
    WriteOptions other = options;
    other.depth = depth, other.compression.clear(), other.openexr_envmap = false;
    try {
      const std::optional<Rounding> rounding = rounding_of(path, other);
      const bool bounded = rounding && bounds_every_channel(*rounding, 1);
      if (!bounded || *rounding->largest >= max_error) continue;
      return fmt::format("--depth {}{}{}", name(depth), options.compression.empty() ? "" : " and no --compression",
                         options.openexr_envmap ? " and no --openexr-envmap" : "");
    } catch (const UsageError&) {  // Not of this format.
    }
  }
  return "";
}

}  // namespace tools
