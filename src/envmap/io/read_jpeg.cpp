// Reads JPEG row by row through libjpeg (libjpeg.txt of libjpeg-turbo).
// The second needs the first.
// clang-format off
#include <cstdio>
#include <jpeglib.h>
// clang-format on

#include <algorithm>
#include <array>
#include <csetjmp>
#include <memory>
#include <string_view>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/exif.h"
#include "envmap/io/row_readers.h"

namespace envmap {
namespace {

// An image with thousands of scans takes hours (libjpeg-turbo's LJT-01-005).
constexpr int most_scans = 500;

// libjpeg ends the program where it cannot go on, unless error_exit() leaves by longjmp(): its callbacks and run() hold
// nothing that has a destructor.
class JpegFile {
 public:
  explicit JpegFile(const InputFile& file) : file_(file) {
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
  std::uint64_t next_ = 0;
  bool strict_ = false;
};

struct Header {
  int width = 0, height = 0, channels = 0;
  J_COLOR_SPACE colours = JCS_UNKNOWN;
  jpeg_saved_marker_ptr markers = nullptr;  // libjpeg's.

  [[nodiscard]] bool is_cmyk() const { return colours == JCS_CMYK || colours == JCS_YCCK; }
};

constexpr int exif_and_xmp = JPEG_APP0 + 1, profiles_and_gains = JPEG_APP0 + 2, photoshop = JPEG_APP0 + 13;
constexpr std::string_view exif_mark("Exif\0\0", 6),
    xmp_mark("http://ns.adobe.com/xap/1.0/\0", 29), gain_map_mark = "urn:iso:std:";

Header read_header(JpegFile& file) {
  Header h;
  file.run([&](jpeg_decompress_struct& j) {
    constexpr unsigned whole = 0xffff;
    jpeg_save_markers(&j, exif_and_xmp, whole);
    jpeg_save_markers(&j, profiles_and_gains, unsigned(gain_map_mark.size()));
    jpeg_save_markers(&j, photoshop, whole);
    jpeg_save_markers(&j, JPEG_COM, whole);
    jpeg_read_header(&j, TRUE);
    h.width = int(j.image_width);
    h.height = int(j.image_height);
    h.channels = j.num_components == 1 ? 1 : 3;
    h.colours = j.jpeg_color_space;
    h.markers = j.marker_list;
    if (h.is_cmyk()) j.out_color_space = JCS_CMYK;
  });
  file.be_strict();
  return h;
}

// Adds what a marker tells. The first text of a name counts. @return false where OpenImageIO has to read it.
bool read_marker(int kind, std::string_view text, ImageFacts& facts) {
  const auto has_new = [&](const char* name, const char* record) {
    return !facts.attributes.contains(name) && text.find(record) != text.npos;
  };
  if (kind == exif_and_xmp && text.starts_with(exif_mark)) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(text.data());
    read_exif(std::span(bytes, text.size()).subspan(exif_mark.size()), facts);
  }
  if (kind == exif_and_xmp && text.starts_with(xmp_mark)) return !tells_facts(text);
  if (kind == profiles_and_gains) return text != gain_map_mark;
  // IPTC's records 2:120 and 2:116 (IIM 4.2, section 6).
  if (kind == photoshop) return !has_new(description, "\x1c\x02\x78") && !has_new(copyright, "\x1c\x02\x74");
  if (kind == JPEG_COM) facts.attributes.emplace(description, text.substr(0, text.find('\0')));
  return true;
}

std::optional<ImageFacts> facts_of(const Header& h) {
  ImageFacts f{.width = h.width, .height = h.height, .encoded = true, .names = false, .depth = Depth::uint8};
  if (h.colours == JCS_UNKNOWN) return std::nullopt;
  f.channels = h.channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  for (jpeg_saved_marker_ptr m = h.markers; m; m = m->next)
    if (!read_marker(m->marker, {reinterpret_cast<const char*>(m->data), m->data_length}, f)) return std::nullopt;
  return f;
}

class Reader {
 public:
  explicit Reader(const InputFile& file) : file_(file) { restart(); }

  [[nodiscard]] const Header& header() const { return header_; }

  void read(int begin, int end, int first, int count, std::span<float> out) {
    if (begin < next_) restart();
    if (!started_) jpeg_->run([](jpeg_decompress_struct& j) { jpeg_start_decompress(&j); });
    started_ = true;
    row_.resize(std::size_t(header_.width) * (header_.is_cmyk() ? 4 : std::size_t(header_.channels)));
    for (; next_ < begin; ++next_) read_row();
    float* to = out.data();
    for (; next_ < end; ++next_) {
      read_row();
      if (header_.is_cmyk()) make_rgb();
      constexpr float unit = 1.0F / 255;
      for (std::size_t x = 0; x < std::size_t(header_.width); ++x)
        for (int c = first; c < first + count; ++c)
          *to++ = float(row_[x * std::size_t(header_.channels) + std::size_t(c)]) * unit;
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
  bool started_ = false;
  std::vector<JSAMPLE> row_;
};

}  // namespace

std::optional<ImageReader> open_jpeg(const InputFile& file) {
  const auto reader = std::make_shared<Reader>(file);
  const std::optional<ImageFacts> facts = facts_of(reader->header());
  if (!facts) return std::nullopt;
  return ImageReader{.format = "jpeg",
                     .facts = *facts,
                     .read = [reader](int, int begin, int end, int first, int count, std::span<float> out) {
                       reader->read(begin, end, first, count, out);
                     }};
}

}  // namespace envmap
