#include "envmap/io/claims/module_colour.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "envmap/base/error.h"
#include "envmap/io/claims/power_curve.h"
#include "envmap/io/claims/srgb.h"

namespace envmap {
namespace {

// Little-endian; 0 beyond the end of the file.
std::uint32_t number(const InputFile& file, std::uint64_t at, std::size_t size) {
  std::array<unsigned char, 4> bytes = {};
  if (file.pread(bytes.data(), size, at) != size) return 0;
  std::uint32_t n = 0;
  for (std::size_t k = size; k > 0; --k) n = n << 8U | bytes[k - 1];
  return n;
}

// ---- BMP: offsets are those in the header, which begins behind 14 bytes -----------------------------------------

constexpr std::uint64_t header = 14;

// CIE XYZ in 2^-30, or 16.16.
double fixed(const InputFile& file, std::uint64_t at, double one) { return number(file, header + at, 4) / one; }

void read_calibrated(const InputFile& file, ImageFacts& facts) {
  std::array<Flux, 3> ends;
  std::array<double, 3> powers = {};
  for (std::uint64_t c = 0; c < 3; ++c) {
    for (std::uint64_t k = 0; k < 3; ++k) ends[c][int(k)] = fixed(file, 60 + 12 * c + 4 * k, 0x1p30);
    powers[c] = fixed(file, 96 + 4 * c, 0x1p16);
  }
  Claim claim{.name = "bV4CSType", .value = "calibrated RGB", .of_colour = true};
  const Flux white = ends[0] + ends[1] + ends[2];
  const bool has_gamma = powers[0] > 0 && powers[1] > 0 && powers[2] > 0;
  if (white == Flux(0) || !has_gamma) {
    claim.outcome = Claim::Outcome::ignored, claim.reason = "states no numbers";
    facts.claims.push_back(claim);
    return;
  }
  const auto xy = [](const Flux& xyz) {
    const double sum = xyz.x + xyz.y + xyz.z;
    return sum > 0 ? Point2(xyz.x / sum, xyz.y / sum) : Point2(0);
  };
  const Primaries p{xy(ends[0]), xy(ends[1]), xy(ends[2]), xy(white)};
  if (!is_possible(p)) throw InputError("damaged: a BMP of end points that no light has", Remedy::choose_space);
  facts.claims.push_back(claim);
  facts.colour = StatedColour{.space = {"calibrated RGB", p, "bV4CSType", true}, .decode = power_curve(powers)};
}

std::uint32_t big_number(std::string_view bytes, std::size_t at) {
  std::uint32_t n = 0;
  for (std::size_t k = at; k < at + 4 && at + 4 <= bytes.size(); ++k)
    n = n << 8U | static_cast<unsigned char>(bytes[k]);
  return n;
}

// What comes before the texels.
std::string head_of(const InputFile& file) {
  std::string head(std::min<std::uint64_t>(file.size(), 1 << 16), '\0');
  head.resize(file.pread(head.data(), head.size(), 0));
  return head;
}

}  // namespace

std::string profile_at(const InputFile& file, std::uint64_t at, std::uint64_t size) {
  if (at > file.size() || size > file.size() - at)
    throw InputError("damaged: its ICC profile lies outside of the file", Remedy::choose_space);
  std::string profile(size, '\0');
  file.pread(profile.data(), size, at);
  return profile;
}

void read_bmp_colours(const InputFile& file, ImageFacts& facts) {
  constexpr std::uint32_t calibrated = 0, linked = 0x4c494e4b, embedded = 0x4d424544;
  const std::uint32_t header_size = number(file, header, 4), kind = number(file, header + 56, 4);
  if (header_size < 108) return;
  if (kind == calibrated) return read_calibrated(file, facts);
  if (header_size < 124) return;
  if (kind == linked) throw InputError("not supported: a BMP whose ICC profile is another file", Remedy::choose_space);
  if (kind == embedded)
    facts.icc_profile = profile_at(file, header + number(file, header + 112, 4), number(file, header + 116, 4));
}

void read_targa_colours(const InputFile& file, ImageFacts& facts) {
  constexpr std::string_view mark = "TRUEVISION-XFILE";
  constexpr std::uint64_t footer = 26, gamma_at = 478;
  std::array<char, mark.size()> is = {};
  if (file.size() < footer || file.pread(is.data(), is.size(), file.size() - 18) != is.size() ||
      std::string_view(is.data(), is.size()) != mark)
    return;
  const std::uint32_t extension = number(file, file.size() - footer, 4);
  const double above = number(file, extension + gamma_at, 2), below = number(file, extension + gamma_at + 2, 2);
  if (extension == 0 || below == 0) return;
  const double gamma = above / below;
  Claim claim{.name = "gamma", .value = fmt::format("{:g}", gamma), .of_colour = true};
  if (!(gamma > 0 && gamma <= 10)) {
    claim.outcome = Claim::Outcome::ignored, claim.reason = "beyond 0 to 10";
  } else {
    const std::string name = gamma == 1 ? space_with(rec709) : fmt::format("gamma {:g}", gamma);
    facts.colour = StatedColour{.space = {name, rec709, "gamma", true}, .decode = power_curve({gamma, gamma, gamma})};
  }
  facts.claims.push_back(claim);
}

// RIFF: chunks of a name, a length and bytes, which begin at even places.
void read_webp_colours(const InputFile& file, ImageFacts& facts) {
  constexpr std::uint32_t iccp = 0x50434349;
  constexpr int most_chunks = 1000;
  std::uint64_t at = 12;
  for (int k = 0; k < most_chunks && at + 8 <= file.size(); ++k) {
    const std::uint32_t size = number(file, at + 4, 4);
    if (number(file, at, 4) == iccp) facts.icc_profile = profile_at(file, at + 8, size);
    at += 8 + std::uint64_t{size} + size % 2;
  }
}

// A colour specification box: method 2 and 3 are an ICC profile, 1 is the number of a space of screens.
void read_jpeg2000_colours(const InputFile& file, ImageFacts& facts) {
  const std::string head = head_of(file);
  const std::size_t box = head.find("colr");
  if (box == head.npos || box < 4 || box + 7 > head.size()) return;
  const auto method = static_cast<unsigned char>(head[box + 4]);
  const std::uint32_t size = big_number(head, box - 4);
  if (method == 2 || method == 3)
    facts.icc_profile = profile_at(file, box + 7, std::uint64_t{size} - 11);
  else if (method == 1 && (big_number(head, box + 7) < 16 || big_number(head, box + 7) > 18))
    throw InputError(fmt::format("not supported: JPEG 2000 of enumerated colour space {}", big_number(head, box + 7)),
                     Remedy::choose_space);
}

void read_gif_colours(const InputFile& file, ImageFacts&) {
  if (head_of(file).find("ICCRGBG1") != std::string::npos)
    throw InputError("not supported: an ICC profile in a GIF", Remedy::choose_space);
}

}  // namespace envmap
