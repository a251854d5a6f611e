#include "envmap/io/read_lobe.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/files/input_file.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/vector.h"

namespace envmap {
namespace {

// ---- text -----------------------------------------------------------------------------------------------------------

constexpr std::size_t most_lobe_text = 1 << 24, most_lobe_samples = 1 << 16;

bool is_lobe_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == ','; }

// Takes the next word of a line.
std::string_view lobe_word(std::string_view& line) {
  while (!line.empty() && is_lobe_space(line.front())) line.remove_prefix(1);
  std::size_t length = 0;
  while (length < line.size() && !is_lobe_space(line[length])) ++length;
  const std::string_view word = line.substr(0, length);
  line.remove_prefix(length);
  return word;
}

std::optional<double> lobe_number(std::string_view word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() ? std::optional(value) : std::nullopt;
}

std::vector<LobeSample> samples_of_text(std::string_view text) {
  std::vector<LobeSample> samples;
  bool degrees = false;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    line = line.substr(0, line.find('#'));
    const std::string_view first = lobe_word(line), second = lobe_word(line), third = lobe_word(line);
    if (first.empty()) continue;
    if (first == "degrees" && second.empty() && samples.empty()) {
      degrees = true;
      continue;
    }
    const std::optional<double> at = lobe_number(first), value = lobe_number(second);
    if (!at || !value || !third.empty())
      throw UsageError(fmt::format("line {}: must be {} and a value, such as '{} 0.5'", number,
                                   degrees ? "an angle in degrees" : "a cosine", degrees ? "30" : "0.9"));
    if (degrees && !(*at >= 0 && *at <= 90))
      throw UsageError(fmt::format("line {}: the angle must be 0 to 90 degrees, not {:g}", number, *at));
    if (samples.size() == most_lobe_samples)
      throw UsageError(fmt::format("line {}: a table has at most {} samples", number, most_lobe_samples));
    samples.push_back({degrees ? portable::cos_pi(*at / 180) : *at, *value});
  }
  return samples;
}

// ---- measured -------------------------------------------------------------------------------------------------------

// Bins by half angle, difference angle and azimuth, of red, then green, then blue. Half angles grow with the square of
// their bin (the database's own BRDFRead.cpp).
constexpr std::array<std::int32_t, 3> merl_bins{90, 90, 180};
constexpr std::array<double, 3> merl_scale{1.0 / 1500, 1.15 / 1500, 1.66 / 1500},
    merl_luminance{0.2126, 0.7152, 0.0722};
constexpr std::uint64_t merl_colour = 90 * 90 * 180, merl_bytes = sizeof merl_bins + 3 * merl_colour * sizeof(double);

template <class T>
T at_offset(const InputFile& file, std::uint64_t offset) {
  T value{};
  if (file.pread(&value, sizeof value, offset) != sizeof value) throw UsageError("is truncated");
  return value;
}

bool is_merl(const InputFile& file) {
  std::array<std::int32_t, 3> bins{};
  return file.pread(&bins, sizeof bins, 0) == sizeof bins && bins == merl_bins;
}

// The luminance of the BRDF of a bin, or nothing where it was not measured. @param half, difference bins.
std::optional<double> merl_value(const InputFile& file, std::uint64_t half, std::uint64_t difference) {
  double sum = 0;
  for (std::uint64_t c = 0; c < 3; ++c) {
    const std::uint64_t bin = (half * 90 + difference) * 180 + c * merl_colour;
    const auto value = at_offset<double>(file, sizeof merl_bins + bin * sizeof(double));
    if (value < 0) return std::nullopt;
    sum += merl_luminance[c] * merl_scale[c] * value;
  }
  return sum;
}

std::vector<LobeSample> samples_of_merl(const InputFile& file) {
  if (file.size() != merl_bytes)
    throw UsageError(fmt::format("an isotropic MERL material has {} bytes, not {}", merl_bytes, file.size()));
  std::vector<LobeSample> samples;
  for (int half = 0; half < 90; ++half) {
    const double part = (half + 0.5) / 90, half_turn = 0.5 * part * part;  // Of the half angle, over pi.
    if (half_turn >= 0.25) break;
    const auto value = merl_value(file, std::uint64_t(half), std::uint64_t(180 * half_turn));
    if (!value) continue;
    const double cosine = portable::cos_pi(2 * half_turn);
    if (samples.empty()) samples.push_back({1, *value});
    samples.push_back({cosine, *value * cosine});
  }
  samples.push_back({0, 0});
  return samples;
}

std::vector<LobeSample> samples_of(InputFile& file) {
  if (is_merl(file)) {
    file.read_all();
    return samples_of_merl(file);
  }
  // Junk, also what never ends, shows at its beginning.
  std::array<char, 4096> head{};
  const std::string_view begin(head.data(), file.pread(head.data(), head.size(), 0));
  if (file.size() > most_lobe_text || begin.find('\0') != std::string_view::npos)
    throw UsageError("is neither a table of a lobe nor a MERL material");
  file.hold();
  return samples_of_text({file.bytes().data(), file.bytes().size()});
}

}  // namespace

Lobe read_lobe(const std::string& path) {
  try {
    InputFile file(path);
    return Lobe::table(samples_of(file));
  } catch (const Error& e) {
    throw InputError(path, e.what());
  }
}

}  // namespace envmap
