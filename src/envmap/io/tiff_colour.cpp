#include "envmap/io/tiff_colour.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/srgb.h"
#include "envmap/maths/vector.h"

namespace envmap {
namespace {

unsigned word(TIFF* tiff, unsigned tag) {
  std::uint16_t value = 0;
  TIFFGetFieldDefaulted(tiff, tag, &value);
  return value;
}

bool is_log(unsigned photometric) { return photometric == PHOTOMETRIC_LOGL || photometric == PHOTOMETRIC_LOGLUV; }

// ---- what is not read -----------------------------------------------------------------------------------------------

struct Unsupported {
  unsigned photometric;
  const char* name;
};

// Of PhotometricInterpretation. libtiff has no name for LinearRaw of DNG.
constexpr Unsupported unsupported[] = {{PHOTOMETRIC_MASK, "a transparency mask"}, {PHOTOMETRIC_CIELAB, "CIE L*a*b*"},
                                       {PHOTOMETRIC_ICCLAB, "ICC L*a*b*"},        {PHOTOMETRIC_ITULAB, "ITU L*a*b*"},
                                       {PHOTOMETRIC_CFA, "raw camera data"},      {34892, "raw camera data"}};

void check_photometric(unsigned photometric) {
  for (const Unsupported& row : unsupported)
    if (row.photometric == photometric)
      throw InputError(fmt::format("not supported: TIFF of {} (PhotometricInterpretation {})", row.name, photometric));
}

void check_inks(TIFF* tiff) {
  if (word(tiff, TIFFTAG_INKSET) != INKSET_CMYK)
    throw InputError(
        fmt::format("not supported: TIFF of inks other than CMYK (InkSet {})", word(tiff, TIFFTAG_INKSET)));
}

void check_sample_format(TIFF* tiff) {
  const unsigned format = word(tiff, TIFFTAG_SAMPLEFORMAT);
  const char* name = format == SAMPLEFORMAT_INT             ? "signed integers"
                     : format == SAMPLEFORMAT_COMPLEXINT    ? "complex integers"
                     : format == SAMPLEFORMAT_COMPLEXIEEEFP ? "complex numbers"
                                                            : nullptr;
  if (name) throw InputError(fmt::format("not supported: TIFF of {} (SampleFormat {})", name, format));
}

// ---- the tags of section 20 -----------------------------------------------------------------------------------------

void tell(ImageFacts& facts, const char* name, const std::string& value, const char* ignored_because = nullptr) {
  facts.claims.push_back({.name = name,
                          .value = value,
                          .outcome = ignored_because ? Claim::Outcome::ignored : Claim::Outcome::honoured,
                          .reason = ignored_because ? ignored_because : "",
                          .of_colour = true});
}

struct Colorimetry {
  std::optional<Point2> white = {};
  std::optional<std::array<Point2, 3>> primaries = {};
  std::vector<std::vector<double>> curves = {};  // One of grey, three of RGB.

  explicit Colorimetry(TIFF* tiff) {
    const float *xy = nullptr, *six = nullptr;
    if (TIFFGetField(tiff, TIFFTAG_WHITEPOINT, &xy) == 1) white = Point2(xy[0], xy[1]);
    if (TIFFGetField(tiff, TIFFTAG_PRIMARYCHROMATICITIES, &six) == 1)
      primaries = {Point2(six[0], six[1]), Point2(six[2], six[3]), Point2(six[4], six[5])};
    std::array<const std::uint16_t*, 3> tables = {};
    if (TIFFGetField(tiff, TIFFTAG_TRANSFERFUNCTION, &tables[0], &tables[1], &tables[2]) != 1) return;
    for (const std::uint16_t* table : tables)
      if (table) {
        curves.emplace_back();
        for (std::size_t k = 0; k < std::size_t{1} << word(tiff, TIFFTAG_BITSPERSAMPLE); ++k)
          curves.back().push_back(table[k] / 65535.0);
      }
  }

  [[nodiscard]] bool is_there() const { return white || primaries || !curves.empty(); }
  void tell(ImageFacts& facts, const char* ignored_because = nullptr) const {
    if (white) envmap::tell(facts, "WhitePoint", fmt::format("{:g} {:g}", white->x, white->y), ignored_because);
    if (primaries) {
      const auto& [r, g, b] = *primaries;
      envmap::tell(facts, "PrimaryChromaticities",
                   fmt::format("{:g} {:g} {:g} {:g} {:g} {:g}", r.x, r.y, g.x, g.y, b.x, b.y), ignored_because);
    }
    if (!curves.empty())
      envmap::tell(facts, "TransferFunction", fmt::format("{} entries", curves[0].size()), ignored_because);
  }
};

// Stored integers are looked up in a table with an entry for each.
std::function<void(std::span<Colour>)> decoder(std::vector<std::vector<double>> curves) {
  if (curves.size() == 1) curves.resize(3, curves[0]);
  return [curves = std::move(curves)](std::span<Colour> colours) {
    for (Colour& c : colours)
      for (int k = 0; k < 3; ++k) {
        const auto& curve = curves[std::size_t(k)];
        const double entry =
            std::clamp(std::round(double{c[k]} * double(curve.size() - 1)), 0.0, double(curve.size() - 1));
        c[k] = float(curve[std::size_t(entry)]);
      }
  };
}

void honour(const Colorimetry& said, ImageFacts& facts) {
  Primaries p = rec709;
  if (said.primaries) p.red = (*said.primaries)[0], p.green = (*said.primaries)[1], p.blue = (*said.primaries)[2];
  if (said.white) p.white = *said.white;
  if (!is_possible(p))
    throw InputError("damaged: no light has the colours of its tags WhitePoint and PrimaryChromaticities",
                     Remedy::choose_space);
  if (!said.curves.empty() && !is_integer(facts.depth))
    throw InputError("not supported: TransferFunction of floating-point samples", Remedy::choose_space);
  said.tell(facts);
  StatedColour stated{.space = {space_with(p), p, "its tags", true}};
  if (!said.curves.empty()) {
    stated.space.name =
        fmt::format("TransferFunction of {}", stated.space.name.empty() ? "its primaries" : stated.space.name);
    stated.decode = decoder(said.curves);
  } else if (facts.encoded) {
    stated.space.name = encoded_space_with(p);
    stated.decode = decode_srgb;
  }
  facts.colour = stated;
}

// ---- LogLuv ---------------------------------------------------------------------------------------------------------

// CIE XYZ of the picture itself: without a white of its own it is looked at under the map's.
void honour_log(TIFF* tiff, const Colorimetry& said, ImageFacts& facts) {
  const bool grey = word(tiff, TIFFTAG_PHOTOMETRIC) == PHOTOMETRIC_LOGL;
  const bool in_24_bits = word(tiff, TIFFTAG_COMPRESSION) == COMPRESSION_SGILOG24;
  StatedColour stated{.space = {"XYZ", cie_xyz, grey ? "LogL" : "LogLuv", true}};
  if (grey) stated.space = {space_with(rec709), rec709, "LogL", true};
  tell(facts, "PhotometricInterpretation", grey ? "LogL" : in_24_bits ? "LogLuv of 24 bits" : "LogLuv of 32 bits");
  if (said.primaries) tell(facts, "PrimaryChromaticities", "of a display", "LogLuv has no primaries");
  if (said.white && !grey) {
    if (!is_possible({{0.64, 0.33}, {0.3, 0.6}, {0.15, 0.06}, *said.white}))
      throw InputError("damaged: a WhitePoint that no light has", Remedy::choose_space);
    tell(facts, "WhitePoint", fmt::format("{:g} {:g}", said.white->x, said.white->y));
    stated.decode = [m = adaptation(*said.white, rec709.white)](std::span<Colour> colours) {
      for (Colour& c : colours) c = Colour(m * Flux(c));
    };
  }
  double nits = 0;
  if (TIFFGetField(tiff, TIFFTAG_STONITS, &nits) == 1 && nits > 0) {
    tell(facts, "StoNits", fmt::format("{:g}", nits));
    stated.white_luminance = float(nits);
  }
  facts.colour = stated;
}

}  // namespace

void unpack_log_luv(TIFF* tiff) {
  if (is_log(word(tiff, TIFFTAG_PHOTOMETRIC))) TIFFSetField(tiff, TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_FLOAT);
}

void read_tiff_colours(TIFF* tiff, ImageFacts& facts) {
  const unsigned photometric = word(tiff, TIFFTAG_PHOTOMETRIC);
  check_photometric(photometric);
  check_sample_format(tiff);
  if (photometric == PHOTOMETRIC_SEPARATED) check_inks(tiff);
  const Colorimetry said(tiff);
  if (is_log(photometric)) return honour_log(tiff, said, facts);
  std::uint32_t size = 0;
  const char* profile = nullptr;
  if (TIFFGetField(tiff, TIFFTAG_ICCPROFILE, &size, &profile) == 1 && size > 0) {
    facts.icc_profile.assign(profile, size);
    return said.tell(facts, "the ICC profile comes first");
  }
  if (said.is_there()) honour(said, facts);
}

}  // namespace envmap
