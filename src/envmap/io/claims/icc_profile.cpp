#include "envmap/io/claims/icc_profile.h"

#include <fmt/format.h>
#include <lcms2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/io/claims/code_points.h"
#include "envmap/io/claims/colour_config.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

// A profile as Little CMS opens it, in a context of its own that keeps the first message.
class Profile {
 public:
  explicit Profile(std::span<const std::byte> bytes) : context_(cmsCreateContext(nullptr, this), cmsDeleteContext) {
    if (!context_) throw std::bad_alloc();
    cmsSetLogErrorHandlerTHR(context_.get(), [](cmsContext context, cmsUInt32Number, const char* text) {
      auto& message = static_cast<Profile*>(cmsGetContextUserData(context))->message_;
      if (message.empty()) message = text;
    });
    profile_ = {cmsOpenProfileFromMemTHR(context_.get(), bytes.data(), cmsUInt32Number(bytes.size())), cmsCloseProfile};
    if (!profile_) fail(fmt::format("damaged: {}", message_));
    std::array<char, 256> text = {};
    cmsGetProfileInfoASCII(get(), cmsInfoDescription, "en", "US", text.data(), text.size());
    name_ = text.data();
    std::ranges::replace_if(
        name_, [](unsigned char c) { return c < ' ' || c > '~'; }, '?');
  }
  Profile(const Profile&) = delete;

  [[nodiscard]] cmsHPROFILE get() const { return profile_.get(); }
  [[nodiscard]] cmsContext context() const { return context_.get(); }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& message() const { return message_; }

  [[noreturn]] void fail(const std::string& why) const {
    const std::string name = name_.empty() ? "ICC profile" : fmt::format("ICC profile '{}'", name_);
    throw InputError(fmt::format("{}: {}", name, why.empty() ? "damaged" : why), Remedy::choose_space);
  }

  /// @throws InputError where the tag is not there, or broken.
  template <class T>
  const T* tag(cmsTagSignature signature) const {
    const void* value = cmsReadTag(get(), signature);
    if (!value)
      fail(fmt::format("damaged: its tag '{}{}{}{}' cannot be read", char(signature >> 24), char(signature >> 16),
                       char(signature >> 8), char(signature)));
    return static_cast<const T*>(value);
  }

 private:
  std::string message_, name_;
  std::unique_ptr<std::remove_pointer_t<cmsContext>, decltype(&cmsDeleteContext)> context_;
  std::unique_ptr<void, decltype(&cmsCloseProfile)> profile_{nullptr, cmsCloseProfile};
};

// ---- curves (ICC.1, sections 10.6 and 10.18) ------------------------------------------------------------------------

struct ToneCurve {
  int kind = 0;                           // Of Little CMS: parametric 1 to 5; 0: a table.
  std::array<double, 7> parameters = {};  // g a b c d e f.
  std::vector<double> table = {};         // Of equal steps from 0 to 1.

  // @param x from 0 on, and of a table up to 1.
  [[nodiscard]] double at(double x) const {
    const auto [g, a, b, c, d, e, f] = parameters;
    const double base = a * x + b, power = kind > 0 ? portable::pow(std::max(kind == 1 ? x : base, 0.0), g) : 0;
    switch (kind) {
      case 0: return of_table(x);
      case 1: return power;
      case 2: return base >= 0 ? power : 0;
      case 3: return base >= 0 ? power + c : c;
      case 4: return x >= d ? power : c * x;
      default: return x >= d ? power + e : c * x + f;
    }
  }
  [[nodiscard]] bool is_identity() const { return kind == 1 && parameters[0] == 1; }
  // As files round its five numbers.
  [[nodiscard]] bool is_srgb() const {
    constexpr std::array<double, 5> exact{2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045};
    constexpr double rounded = 2.0 / 65536;
    return kind == 4 && std::equal(exact.begin(), exact.end(), parameters.begin(),
                                   [](double x, double y) { return std::abs(x - y) < rounded; });
  }

 private:
  [[nodiscard]] double of_table(double x) const {
    const double place = x * double(table.size() - 1);
    const auto k = std::min(std::size_t(place), table.size() - 2);
    const double t = place - double(k);
    return table[k] * (1 - t) + table[k + 1] * t;
  }
};

ToneCurve read_curve(const Profile& profile, cmsTagSignature signature) {
  const auto* curve = profile.tag<cmsToneCurve>(signature);
  ToneCurve read{.kind = cmsGetToneCurveParametricType(curve)};
  if (read.kind >= 1 && read.kind <= 5) {
    std::copy_n(cmsGetToneCurveParams(curve), read.parameters.size(), read.parameters.begin());
    if (std::ranges::all_of(read.parameters, [](double x) { return std::isfinite(x); })) return read;
  }
  const std::span entries(cmsGetToneCurveEstimatedTable(curve), cmsGetToneCurveEstimatedTableEntries(curve));
  if (read.kind != 0 || entries.size() < 2) profile.fail("damaged: a curve of no kind that ICC.1 has");
  for (const cmsUInt16Number entry : entries) read.table.push_back(entry / 65535.0);
  return read;
}

// In place, curve by curve. Values below 0 stay there, so that they are seen as the flaws they are.
std::function<void(std::span<Colour>)> decoder(std::array<ToneCurve, 3> curves, const std::string& name) {
  if (std::ranges::all_of(curves, &ToneCurve::is_identity)) return {};
  if (std::ranges::all_of(curves, &ToneCurve::is_srgb)) return decode_srgb;
  const bool has_table = std::ranges::any_of(curves, [](const ToneCurve& c) { return c.kind == 0; });
  return [curves = std::move(curves), has_table, name](std::span<Colour> colours) {
    if (has_table && std::ranges::any_of(colours, [](const Colour& c) { return std::max({c.x, c.y, c.z}) > 1; }))
      throw InputError(fmt::format("holds values above 1, where the curve of ICC profile '{}' ends", name),
                       Remedy::choose_space);
    parallel_ranges(int(colours.size()), 1 << 12, [&](int begin, int end) {
      for (Colour& c : colours.subspan(std::size_t(begin), std::size_t(end - begin)))
        for (int k = 0; k < 3; ++k) {
          const auto& curve = curves[std::size_t(k)];
          if (std::isfinite(c[k])) c[k] = float(c[k] < 0 ? -curve.at(-double{c[k]}) : curve.at(c[k]));
        }
    });
  };
}

// ---- matrices -------------------------------------------------------------------------------------------------------

// The illuminant of the connection space (ICC.1, section 7.2.16).
constexpr Flux pcs_white{0.9642, 1, 0.8249};

Point2 chromaticity(const Flux& xyz) {
  const double sum = xyz.x + xyz.y + xyz.z;
  return {xyz.x / sum, xyz.y / sum};
}

Flux column(const Profile& profile, cmsTagSignature signature) {
  const auto* xyz = profile.tag<cmsCIEXYZ>(signature);
  return {xyz->X, xyz->Y, xyz->Z};
}

double largest_difference(const ColourMatrix& a, const ColourMatrix& b) {
  double most = 0;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j) most = std::max(most, std::abs(a[k][j] - b[k][j]));
  return most;
}

// Primaries under what red, green and blue make together, or those of the built-in space that the profile's numbers are
// rounded from; nothing where that is not the white of the connection space.
std::optional<Primaries> primaries_of(const Profile& profile) {
  const ColourMatrix m(column(profile, cmsSigRedColorantTag), column(profile, cmsSigGreenColorantTag),
                       column(profile, cmsSigBlueColorantTag));
  constexpr double rounding = 3e-4, white_of_programs = 1e-3;
  const Flux white = m[0] + m[1] + m[2], off = white - pcs_white;
  if (!(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) < white_of_programs)) return std::nullopt;
  const Primaries p{chromaticity(m[0]), chromaticity(m[1]), chromaticity(m[2]), chromaticity(white)};
  if (!is_possible(p)) profile.fail("damaged: no light has such primaries");
  for (const BuiltInSpace& space : built_in_spaces())
    if (!same(space.primaries, cie_xyz) &&
        largest_difference(conversion(space.primaries, rec709), conversion(p, rec709)) < rounding)
      return space.primaries;
  return p;
}

void name_space(IccColours& made, const std::array<ToneCurve, 3>& curves) {
  ClaimedSpace& space = made.colour.space;
  std::string known;
  if (std::ranges::all_of(curves, &ToneCurve::is_identity)) known = space_with(*space.primaries);
  if (std::ranges::all_of(curves, &ToneCurve::is_srgb)) known = encoded_space_with(*space.primaries);
  const bool is_new = !known.empty() && known != made.name;
  space.name = known.empty() ? made.name : known;
  space.by = is_new ? fmt::format("ICC profile '{}'", made.name) : "ICC profile";
  space.decoded = true;
}

bool has_any(const Profile& profile, std::initializer_list<cmsTagSignature> tags) {
  return std::ranges::any_of(tags, [&](cmsTagSignature tag) { return cmsIsTag(profile.get(), tag); });
}

bool has_look_up_tables(const Profile& profile) {
  return has_any(profile, {cmsSigAToB0Tag, cmsSigAToB1Tag, cmsSigDToB0Tag, cmsSigDToB1Tag});
}

// @return whether curves and a matrix, or the curve of grey, are all of the profile.
bool read_matrix(const Profile& profile, IccColours& made) {
  if (made.channels == 4 || has_look_up_tables(profile)) return false;
  std::array<ToneCurve, 3> curves;
  if (made.channels == 1) {
    if (cmsGetPCS(profile.get()) != cmsSigXYZData) return false;
    curves.fill(read_curve(profile, cmsSigGrayTRCTag));
    made.colour.space.primaries = rec709;
  } else {
    made.colour.space.primaries = primaries_of(profile);
    if (!made.colour.space.primaries) return false;
    curves = {read_curve(profile, cmsSigRedTRCTag), read_curve(profile, cmsSigGreenTRCTag),
              read_curve(profile, cmsSigBlueTRCTag)};
  }
  name_space(made, curves);
  made.colour.decode = decoder(curves, made.name);
  return true;
}

// ---- look-up tables -------------------------------------------------------------------------------------------------

// Values of three channels, or inks in percent, into CIE XYZ.
class Transform {
 public:
  Transform(const std::shared_ptr<const Profile>& profile, cmsUInt32Number format)
      : profile_(profile), xyz_(cmsCreateXYZProfileTHR(profile->context()), cmsCloseProfile) {
    transform_ = {cmsCreateTransformTHR(profile->context(), profile->get(), format, xyz_.get(), TYPE_XYZ_FLT,
                                        INTENT_RELATIVE_COLORIMETRIC, cmsFLAGS_NOOPTIMIZE | cmsFLAGS_NOCACHE),
                  cmsDeleteTransform};
    if (!transform_) profile->fail(profile->message());
    const ColourMatrix m = adaptation(chromaticity(pcs_white), rec709.white);
    for (int c = 0; c < 3; ++c) to_d65_[c] = m[c];
  }

  // CIE XYZ relative to D65, as the space XYZ has it. Its black may be a little below 0.
  void apply(const float* from, std::span<Colour> to) const {
    cmsDoTransform(transform_.get(), from, &to.data()->x, cmsUInt32Number(to.size()));
    for (Colour& c : to) c = Colour(to_d65_ * Flux(c));
  }

 private:
  std::shared_ptr<const Profile> profile_;
  std::unique_ptr<void, decltype(&cmsCloseProfile)> xyz_;
  std::unique_ptr<void, decltype(&cmsDeleteTransform)> transform_{nullptr, cmsDeleteTransform};
  ColourMatrix to_d65_;
};

void check_range(std::span<const float> values, const std::string& name) {
  if (std::ranges::any_of(values, [](float v) { return v > 1; }))
    throw InputError(fmt::format("holds values above 1, where the tables of ICC profile '{}' end", name),
                     Remedy::choose_space);
}

std::span<float> floats(std::span<Colour> colours) { return {&colours.data()->x, 3 * colours.size()}; }

void read_tables(const std::shared_ptr<const Profile>& profile, IccColours& made) {
  constexpr cmsUInt32Number formats[] = {TYPE_GRAY_FLT, TYPE_RGB_FLT, TYPE_CMYK_FLT};
  const auto transform = std::make_shared<Transform>(profile, formats[made.channels / 2]);
  made.colour.space = {"XYZ", cie_xyz, fmt::format("ICC profile '{}'", made.name), true};
  if (made.channels == 4)
    made.from_inks = [transform](std::span<const float> inks, std::span<Colour> out) {
      std::vector<float> percent(inks.begin(), inks.end());
      for (float& p : percent) p *= 100;
      transform->apply(percent.data(), out);
    };
  else
    made.colour.decode = [transform, name = made.name, grey = made.channels == 1](std::span<Colour> colours) {
      check_range(floats(colours), name);
      std::vector<float> values;
      for (const Colour& c : colours) values.insert(values.end(), &c.x, &c.x + (grey ? 1 : 3));
      transform->apply(values.data(), colours);
    };
}

// ---- the whole ------------------------------------------------------------------------------------------------------

void check_header(const Profile& profile, std::size_t size) {
  const cmsHPROFILE p = profile.get();
  if (cmsGetHeaderRenderingIntent(p) > 0xffff || size < 128) profile.fail("damaged");
  switch (cmsGetDeviceClass(p)) {
    case cmsSigInputClass:
    case cmsSigDisplayClass:
    case cmsSigOutputClass:
    case cmsSigColorSpaceClass: return;
    default: profile.fail("not supported: a profile that is of no input, display, output or colour space");
  }
}

int channels_of(const Profile& profile) {
  switch (cmsGetColorSpace(profile.get())) {
    case cmsSigGrayData: return 1;
    case cmsSigRgbData: return 3;
    case cmsSigCmykData: return 4;
    default: profile.fail("not supported: a profile of other values than grey, RGB and CMYK");
  }
}

// ICC.1:2022, section 9.2.17: what a profile of PQ or HLG has its tables for is the display of a program without them.
std::optional<CodePoints> code_points_of(const Profile& profile) {
  constexpr auto signature = cmsTagSignature(0x63696370);  // "cicp"
  std::array<unsigned char, 12> tag = {};
  if (!cmsIsTag(profile.get(), signature) ||
      cmsReadRawTag(profile.get(), signature, tag.data(), tag.size()) != tag.size())
    return std::nullopt;
  const CodePoints points{tag[8], tag[9], tag[11] != 0, 16};
  const bool of_display_light = points.transfer == 16 || points.transfer == 18;
  return of_display_light ? std::optional(points) : std::nullopt;
}

std::uint32_t big_endian(std::span<const std::byte> bytes) {
  std::uint32_t number = 0;
  for (const std::byte b : bytes.first(4)) number = number << 8U | std::to_integer<std::uint32_t>(b);
  return number;
}

}  // namespace

IccColours read_icc(std::span<const std::byte> bytes) {
  if (bytes.size() < 132 || big_endian(bytes) > bytes.size())
    throw InputError(fmt::format("damaged: an ICC profile of {} bytes ends too early", bytes.size()),
                     Remedy::choose_space);
  const auto profile = std::make_shared<const Profile>(bytes);
  check_header(*profile, bytes.size());
  IccColours made{.name = profile->name(), .channels = channels_of(*profile)};
  if (const auto points = code_points_of(*profile); points && made.channels == 3) {
    made.colour = colour_of(*points, fmt::format("ICC profile '{}'", made.name));
    return made;
  }
  if (!read_matrix(*profile, made)) read_tables(profile, made);
  return made;
}

namespace {

// @param inverted values tell what of each ink is not there.
void make_rgb(ImageReader& reader, const IccColours& icc, bool inverted) {
  reader.facts.channels = {"R", "G", "B"};
  reader.facts.encoded = false;
  reader.read = [stored = std::move(reader.read), width = std::size_t(reader.facts.width), from_inks = icc.from_inks,
                 inverted](int level, int begin, int end, int first, int count, std::span<float> out) {
    const std::size_t texels = width * std::size_t(end - begin);
    std::vector<float> inks(4 * texels);
    stored(level, begin, end, 0, 4, inks);
    for (float& v : inks) v = std::clamp(inverted ? 1 - v : v, 0.0F, 1.0F);
    std::vector<Colour> colours(texels);
    from_inks(inks, colours);
    float* to = out.data();
    for (const Colour& c : colours)
      for (int k = first; k < first + count; ++k) *to++ = c[k];
  };
}

}  // namespace

void honour_profile(ImageReader& reader) {
  ImageFacts& facts = reader.facts;
  const IccColours icc = read_icc(std::as_bytes(std::span(facts.icc_profile)));
  const bool has_inks = facts.inks != ImageFacts::Inks::none;
  if (has_inks != (icc.channels == 4) || (icc.channels == 1 && facts.channels.size() > 2))
    throw InputError(fmt::format("ICC profile '{}' is of {}, which the image is not", icc.name,
                                 icc.channels == 1   ? "grey"
                                 : icc.channels == 3 ? "RGB"
                                                     : "CMYK"),
                     Remedy::choose_space);
  if (has_inks) make_rgb(reader, icc, facts.inks == ImageFacts::Inks::inverted);
  facts.colour = icc.colour;
  facts.colour->fixed = has_inks;
  facts.claims.push_back({.name = "ICC profile", .value = icc.name, .of_colour = !has_inks});
}

// Writing.

namespace {

// Numbers are big-endian.
std::string number(std::uint32_t n) {
  return {static_cast<char>(n >> 24), static_cast<char>(n >> 16), static_cast<char>(n >> 8), static_cast<char>(n)};
}

std::string fixed(double x) { return number(std::uint32_t(std::int32_t(std::lround(x * 65536)))); }

std::string xyz(const Flux& c) { return "XYZ " + number(0) + fixed(c.x) + fixed(c.y) + fixed(c.z); }

// One text, in English: 12 bytes a record, which begin 28 bytes into the element.
std::string text(const std::string& ascii) {
  std::string utf16;
  for (const char c : ascii) utf16 += {'\0', c};
  return "mluc" + number(0) + number(1) + number(12) + "enUS" + number(std::uint32_t(utf16.size())) + number(28) +
         utf16;
}

// IEC 61966-2-1 as a parametric curve of type 3, or the identity, a curve without entries.
std::string tone(Curve curve) {
  if (curve == Curve::linear) return "curv" + number(0) + number(0);
  return "para" + number(0) + number(3 << 16) + fixed(2.4) + fixed(1 / 1.055) + fixed(0.055 / 1.055) +
         fixed(1 / 12.92) + fixed(0.04045);
}

// The illuminant of the connection space, as the header rounds it.
constexpr Flux d50{0.9642, 1, 0.8249};

using Tag = std::pair<std::string, std::string>;

std::vector<Tag> tags_of(const std::string& name, const Primaries& p, Curve curve) {
  // XYZ values are relative to D65: the primaries of CIE XYZ have no white of their own.
  const Point2 white = same(p, cie_xyz) ? rec709.white : p.white;
  const double sum = d50.x + d50.y + d50.z;
  const ColourMatrix adapt = adaptation(white, {d50.x / sum, d50.y / sum}), colours = adapt * to_xyz(p);
  std::string chad = "sf32" + number(0);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) chad += fixed(adapt[column][row]);
  return {{"desc", text(name)},      {"cprt", text("CC0")},     {"wtpt", xyz(d50)},        {"chad", chad},
          {"rXYZ", xyz(colours[0])}, {"gXYZ", xyz(colours[1])}, {"bXYZ", xyz(colours[2])}, {"rTRC", tone(curve)},
          {"gTRC", tone(curve)},     {"bTRC", tone(curve)}};
}

}  // namespace

std::string icc_profile(const std::string& name, const Primaries& primaries, Curve curve) {
  constexpr std::size_t header_size = 128;
  const std::vector<Tag> tags = tags_of(name, primaries, curve);
  std::string table = number(std::uint32_t(tags.size())), elements;
  const std::size_t start = header_size + 4 + 12 * tags.size();
  for (const auto& [signature, element] : tags) {
    table += signature + number(std::uint32_t(start + elements.size())) + number(std::uint32_t(element.size()));
    elements += element;
    elements.resize((elements.size() + 3) / 4 * 4);
  }
  const std::string size = number(std::uint32_t(start + elements.size()));
  std::string header = size + number(0) + number(0x04300000) + "mntrRGB XYZ ";
  header.resize(36);  // No date.
  header += "acsp";
  header.resize(68);  // No platform, maker or model; perceptual intent.
  header += fixed(d50.x) + fixed(d50.y) + fixed(d50.z);
  header.resize(header_size);
  return header + table + elements;
}

}  // namespace envmap
