// Reads JPEG row by row through libjpeg (libjpeg.txt of libjpeg-turbo).
// The second needs the first.
// clang-format off
#include <cstdio>
#include <jpeglib.h>
// clang-format on

#include "envmap/io/formats/jpeg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <memory>
#include <string_view>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/io/claims/exif.h"
#include "envmap/io/claims/icc_profile.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/io/formats/jpeg_parts.h"

namespace envmap {
namespace {

// An image with thousands of scans takes hours (libjpeg-turbo's LJT-01-005).
constexpr int most_scans = 500;

// libjpeg ends the program where it cannot go on, unless error_exit() leaves by longjmp(): its callbacks and run() hold
// nothing that has a destructor.
class JpegFile {
 public:
  // @param at where the image begins.
  explicit JpegFile(const InputFile& file, std::uint64_t at = 0) : file_(file), next_(at) {
    jpeg_.err = jpeg_std_error(&errors_);
    errors_.error_exit = fail;
    errors_.emit_message = warn;
    jpeg_.client_data = this;
    run([](jpeg_decompress_struct& j) { jpeg_create_decompress(&j); });
    source_.init_source = [](j_decompress_ptr) {};
    source_.fill_input_buffer = fill;
    source_.skip_input_data = skip;
    source_.resync_to_restart = jpeg_resync_to_restart;
    source_.term_source = [](j_decompress_ptr) {};
    jpeg_.src = &source_;
    progress_.progress_monitor = check_scans;
    jpeg_.progress = &progress_;
  }
  ~JpegFile() { jpeg_destroy_decompress(&jpeg_); }
  JpegFile(const JpegFile&) = delete;
  JpegFile& operator=(const JpegFile&) = delete;

  template <class Calls>
  void run(const Calls& calls) {
    if (setjmp(jump_) == 0) return calls(jpeg_);
    throw InputError(message_.data());
  }
  /// From here on warnings are errors: headers have oddities, texels have damage.
  void be_strict() { strict_ = true; }

 private:
  static JpegFile& of(j_common_ptr jpeg) { return *static_cast<JpegFile*>(jpeg->client_data); }
  [[noreturn]] static void fail(j_common_ptr jpeg) {
    jpeg->err->format_message(jpeg, of(jpeg).message_.data());
    std::longjmp(of(jpeg).jump_, 1);
  }
  static void warn(j_common_ptr jpeg, int level) {
    if (level < 0 && of(jpeg).strict_) fail(jpeg);
  }
  static void check_scans(j_common_ptr jpeg) {
    JpegFile& self = of(jpeg);
    if (self.jpeg_.input_scan_number <= most_scans) return;
    std::snprintf(self.message_.data(), self.message_.size(), "it has more than %d scans", most_scans);
    std::longjmp(self.jump_, 1);
  }
  static boolean fill(j_decompress_ptr jpeg) {
    JpegFile& self = of(reinterpret_cast<j_common_ptr>(jpeg));
    const std::size_t size = self.file_.pread(self.bytes_.data(), self.bytes_.size(), self.next_);
    if (size == 0) {
      std::snprintf(self.message_.data(), self.message_.size(), "it ends too early");
      std::longjmp(self.jump_, 1);
    }
    self.next_ += size;
    self.source_.next_input_byte = self.bytes_.data();
    self.source_.bytes_in_buffer = size;
    return TRUE;
  }
  static void skip(j_decompress_ptr jpeg, long size) {
    JpegFile& self = of(reinterpret_cast<j_common_ptr>(jpeg));
    if (size <= 0) return;
    const std::size_t here = std::min(std::size_t(size), self.source_.bytes_in_buffer);
    self.source_.next_input_byte += here;
    self.source_.bytes_in_buffer -= here;
    self.next_ += std::size_t(size) - here;
  }

  const InputFile& file_;
  jpeg_decompress_struct jpeg_ = {};
  jpeg_error_mgr errors_ = {};
  jpeg_source_mgr source_ = {};
  jpeg_progress_mgr progress_ = {};
  std::jmp_buf jump_ = {};
  std::array<char, JMSG_LENGTH_MAX> message_ = {};
  std::array<JOCTET, 1 << 14> bytes_ = {};
  std::uint64_t next_;
  bool strict_ = false;
};

struct Header {
  int width = 0, height = 0, channels = 0;
  J_COLOR_SPACE colours = JCS_UNKNOWN;

  [[nodiscard]] bool is_cmyk() const { return colours == JCS_CMYK || colours == JCS_YCCK; }
};

constexpr int exif_and_xmp = JPEG_APP0 + 1, photoshop = JPEG_APP0 + 13;
constexpr std::string_view exif_mark("Exif\0\0", 6);

Header read_header(JpegFile& file) {
  Header h;
  file.run([&](jpeg_decompress_struct& j) {
    jpeg_read_header(&j, TRUE);
    h.width = int(j.image_width);
    h.height = int(j.image_height);
    h.channels = j.num_components == 1 ? 1 : 3;
    h.colours = j.jpeg_color_space;
    if (h.is_cmyk()) j.out_color_space = JCS_CMYK;
  });
  file.be_strict();
  return h;
}

// Adds what a segment tells. The first text of a name counts. @return false where OpenImageIO has to read it.
bool read_segment(const JpegSegment& segment, ImageFacts& facts) {
  const int kind = int(segment.marker);
  const std::string_view text = segment.text;
  const auto has_new = [&](const char* name, const char* record) {
    return !facts.attributes.contains(name) && text.find(record) != text.npos;
  };
  if (kind == exif_and_xmp && text.starts_with(exif_mark)) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(text.data());
    read_exif(std::span(bytes, text.size()).subspan(exif_mark.size()), facts);
  }
  if (kind == exif_and_xmp && text.starts_with(jpeg_xmp_mark)) return !tells_facts(text);
  // IPTC's records 2:120 and 2:116 (IIM 4.2, section 6).
  if (kind == photoshop) return !has_new(description, "\x1c\x02\x78") && !has_new(copyright, "\x1c\x02\x74");
  if (kind == JPEG_COM) facts.attributes.emplace(description, text.substr(0, text.find('\0')));
  return true;
}

ImageFacts facts_of(const Header& h) {
  ImageFacts f{.width = h.width, .height = h.height, .encoded = true, .names = false, .depth = Depth::uint8};
  f.channels = h.channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  return f;
}

// The facts in XMP that EXIF does not tell.
void read_xmp(const std::vector<XmpNode>& xmp, ImageFacts& facts) {
  constexpr std::string_view tiff = "http://ns.adobe.com/tiff/1.0/", dc = "http://purl.org/dc/elements/1.1/";
  const std::optional<double> way = xmp_number(xmp, tiff, "Orientation");
  if (way && *way >= 1 && *way <= 8 && facts.orientation == Orientation::upright)
    facts.orientation = static_cast<Orientation>(*way);
  for (const auto& [name, attribute] : {std::pair("description", description), std::pair("rights", copyright)})
    for (const std::string& text : xmp_values(xmp, dc, name)) facts.attributes.emplace(attribute, text);
}

class Reader {
 public:
  explicit Reader(const InputFile& file) : file_(file) { restart(); }

  [[nodiscard]] const Header& header() const { return header_; }
  /// Rows have four channels, of what of each ink is not there.
  void keep_inks() { inks_ = true; }

  void read(int begin, int end, int first, int count, std::span<float> out) {
    if (begin < next_) restart();
    if (!started_) jpeg_->run([](jpeg_decompress_struct& j) { jpeg_start_decompress(&j); });
    started_ = true;
    row_.resize(std::size_t(header_.width) * (header_.is_cmyk() ? 4 : std::size_t(header_.channels)));
    for (; next_ < begin; ++next_) read_row();
    float* to = out.data();
    for (; next_ < end; ++next_) {
      read_row();
      if (header_.is_cmyk() && !inks_) make_rgb();
      constexpr float unit = 1.0F / 255;
      const std::size_t channels = inks_ ? 4 : std::size_t(header_.channels);
      for (std::size_t x = 0; x < std::size_t(header_.width); ++x)
        for (int c = first; c < first + count; ++c) *to++ = float(row_[x * channels + std::size_t(c)]) * unit;
    }
  }

 private:
  void restart() {
    jpeg_.emplace(file_);
    header_ = read_header(*jpeg_);
    next_ = 0;
    started_ = false;
  }

  void read_row() {
    jpeg_->run([&](jpeg_decompress_struct& j) {
      JSAMPROW row = row_.data();
      jpeg_read_scanlines(&j, &row, 1);
    });
  }

  // Adobe's files hold what of each ink is not there.
  void make_rgb() {
    for (std::size_t x = 0; x < std::size_t(header_.width); ++x)
      for (std::size_t c = 0; c < 3; ++c) row_[3 * x + c] = JSAMPLE((row_[4 * x + c] * row_[4 * x + 3] + 127) / 255);
  }

  const InputFile& file_;
  std::optional<JpegFile> jpeg_;
  Header header_;
  int next_ = 0;  // Row that libjpeg reads.
  bool started_ = false, inks_ = false;
  std::vector<JSAMPLE> row_;
};

// ---- gain maps ------------------------------------------------------------------------------------------------------

std::vector<unsigned char> all_texels(JpegFile& jpeg, const Header& h) {
  const std::size_t row = std::size_t(h.width) * std::size_t(h.channels);
  std::vector<unsigned char> values(row * std::size_t(h.height));
  jpeg.run([&](jpeg_decompress_struct& j) {
    jpeg_start_decompress(&j);
    while (j.output_scanline < j.output_height) {
      JSAMPROW to = values.data() + std::size_t{j.output_scanline} * row;
      jpeg_read_scanlines(&j, &to, 1);
    }
  });
  return values;
}

// The image of a gain map, as bytes.
void read_gains(const InputFile& file, std::uint64_t at, GainMap& map) {
  JpegFile jpeg(file, at);
  const Header h = read_header(jpeg);
  const double texels = double(h.width) * h.height;
  if (texels > 2e4 * double(file.size()) || texels > 0x1p28)
    throw InputError(fmt::format("damaged: a gain map of {}x{}", h.width, h.height), Remedy::take_base);
  if (h.is_cmyk()) throw InputError("damaged: a gain map of inks", Remedy::take_base);
  map.width = h.width, map.height = h.height, map.channels = h.channels;
  map.values = all_texels(jpeg, h);
}

// A picture whose light is worked out of the base and the gain.
class Lit {
 public:
  Lit(std::shared_ptr<Reader> base, const StatedColour& colour, FoundGainMap found, double weight)
      : base_(std::move(base)), decode_(colour.decode), map_(std::move(found.map)), weight_(weight) {
    const Primaries of_base = colour.space.primaries.value_or(rec709);
    primaries_ = same(of_base, cie_xyz) ? rec709 : of_base;
    if (!map_.of_base_colours && !found.icc_profile.empty()) {
      const IccColours other = read_icc(std::as_bytes(std::span(found.icc_profile)));
      if (other.colour.space.primaries && !same(*other.colour.space.primaries, cie_xyz))
        primaries_ = *other.colour.space.primaries;
    }
    if (!same(of_base, primaries_)) matrix_ = conversion(of_base, primaries_);
  }

  /// Of the light.
  [[nodiscard]] const Primaries& primaries() const { return primaries_; }

  void read(int begin, int end, int first, int count, std::span<float> out) {
    const Header& h = base_->header();
    const std::size_t width = std::size_t(h.width);
    std::vector<Colour> rows(width * std::size_t(end - begin));
    const std::span<float> last =
        std::span(&rows.data()->x, 3 * rows.size()).last(rows.size() * std::size_t(h.channels));
    base_->read(begin, end, 0, h.channels, last);
    if (h.channels == 1)
      for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = Colour(last[k]);
    if (decode_) decode_(rows);
    parallel_for(end - begin, [&](int k) {
      const std::span row = std::span(rows).subspan(std::size_t(k) * width, width);
      if (matrix_)
        for (Colour& c : row) c = Colour(*matrix_ * Flux(c));
      apply_gain(map_, weight_, begin + k, h.height, row);
    });
    float* to = out.data();
    for (const Colour& c : rows)
      for (int k = first; k < first + count; ++k) *to++ = c[k];
  }

 private:
  std::shared_ptr<Reader> base_;
  std::function<void(std::span<Colour>)> decode_;
  GainMap map_;
  double weight_;
  Primaries primaries_;
  std::optional<ColourMatrix> matrix_;
};

// Light of the scene instead of a picture for any screen.
ImageReader lit_reader(const InputFile& file, std::shared_ptr<Reader> base, ImageFacts facts, FoundGainMap found,
                       std::optional<double> headroom) {
  const double weight = found.map.weight(headroom);
  StatedColour colour{.space = {"sRGB", rec709, "integers", true}, .decode = decode_srgb};
  if (!facts.icc_profile.empty()) {
    const IccColours icc = read_icc(std::as_bytes(std::span(facts.icc_profile)));
    if (icc.channels == 4 || (icc.channels == 1 && base->header().channels == 3))
      throw InputError(fmt::format("ICC profile '{}' is not of RGB, which the image is", icc.name));
    colour = icc.colour;
    facts.claims.push_back({.name = "ICC profile", .value = icc.name});
    facts.icc_profile.clear();
  }
  read_gains(file, found.at, found.map);
  const double most = found.map.headroom, given = std::min(headroom.value_or(most), most);
  facts.claims.push_back(
      {"gain map", fmt::format("{}, {:.4g} of {:.4g} stops of headroom", found.map.words(), given, most)});
  const auto lit = std::make_shared<Lit>(std::move(base), colour, std::move(found), weight);
  facts.channels = {"R", "G", "B"};
  facts.encoded = false;
  facts.depth = Depth::single;
  facts.colour =
      StatedColour{.space = {space_with(lit->primaries()), lit->primaries(), "gain map", true}, .fixed = true};
  return {.format = "jpeg",
          .facts = facts,
          .read = [lit](int, int begin, int end, int first, int count, std::span<float> out) {
            lit->read(begin, end, first, count, out);
          }};
}

// The base alone: what is announced is said to be overridden, also where it is broken.
void tell_unused(const InputFile& file, const std::vector<JpegSegment>& segments, ImageFacts& facts) {
  const auto tell = [&](const std::string& value) {
    facts.claims.push_back({"gain map", value, Claim::Outcome::overridden});
  };
  try {
    if (auto found = find_gain_map(file, segments)) read_gains(file, found->at, found->map), tell(found->map.words());
  } catch (const InputError& e) {
    tell(e.what());
  }
}

}  // namespace

std::optional<ImageReader> open_jpeg(const InputFile& file, std::optional<double> headroom, bool for_texture) {
  const auto reader = std::make_shared<Reader>(file);
  const Header& h = reader->header();
  if (h.colours == JCS_UNKNOWN) return std::nullopt;
  ImageFacts facts = facts_of(h);
  const std::vector<JpegSegment> segments = jpeg_segments(file, 0);
  bool is_for_us = true;
  for (const JpegSegment& s : segments) is_for_us &= read_segment(s, facts);
  if (!for_texture) facts.icc_profile = icc_profile_of(segments);
  const bool base_alone = for_texture || (headroom && *headroom <= 0);
  std::optional<FoundGainMap> found = base_alone ? std::nullopt : find_gain_map(file, segments);
  const bool has_gain = found && found->map.weight(headroom) > 0;
  if (headroom && base_alone) tell_unused(file, segments, facts);
  if (has_gain && h.is_cmyk()) throw InputError("not supported: a gain map of a picture of inks", Remedy::take_base);
  // OpenImageIO knows no gain maps, or has a library for them that differs from system to system.
  const bool claims_gain = found || !facts.claims.empty();
  if (!is_for_us && !claims_gain) return std::nullopt;
  if (!is_for_us) read_xmp(xmp_of(segments), facts);
  if (has_gain) return lit_reader(file, reader, facts, std::move(*found), headroom);
  if (h.is_cmyk() && !facts.icc_profile.empty()) {
    reader->keep_inks();
    facts.channels = {"C", "M", "Y", "K"};
    facts.inks = ImageFacts::Inks::inverted;
  }
  return ImageReader{.format = "jpeg",
                     .facts = facts,
                     .read = [reader](int, int begin, int end, int first, int count, std::span<float> out) {
                       reader->read(begin, end, first, count, out);
                     }};
}

std::vector<unsigned char> decode_jpeg(const std::string& bytes) {
  const InputFile file(std::span<const char>(bytes.data(), bytes.size()));
  JpegFile jpeg(file);
  return all_texels(jpeg, read_header(jpeg));
}

}  // namespace envmap
