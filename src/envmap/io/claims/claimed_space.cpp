#include "envmap/io/claims/claimed_space.h"

#include <fmt/format.h>

#include <algorithm>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/io/claims/colour_config.h"
#include "envmap/operate/grade.h"

namespace envmap {
namespace {

bool is_srgb(const TextureFile& t) {
  return t.texels == Texels::rgb8_srgb || t.texels == Texels::rgba8_srgb || t.texels == Texels::packed_srgb;
}

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

ClaimedSpace written_of(const Image& image, const Metadata& recorded) {
  if (image.texture) return written_space(recorded, {}, "");
  return written_space(recorded, image.reader->facts.attributes, image.reader->format);
}

void tell_primaries(Source& source, const std::optional<Primaries>& now, const ColourOptions& options) {
  const ClaimedSpace& claimed = source.claimed;
  const bool is_usual = claimed.decoded && same(claimed.primaries.value_or(rec709), rec709);
  const bool said = !claimed.by.empty() && !is_usual;
  auto& told = source.provenance.chromaticities;
  if (!now || (!said && options.space.empty() && options.working.empty()))
    told.reset();
  else if (!told || !same(primaries(*told), *now))
    told = chromaticities(*now);
}

// A claim that every format has in a way of its own: primaries, or a word of this program.
std::optional<Claim> claim_of(const ClaimedSpace& written) {
  if (written.by.empty()) return std::nullopt;
  const std::string value = words(written);
  return Claim{.name = written.by, .value = value.substr(0, value.rfind(" (")), .of_colour = true};
}

}  // namespace

ClaimedSpace claimed_space(Image& image, const Metadata& recorded, const ColourOptions& options) {
  const bool encoded = image.texture ? is_srgb(*image.texture) : image.reader->facts.encoded;
  if (image.texture && encoded && !options.space.empty())
    throw UsageError(image.name, "its format says that it is sRGB: another space of its values makes no sense");
  const ClaimedSpace written = written_of(image, recorded);
  const auto& said = recorded.provenance.chromaticities;
  if (said && written.by.empty() && options.space.empty() && !is_possible(primaries(*said)))
    throw InputError(image.name, "damaged: chromaticities that no light has", Remedy::choose_space);
  if (image.texture) {
    const KhrColour colour = image.texture->colour;
    if (colour.primaries > 0 && !knows_primaries(colour.primaries) && written.by.empty() && options.space.empty())
      throw InputError(image.name, fmt::format("not supported: KTX2 of primaries {}", colour.primaries),
                       Remedy::choose_space);
    const ClaimedSpace described = space_of(colour);
    const Primaries p = described.primaries.value_or(rec709);
    if (encoded) return {encoded_space_with(p), p, "its format", true};
    if (!written.by.empty() || !described.by.empty()) return written.by.empty() ? described : written;
    if (colour.transfer > khr_srgb && options.space.empty())
      throw InputError(image.name,
                       fmt::format("KTX2 with transfer function {}: only linear and sRGB are decoded", colour.transfer),
                       Remedy::choose_space);
  }
  image.decode = options.space.empty();
  if (!image.decode && image.reader && image.reader->facts.colour && image.reader->facts.colour->fixed)
    throw UsageError(image.name, fmt::format("its {} says what its values are: another space of them makes no sense",
                                             image.reader->facts.colour->space.by));
  if (image.texture && image.texture->by_integers && image.decode) return {"sRGB", rec709, "integers", true};
  if (image.texture || !image.decode) return written;
  // A word of ours may outlive a change of the values, but where it agrees with what other programs read it is exact.
  const std::optional<StatedColour>& stated = image.reader->facts.colour;
  if (stated && (written.name.empty() || written.name != stated->space.name)) return stated->space;
  image.decode = written.name.empty();
  return encoded && image.decode ? ClaimedSpace{"sRGB", rec709, "integers", true} : written;
}

void record_colours(Source& source, Image& image, const Metadata& recorded, const ColourOptions& options) {
  source.claimed = claimed_space(image, recorded, options);
  const StatedColour* stated = image.reader && image.reader->facts.colour ? &*image.reader->facts.colour : nullptr;
  if (stated && image.decode && stated->white_luminance) source.provenance.white_luminance = stated->white_luminance;
  const ClaimedSpace written = image.reader && stated ? written_of(image, recorded) : source.claimed;
  if (std::optional<Claim> claim = written.by == "integers" ? std::nullopt : claim_of(written)) {
    if (stated && written.by != source.claimed.by)
      claim->outcome = Claim::Outcome::ignored, claim->reason = stated->space.by + " comes first";
    const auto is_same = [&](const Claim& c) { return c.name == claim->name; };
    // The reader of Radiance pictures tells all that they say.
    if (source.format != "hdr" && std::ranges::none_of(source.claims, is_same)) source.claims.push_back(*claim);
  }
  if (options.space.empty()) return;
  for (Claim& c : source.claims)
    if (c.of_colour && c.outcome == Claim::Outcome::honoured) c.outcome = Claim::Outcome::overridden;
}

ColourTransform colours_of(const Source& source, const ColourOptions& options) {
  if (!source.claimed.decoded) return into_working(options, source.claimed);
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
