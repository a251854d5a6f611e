#include "envmap/io/read_colours.h"

#include <fmt/format.h>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/io/colour_config.h"
#include "envmap/operate/grade.h"

namespace envmap {
namespace {

constexpr const char *by_integers = "integers", *by_format = "its format";

bool is_srgb(const TextureFile& t) { return t.texels == Texels::rgb8_srgb || t.texels == Texels::rgba8_srgb; }

// The words of the file itself, before its format is asked.
ClaimedSpace written_space(const Metadata& recorded, const Attributes& texts, const std::string& format) {
  const BuiltInSpace* named = built_in_space(recorded.space);
  if (texts.contains("acesImageContainerFlag")) return {aces2065_1, aces_ap0, "ACES container"};
  if (const auto& said = recorded.provenance.chromaticities; said && is_possible(primaries(*said))) {
    const Primaries p = primaries(*said);
    // The word knows of curves; primaries that contradict it were written by another program.
    if (named != nullptr && same(named->primaries, p)) return {std::string(named->name), p, "envmap:space"};
    return {space_with(p), p, format == "hdr" ? "PRIMARIES" : "chromaticities"};
  }
  return named != nullptr ? ClaimedSpace{std::string(named->name), named->primaries, "envmap:space"} : ClaimedSpace{};
}

// Whether reading made linear Rec.709 of it already.
bool is_decoded(const ClaimedSpace& claimed) { return claimed.by == by_integers || claimed.by == by_format; }

void tell_primaries(Source& source, const std::optional<Primaries>& now, const ColourOptions& options) {
  const bool said = !source.claimed.by.empty() && !is_decoded(source.claimed);
  auto& told = source.provenance.chromaticities;
  if (!now || (!said && options.space.empty() && options.working.empty()))
    told.reset();
  else if (!told || !same(primaries(*told), *now))
    told = chromaticities(*now);
}

}  // namespace

ClaimedSpace claimed_space(Image& image, const Metadata& recorded, const ColourOptions& options) {
  const bool encoded = image.texture ? is_srgb(*image.texture) : image.reader->facts.encoded;
  if (image.texture && encoded && !options.space.empty())
    throw UsageError(image.name, "its format says that it is sRGB: another space of its values makes no sense");
  const ClaimedSpace written = image.texture
                                   ? written_space(recorded, {}, "")
                                   : written_space(recorded, image.reader->facts.attributes, image.reader->format);
  if (image.texture) {
    const KhrColour colour = image.texture->colour;
    const ClaimedSpace described = space_of(colour);
    const Primaries p = described.primaries.value_or(rec709);
    if (encoded) return {encoded_space_with(p), p, by_format};
    if (!written.by.empty() || !described.by.empty()) return written.by.empty() ? described : written;
    if (colour.transfer > khr_srgb && options.space.empty())
      throw InputError(image.name,
                       fmt::format("KTX2 with transfer function {}: only linear and sRGB are decoded", colour.transfer),
                       Remedy::choose_space);
  }
  image.decode = encoded && options.space.empty() && written.name.empty();
  if (image.decode) return {"sRGB", rec709, by_integers};
  return written;
}

ColourTransform colours_of(const Source& source, const ColourOptions& options) {
  const bool decoded = is_decoded(source.claimed);
  if (!decoded) return into_working(options, source.claimed);
  const Primaries p = source.claimed.primaries.value_or(rec709);
  return into_working(options, ClaimedSpace{space_with(p), p});
}

bool same(const ClaimedSpace& a, const ClaimedSpace& b) {
  if (a.name != b.name || a.primaries.has_value() != b.primaries.has_value()) return false;
  return !a.name.empty() || !a.primaries || same(*a.primaries, *b.primaries);
}

void into_working(Source& source, const ColourTransform& transform, const ColourOptions& options) {
  source.colour_files = transform.files;
  if (!transform.note.empty()) source.notes.push_back(transform.note);
  const std::optional<Primaries> now = primaries_of(options.config, options.working);
  tell_primaries(source, now, options);
  if (!transform.apply) return;
  std::int64_t outside = 0;
  for (Level& level : source.map.levels) {
    for_each_row(level.faces(), level.height(), {}, [&](int face, int j) {
      transform.apply(level.row(face, j));
      level.trim();
    });
    outside += into_gamut(level, luminance_weights(now.value_or(rec709)));
  }
  const ClaimedSpace& claimed = source.claimed;
  const std::string from = !options.space.empty()  ? options.space
                           : !claimed.name.empty() ? claimed.name
                           : claimed.primaries     ? "its primaries"
                                                   : linear_rec709;
  const std::string to = options.working.empty() ? linear_rec709 : options.working;
  source.details.push_back(fmt::format("from {} to {}", from, to));
  if (outside > 0)
    source.notes.push_back(
        fmt::format("{} texels of {} are outside of {}: brought to its border, luminance kept", outside, from, to));
}

}  // namespace envmap
