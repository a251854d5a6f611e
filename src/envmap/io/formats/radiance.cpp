#include "envmap/io/formats/radiance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/gtc/matrix_access.hpp>
#include <memory>
#include <string_view>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/io/claims/colour.h"
#include "envmap/io/images/exif_orientation.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/primaries.h"
#include "envmap/maths/vector.h"

namespace envmap {

// Reading.

namespace {

using Rgbe = std::array<unsigned char, 4>;

// ---- the header -----------------------------------------------------------------------------------------------------

struct Header {
  int width = 0, height = 0;  // As stored: texels a scanline, scanlines.
  Orientation orientation = Orientation::upright;
  bool xyz = false, says_primaries = false;
  Flux applied{1};   // What the pixels have been multiplied by.
  double gamma = 1;  // They are light to the power of 1 / gamma.
  Primaries primaries{{0.64, 0.33}, {0.29, 0.6}, {0.15, 0.06}, {1. / 3, 1. / 3}};
  std::uint64_t pixels = 0;  // Where they begin.
  std::vector<Claim> claims = {};
  std::vector<std::string> notes = {};
};

// Numbers between spaces; fewer where the text ends or holds something else.
std::vector<double> numbers(std::string_view text) {
  std::vector<double> found;
  for (;;) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t+"), text.size()));
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc()) return found;
    found.push_back(value);
    text.remove_prefix(std::size_t(end - text.data()));
  }
}

// One number for all channels, or one for each. FreeImage and others write 0 where they state nothing.
std::optional<Flux> factors(Header& h, const std::string& name, std::string_view value) {
  std::vector<double> by = numbers(value);
  if (by.size() == 1) by.assign(3, by[0]);
  const bool none = by.size() == 3 && std::ranges::all_of(by, [](double x) { return x == 0; });
  if (none) {
    h.notes.push_back(fmt::format("{}=0 states no number: values are read as they are", name));
    h.claims.push_back({name, "0", Claim::Outcome::ignored, "states no number"});
    return std::nullopt;
  }
  if (by.size() != 3 || !std::ranges::all_of(by, [](double x) { return x > 0 && std::isfinite(x); }))
    throw InputError(fmt::format("damaged: {} that is no positive number", name));
  h.claims.push_back(
      {name, fmt::format("{:g}", fmt::join(by.begin(), by.begin() + (by[0] == by[1] && by[1] == by[2] ? 1 : 3), " "))});
  return Flux(by[0], by[1], by[2]);
}

void read_format(Header& h, std::string_view value) {
  h.xyz = value.find("32-bit_rle_xyze") != value.npos;
  if (!h.xyz && value.find("32-bit_rle_rgbe") == value.npos)
    throw InputError("neither FORMAT=32-bit_rle_rgbe nor 32-bit_rle_xyze");
  if (h.xyz) h.claims.push_back({.name = "FORMAT", .value = "32-bit_rle_xyze"});
}

// Some writers leave zeros.
void read_primaries(Header& h, std::string_view value) {
  const std::vector<double> xy = numbers(value);
  Claim claim{.name = "PRIMARIES", .value = fmt::format("{:g}", fmt::join(xy, " ")), .of_colour = true};
  if (xy.size() == 8 && std::ranges::all_of(xy, [](double x) { return std::abs(x) < 2; })) {
    const Primaries said{{xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}};
    h.says_primaries = is_possible(said);
    if (h.says_primaries) h.primaries = said;
  }
  if (!h.says_primaries) claim.outcome = Claim::Outcome::ignored, claim.reason = "no light has such primaries";
  h.claims.push_back(claim);
}

void read_variable(Header& h, std::string_view line) {
  const std::size_t equals = line.find('=');
  if (line.starts_with('#') || equals == line.npos) return;
  const std::string name(line.substr(0, equals));
  const std::string_view value = line.substr(equals + 1);
  if (name == "EXPOSURE" || name == "COLORCORR") h.applied *= factors(h, name, value).value_or(Flux(1));
  // Of Walter's rgbe.c, which other programs took over: the power that a screen is to raise values to.
  if (name == "GAMMA") h.gamma = factors(h, name, value).value_or(Flux(1)).x;
  if (name == "FORMAT") read_format(h, value);
  if (name == "PRIMARIES") read_primaries(h, value);
}

// "-Y 512 +X 1024": scanlines from the top, texels from the left; X first: scanlines are columns.
void read_resolution(Header& h, std::string_view line) {
  const auto axis = [&](char& sign, char& name) {
    line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
    if (line.size() < 2) return 0;
    sign = line[0], name = line[1];
    line.remove_prefix(2);
    line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
    int length = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), length);
    line.remove_prefix(std::size_t(end - line.data()));
    return error == std::errc() ? length : 0;
  };
  char sign[2] = {}, name[2] = {};
  h.height = axis(sign[0], name[0]);
  h.width = axis(sign[1], name[1]);
  const bool by_rows = name[0] == 'Y' && name[1] == 'X', by_columns = name[0] == 'X' && name[1] == 'Y';
  const bool signs = std::ranges::all_of(sign, [](char c) { return c == '+' || c == '-'; });
  if (!signs || (!by_rows && !by_columns) || h.width < 1 || h.height < 1)
    throw InputError("damaged: no resolution such as -Y 512 +X 1024 after the header");
  // By whether scanlines and texels go against the picture's right or down.
  constexpr Orientation rows[2][2] = {{Orientation::upright, Orientation::top_right},
                                      {Orientation::bottom_left, Orientation::bottom_right}};
  constexpr Orientation columns[2][2] = {{Orientation::left_top, Orientation::left_bottom},
                                         {Orientation::right_top, Orientation::right_bottom}};
  h.orientation = by_rows ? rows[sign[0] == '+'][sign[1] == '-'] : columns[sign[0] == '-'][sign[1] == '+'];
}

Header read_header(const InputFile& file) {
  constexpr std::size_t most = 1 << 16;  // Programs append what they did, line by line.
  std::string text(std::min<std::uint64_t>(most, file.size()), '\0');
  text.resize(file.pread(text.data(), text.size(), 0));
  Header h;
  std::size_t at = 0;
  const auto next_line = [&] {
    const std::size_t begin = at, end = text.find('\n', at);
    if (end == text.npos) throw InputError("damaged: its header has no end");
    at = end + 1;
    std::string_view line(text.data() + begin, end - begin);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  };
  next_line();  // "#?RADIANCE", "#?RGBE" or the name of some program.
  for (std::string_view line = next_line(); !line.empty(); line = next_line()) read_variable(h, line);
  read_resolution(h, next_line());
  h.pixels = at;
  // The new run lengths name 127 texels in 2 bytes of each channel; of the old ones a scanline takes 4 bytes at least.
  const double rest = double(file.size() - at);
  if (4.0 * h.height > rest || 1e-3 * h.width > rest)
    throw InputError(fmt::format("truncated or damaged: {} bytes cannot hold {}x{}", file.size(), h.width, h.height));
  return h;
}

// ---- scanlines ------------------------------------------------------------------------------------------------------

class Bytes {
 public:
  Bytes(const InputFile& file, std::uint64_t at) : file_(file), next_(at) {}
  unsigned char get() {
    if (at_ == buffer_.size()) fill();
    return buffer_[at_++];
  }
  Rgbe pixel() {
    Rgbe p;
    for (unsigned char& c : p) c = get();
    return p;
  }

 private:
  void fill() {
    buffer_.resize(1 << 18);
    buffer_.resize(file_.pread(buffer_.data(), buffer_.size(), next_));
    if (buffer_.empty()) throw InputError("it ends too early");
    next_ += buffer_.size();
    at_ = 0;
  }

  const InputFile& file_;
  std::uint64_t next_;
  std::vector<unsigned char> buffer_ = {};
  std::size_t at_ = 0;
};

// Channel after channel: a count over 128 repeats a byte, others precede as many.
void read_new_runs(Bytes& in, std::span<Rgbe> out) {
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t at = 0; at < out.size();) {
      std::size_t count = in.get();
      const bool run = count > 128;
      if (run) count -= 128;
      if (count == 0 || count > out.size() - at) throw InputError("a run of texels leaves its row");
      if (run) {
        const unsigned char value = in.get();
        for (; count > 0; --count) out[at++][c] = value;
      } else {
        for (; count > 0; --count) out[at++][c] = in.get();
      }
    }
}

// Texel after texel; 1 1 1 n repeats the last one n times, and more of them in a row are further digits of base 256.
void read_old_runs(Bytes& in, Rgbe first, std::span<Rgbe> out) {
  std::size_t at = 0;
  int shift = 0;
  for (Rgbe p = first;; p = in.pixel()) {
    if (p[0] == 1 && p[1] == 1 && p[2] == 1) {
      const std::size_t count = shift < 32 ? std::size_t{p[3]} << shift : out.size() + 1;
      if (at == 0 || count > out.size() - at) throw InputError("a run of texels leaves its row");
      std::fill_n(out.begin() + std::ptrdiff_t(at), count, out[at - 1]);
      at += count;
      shift += 8;
    } else {
      out[at++] = p;
      shift = 0;
    }
    if (at == out.size()) return;
  }
}

void read_scanline(Bytes& in, std::span<Rgbe> out) {
  const Rgbe first = in.pixel();
  if (out.size() < 8 || out.size() > 0x7fff || first[0] != 2 || first[1] != 2 || first[2] > 127)
    return read_old_runs(in, first, out);
  if ((std::size_t{first[2]} << 8 | first[3]) != out.size())
    throw InputError("a row has another length than the first");
  read_new_runs(in, out);
}

// ---- colours --------------------------------------------------------------------------------------------------------

// CIE XYZ into the RGB of these primaries (SMPTE RP 177-1993, section 3.3), per lumen.
Rotation from_xyz(const Primaries& p) {
  constexpr double lumens = 179;  // In a watt of equal energy over the visible wavelengths, as Radiance has it.
  return Rotation(glm::inverse(to_xyz(p))) / lumens;
}

struct Reader {
  const InputFile& file;
  Header header;
  Rotation matrix;               // Of the values in the file into ours.
  std::array<double, 256> unit;  // Of each exponent.
  int next = 0;                  // Scanline.
  std::optional<Bytes> bytes;
  std::vector<Rgbe> line;

  Reader(const InputFile& f, const Header& h)
      : file(f), header(h), matrix(h.xyz ? from_xyz(h.primaries) : Rotation(1)) {
    for (int c = 0; c < 3; ++c) matrix[c] /= h.applied[c];
    for (int e = 0; e < 256; ++e) unit[std::size_t(e)] = e == 0 ? 0 : std::ldexp(1.0, e - 136);
  }

  void read(int begin, int end, int first, int count, std::span<float> out) {
    if (!bytes || begin < next) bytes.emplace(file, header.pixels), next = 0;
    line.resize(std::size_t(header.width));
    float* to = out.data();
    for (; next < end; ++next) {
      read_scanline(*bytes, line);
      if (next < begin) continue;
      for (const Rgbe& p : line) {
        const double u = unit[p[3]];
        Flux stored(p[0] * u, p[1] * u, p[2] * u);
        if (header.gamma != 1)
          for (int c = 0; c < 3; ++c) stored[c] = portable::pow(stored[c], header.gamma);
        const Flux colour = matrix * stored;
        for (int c = first; c < first + count; ++c) *to++ = float(header.xyz ? std::max(colour[c], 0.0) : colour[c]);
      }
    }
  }
};

}  // namespace

ImageReader open_radiance(const InputFile& file) {
  const Header header = read_header(file);
  const auto reader = std::make_shared<Reader>(file, header);
  ImageReader made{.format = "hdr",
                   .facts = {.width = header.width, .height = header.height, .channels = {"R", "G", "B"}},
                   .read = [reader](int, int begin, int end, int first, int count, std::span<float> out) {
                     reader->read(begin, end, first, count, out);
                   }};
  if (header.applied != Flux(1))
    made.facts.details.push_back(fmt::format("EXPOSURE and COLORCORR are divided out: {:g} {:g} {:g}", header.applied.x,
                                             header.applied.y, header.applied.z));
  if (header.says_primaries || header.xyz) made.facts.provenance.chromaticities = chromaticities(header.primaries);
  if (header.xyz) made.facts.details.emplace_back("CIE XYZ became RGB; colours outside of that are cut at 0");
  if (header.gamma != 1) made.facts.details.push_back(fmt::format("values are raised to GAMMA {:g}", header.gamma));
  made.facts.orientation = header.orientation;
  made.facts.claims = header.claims;
  made.facts.notes = header.notes;
  return made;
}

// Writing.

namespace {

// To the nearest value that shares an exponent among its channels (Ward 1991). What is below them all is 0.
Rgbe to_rgbe(const Colour& c) {
  const float most = std::max({c.x, c.y, c.z});
  int exponent = 0;
  if (std::frexp(most, &exponent) * 256 >= 255.5F) ++exponent;
  if (!(most > 0) || exponent < -127) return {0, 0, 0, 0};
  const auto mantissa = [&](float x) { return static_cast<unsigned char>(std::ldexp(x, 8 - exponent) + 0.5F); };
  return {mantissa(c.x), mantissa(c.y), mantissa(c.z), static_cast<unsigned char>(exponent + 128)};
}

// One channel of a row: runs of four and more as 128 + count and the byte, what is between as count and bytes.
void add_runs(std::span<const Rgbe> row, std::size_t channel, std::string& out) {
  constexpr std::size_t longest_run = 127, longest_dump = 128, worth = 4;
  const auto at = [&](std::size_t k) { return static_cast<char>(row[k][channel]); };
  const auto run_from = [&](std::size_t k) {
    std::size_t n = 1;
    while (n < longest_run && k + n < row.size() && at(k + n) == at(k)) ++n;
    return n;
  };
  for (std::size_t k = 0; k < row.size();) {
    std::size_t end = k, run = 0;
    while (end < row.size() && end - k < longest_dump && (run = run_from(end)) < worth) end += run;
    end = std::min(end, k + longest_dump);
    if (end > k) {
      out += static_cast<char>(end - k);
      for (; k < end; ++k) out += at(k);
    } else {
      out += static_cast<char>(128 + run);
      out += at(k);
      k += run;
    }
  }
}

void add_row(std::span<const Colour> from, std::string& out) {
  std::vector<Rgbe> row(from.size());
  std::ranges::transform(from, row.begin(), to_rgbe);
  if (row.size() < 8 || row.size() > 0x7fff) {
    out.append(reinterpret_cast<const char*>(row.data()), 4 * row.size());
    return;
  }
  out += {2, 2, static_cast<char>(row.size() >> 8), static_cast<char>(row.size() & 255)};
  for (std::size_t c = 0; c < 4; ++c) add_runs(row, c, out);
}

}  // namespace

ImageWriter create_radiance(OutputFile& file, const ImagePlan& plan) {
  const Size size = plan.levels[0];
  std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";
  if (const auto& xy = plan.provenance.chromaticities) header += fmt::format("PRIMARIES={}\n", fmt::join(*xy, " "));
  header += fmt::format("\n-Y {} +X {}\n", size.height, size.width);
  file.put(header.data(), header.size());
  return {.write =
              [&file, size](int, int begin, int end, std::span<const Colour> pixels) {
                const auto width = std::size_t(size.width);
                std::vector<std::string> rows(std::size_t(end - begin));
                parallel_for(end - begin, [&](int k) {
                  add_row(pixels.subspan(std::size_t(k) * width, width), rows[std::size_t(k)]);
                });
                for (const std::string& row : rows) file.put(row.data(), row.size());
              },
          .close = [] {}};
}

void round_to_radiance(std::span<Colour> texels) {
  for (Colour& c : texels) {
    const Rgbe stored = to_rgbe(c);
    for (int k = 0; k < 3; ++k) c[k] = stored[3] == 0 ? 0 : std::ldexp(float(stored[std::size_t(k)]), stored[3] - 136);
  }
}

}  // namespace envmap
