#include "envmap/io/png_colour.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/code_points.h"
#include "envmap/io/power_curve.h"
#include "envmap/io/srgb.h"

namespace envmap {
namespace {

using Data = std::span<const std::byte>;

unsigned byte(Data data, std::size_t at) { return std::to_integer<unsigned>(data[at]); }

double hundred_thousandths(Data data, std::size_t at) {
  return double(byte(data, at) << 24U | byte(data, at + 1) << 16U | byte(data, at + 2) << 8U | byte(data, at + 3)) /
         1e5;
}

[[noreturn]] void damaged(const std::string& type, const std::string& why) {
  throw InputError(fmt::format("damaged: its {} chunk {}", type, why), Remedy::choose_space);
}

class Colours {
 public:
  Colours(std::span<const PngChunk> chunks, int bits, ImageFacts& facts)
      : chunks_(chunks), bits_(bits), facts_(facts) {}

  void read() {
    read_code_points();
    read_profile();
    read_srgb();
    read_gamma_and_primaries();
    for (const char* type : {"mDCV", "cLLI"})
      if (const PngChunk* chunk = find(type, type[0] == 'm' ? 24 : 8))
        tell(chunk->type, fmt::format("{} bytes", chunk->data.size()), "tells of a display, not of values");
  }

 private:
  // @param size in bytes; 0: any.
  const PngChunk* find(std::string_view type, std::size_t size) const {
    const PngChunk* found = nullptr;
    for (const PngChunk& chunk : chunks_) {
      if (chunk.type != type) continue;
      if (size > 0 && chunk.data.size() != size)
        damaged(chunk.type, fmt::format("has {} bytes, not {}", chunk.data.size(), size));
      if (found && !std::ranges::equal(found->data, chunk.data)) damaged(chunk.type, "is there twice");
      found = &chunk;
    }
    return found;
  }

  void tell(const std::string& name, const std::string& value, const std::string& ignored_because = {}) {
    const bool honoured = ignored_because.empty();
    facts_.claims.push_back({.name = name,
                             .value = value,
                             .outcome = honoured ? Claim::Outcome::honoured : Claim::Outcome::ignored,
                             .reason = ignored_because,
                             .of_colour = true});
  }

  // Tells a claim. @param told whether it is told elsewhere, if it is honoured. @return whether it is the first, which
  // counts.
  bool is_first(const std::string& name, const std::string& value, bool told = false) {
    if (!told || !first_.empty()) tell(name, value, first_.empty() ? "" : first_ + " comes first");
    if (!first_.empty()) return false;
    first_ = name;
    return true;
  }

  void read_code_points() {
    const PngChunk* chunk = find("cICP", 4);
    if (!chunk) return;
    const CodePoints points{byte(chunk->data, 0), byte(chunk->data, 1), byte(chunk->data, 3) != 0, bits_};
    if (const unsigned matrix = byte(chunk->data, 2); matrix != 0)
      throw InputError(fmt::format("not supported: cICP with matrix coefficients {}, where PNG has 0", matrix),
                       Remedy::choose_space);
    if (!points.is_specified()) return tell("cICP", words(points), "specifies nothing");
    if (is_first("cICP", words(points))) facts_.colour = colour_of(points, "cICP");
  }

  void read_profile() {
    const PngChunk* chunk = find("iCCP", 0);
    if (!chunk) return;
    const auto end = std::ranges::find(chunk->data, std::byte{0});
    const auto name_size = std::size_t(end - chunk->data.begin());
    if (name_size == 0 || name_size > 79 || chunk->data.size() < name_size + 2) damaged("iCCP", "has no profile");
    const std::string name(reinterpret_cast<const char*>(chunk->data.data()), name_size);
    if (is_first("iCCP", name, true)) facts_.icc_profile = inflated(chunk->data.subspan(name_size + 2));
  }

  static std::string inflated(Data data) {
    constexpr std::size_t most = 1 << 26;  // Profiles of printers take some megabytes.
    std::string out;
    z_stream stream{};
    if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(data.data()));
    stream.avail_in = uInt(data.size());
    int status = Z_OK;
    while (status == Z_OK && out.size() < most) {
      const std::size_t done = out.size();
      out.resize(done + (1 << 16));
      stream.next_out = reinterpret_cast<Bytef*>(out.data() + done);
      stream.avail_out = 1 << 16;
      status = inflate(&stream, Z_NO_FLUSH);
      out.resize(out.size() - stream.avail_out);
    }
    inflateEnd(&stream);
    if (status != Z_STREAM_END) damaged("iCCP", "does not decompress");
    return out;
  }

  void read_srgb() {
    constexpr std::array<const char*, 4> intents{"perceptual", "relative colorimetric", "saturation",
                                                 "absolute colorimetric"};
    const PngChunk* chunk = find("sRGB", 1);
    if (!chunk) return;
    const unsigned intent = byte(chunk->data, 0);
    if (intent >= intents.size()) damaged("sRGB", fmt::format("has an intent {}", intent));
    if (is_first("sRGB", intents[intent])) facts_.encoded = true;
  }

  // Both are one claim: either may be missing.
  void read_gamma_and_primaries() {
    const PngChunk *gamma_chunk = find("gAMA", 4), *primaries_chunk = find("cHRM", 32);
    const double gamma = gamma_chunk ? hundred_thousandths(gamma_chunk->data, 0) : 0;
    Primaries p = rec709;
    if (primaries_chunk) {
      const auto xy = [&](std::size_t at) {
        return Point2(hundred_thousandths(primaries_chunk->data, at),
                      hundred_thousandths(primaries_chunk->data, at + 4));
      };
      p = {xy(8), xy(16), xy(24), xy(0)};
      if (!is_possible(p)) damaged("cHRM", "has primaries that no light has");
    }
    const std::string before = first_;
    if (gamma_chunk && gamma == 0) tell("gAMA", "0", "states no gamma");
    if (gamma > 0) is_first("gAMA", fmt::format("{:g}", gamma));
    if (primaries_chunk) {
      first_ = before;
      is_first("cHRM", fmt::format("{:g}", fmt::join(chromaticities(p), " ")));
    }
    if (!before.empty() || first_.empty()) return;
    facts_.colour = StatedColour{.space = named(p, gamma), .decode = decoder_of(gamma)};
  }

  static ClaimedSpace named(const Primaries& p, double gamma) {
    const std::string linear = space_with(p), by = gamma > 0 ? "gAMA" : "cHRM";
    if (gamma == 1) return {linear, p, by, true};
    if (gamma == 0) return {encoded_space_with(p), p, by, true};
    const std::string of = linear.empty() ? "its primaries" : linear;
    return {fmt::format("gamma {:.4g} of {}", 1 / gamma, of), p, by, true};
  }

  static std::function<void(std::span<Colour>)> decoder_of(double gamma) {
    if (gamma == 0) return decode_srgb;
    return power_curve({1 / gamma, 1 / gamma, 1 / gamma});
  }

  std::span<const PngChunk> chunks_;
  int bits_;
  ImageFacts& facts_;
  std::string first_;
};

}  // namespace

void read_png_colours(std::span<const PngChunk> chunks, int bits, ImageFacts& facts) {
  Colours(chunks, bits, facts).read();
}

}  // namespace envmap
