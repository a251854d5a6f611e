// Reads PNG row by row through libpng (libpng-manual.txt, section III).
#include <png.h>
#include <strings.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <memory>
#include <string>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/png.h"

namespace envmap {
namespace {

// libpng leaves by longjmp() where it cannot go on, so its callbacks and run() hold nothing that has a destructor.
class PngFile {
 public:
  explicit PngFile(const InputFile& file)
      : file_(file), png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, ignore_warning)) {
    if (png_) info_ = png_create_info_struct(png_);
    if (!info_) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw InputError("no memory for libpng");
    }
    png_set_read_fn(png_, this, get);
  }
  ~PngFile() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngFile(const PngFile&) = delete;
  PngFile& operator=(const PngFile&) = delete;

  template <class Calls>
  void run(const Calls& calls) {
    if (setjmp(png_jmpbuf(png_)) == 0) return calls(png_, info_);
    if (const std::size_t end = message_.find(": unhandled critical chunk"); end != message_.npos)
      throw InputError("not supported: PNG with the chunk " + message_.substr(0, end) +
                       ", which changes the image: save it again by a program that knows this chunk, as a plain PNG");
    throw InputError(message_);
  }

 private:
  [[noreturn]] static void fail(png_structp png, png_const_charp message) {
    static_cast<PngFile*>(png_get_error_ptr(png))->message_ = message;
    png_longjmp(png, 1);
  }
  static void ignore_warning(png_structp, png_const_charp) {}
  static void get(png_structp png, png_bytep bytes, png_size_t size) {
    auto& self = *static_cast<PngFile*>(png_get_io_ptr(png));
    if (self.file_.pread(bytes, size, self.next_) != size) png_error(png, "it ends too early");
    self.next_ += size;
  }

  const InputFile& file_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::uint64_t next_ = 0;
  std::string message_;
};

struct Header {
  png_uint_32 width = 0, height = 0;
  int bits = 0, kind = 0, interlace = 0, channels = 0, intent = 0;
  std::size_t row_bytes = 0;
  bool srgb = false, says_gamma = false;
  bool has_exif = false, has_cicp = false, has_offset = false;  // Chunks that OpenImageIO reads.
  double gamma = 0;
  png_textp texts = nullptr;
  int text_count = 0;

  [[nodiscard]] bool has_alpha() const { return channels % 2 == 0; }
};

// 1, 2 and 4 bits become 8, a palette its colours, and tRNS an alpha channel. The texts belong to libpng.
Header read_header(PngFile& png) {
  Header h;
  png.run([&](png_structp p, png_infop info) {
    png_read_info(p, info);
    png_set_expand(p);
    png_read_update_info(p, info);
    png_get_IHDR(p, info, &h.width, &h.height, &h.bits, &h.kind, &h.interlace, nullptr, nullptr);
    h.channels = png_get_channels(p, info);
    h.row_bytes = png_get_rowbytes(p, info);
    h.srgb = png_get_sRGB(p, info, &h.intent) != 0;
    h.says_gamma = png_get_gAMA(p, info, &h.gamma) != 0 && h.gamma > 0;
    h.has_offset = png_get_valid(p, info, PNG_INFO_oFFs) != 0;
#ifdef PNG_INFO_eXIf
    h.has_exif = png_get_valid(p, info, PNG_INFO_eXIf) != 0;
#endif
#ifdef PNG_INFO_cICP
    h.has_cicp = png_get_valid(p, info, PNG_INFO_cICP) != 0;
#endif
    png_get_text(p, info, &h.texts, &h.text_count);
  });
  return h;
}

// PNG's keywords under the names of other formats (PNG 1.2, section 4.2.3). A later text replaces one of its name.
Attributes attributes_of(const Header& h) {
  Attributes attributes;
  for (const png_text& t : std::span(h.texts, std::size_t(h.text_count))) {
    const auto is = [&](const char* key) { return strcasecmp(t.key, key) == 0; };
    const std::string name = is("Description") ? description
                             : is("Author")    ? "Artist"
                             : is("Title")     ? "DocumentName"
                                               : std::string(t.key);
    std::erase_if(attributes, [&](const auto& a) { return strcasecmp(a.first.c_str(), name.c_str()) == 0; });
    attributes.emplace(name, t.text ? t.text : "");
  }
  return attributes;
}

// Texts that hold EXIF or XMP, which may say how a camera was held, or that OpenImageIO takes for its own attributes.
bool is_for_openimageio(const std::string& name) {
  const auto begins = [&](const char* key, std::size_t size) { return strncasecmp(name.c_str(), key, size) == 0; };
  return begins("XML:com.adobe.xmp", 17) || begins("Raw profile type", 16) || begins("Orientation", 11) ||
         begins("oiio:", 5);
}

// Gammas are told apart by hundredths.
ImageFacts facts_of(const Header& h) {
  constexpr const char* names[] = {"R", "G", "B", "A"};
  ImageFacts f{.width = int(h.width),
               .height = int(h.height),
               .encoded = h.srgb || !h.says_gamma || std::round(100 / h.gamma) != 100,
               .names = false,
               .depth = h.bits == 16 ? Depth::uint16 : Depth::uint8,
               .attributes = attributes_of(h)};
  if (h.channels < 3) f.channels = {"Y"};
  if (h.channels == 2) f.channels.emplace_back("A");
  if (h.channels > 2) f.channels.assign(names, names + h.channels);
  return f;
}

class Reader {
 public:
  Reader(const InputFile& file, bool straight_alpha) : file_(file), straight_(straight_alpha) { start(); }

  [[nodiscard]] const Header& header() const { return header_; }

  void read(int begin, int end, int first, int count, std::span<float> out) {
    if (begin < next_ && whole_.empty()) start();
    const bool interlaced = header_.interlace != PNG_INTERLACE_NONE;
    if (interlaced && whole_.empty()) read_whole();
    row_.resize(header_.row_bytes);
    for (; !interlaced && next_ < begin; ++next_) read_row();
    for (int y = begin; y < end; ++y) {
      if (!interlaced) read_row(), ++next_;
      const png_byte* row = interlaced ? whole_.data() + std::size_t(y) * header_.row_bytes : row_.data();
      const auto to = out.subspan(std::size_t(y - begin) * header_.width * std::size_t(count));
      if (header_.bits == 16)
        set_floats([row](std::size_t k) { return unsigned{row[2 * k]} << 8U | row[2 * k + 1]; }, 65535, first, count,
                   to);
      else
        set_floats([row](std::size_t k) { return unsigned{row[k]}; }, 255, first, count, to);
    }
  }

 private:
  void start() {
    png_.emplace(file_);
    header_ = read_header(*png_);
    next_ = 0;
  }

  void read_row() {
    png_->run([&](png_structp p, png_infop) { png_read_row(p, row_.data(), nullptr); });
  }

  // The last pass of seven has texels of every second row.
  void read_whole() {
    std::vector<png_byte> texels(header_.row_bytes * header_.height);
    std::vector<png_bytep> rows;
    for (std::size_t y = 0; y < header_.height; ++y) rows.push_back(texels.data() + y * header_.row_bytes);
    png_->run([&](png_structp p, png_infop) { png_read_image(p, rows.data()); });
    whole_ = std::move(texels);
  }

  // Of a row. PNG's colours are not multiplied by alpha; a map's are. The products are integers, rounded down.
  template <class Sample>
  void set_floats(const Sample& sample, unsigned most, int first, int count, std::span<float> out) const {
    const float unit = 1 / float(most);
    const std::size_t channels = std::size_t(header_.channels), alpha = channels - 1;
    const bool multiply = header_.has_alpha() && !straight_;
    float* to = out.data();
    for (std::size_t x = 0; x < header_.width; ++x)
      for (std::size_t c = std::size_t(first); c < std::size_t(first + count); ++c) {
        unsigned value = sample(x * channels + c);
        if (multiply && c != alpha) value = value * sample(x * channels + alpha) / most;
        *to++ = float(value) * unit;
      }
  }

  const InputFile& file_;
  bool straight_;
  std::optional<PngFile> png_;
  Header header_;
  int next_ = 0;  // Row that libpng reads.
  std::vector<png_byte> row_, whole_;
};

}  // namespace

std::optional<ImageReader> open_png(const InputFile& file, bool straight_alpha) {
  const auto reader = std::make_shared<Reader>(file, straight_alpha);
  const Header& h = reader->header();
  const ImageFacts facts = facts_of(h);
  const bool alpha_of_gamma = h.has_alpha() && !straight_alpha && h.says_gamma && !h.srgb;
  if (h.has_exif || h.has_cicp || h.has_offset || alpha_of_gamma) return std::nullopt;
  for (const auto& [name, text] : facts.attributes)
    if (is_for_openimageio(name)) return std::nullopt;
  return ImageReader{.format = "png",
                     .facts = facts,
                     .read = [reader](int, int begin, int end, int first, int count, std::span<float> out) {
                       reader->read(begin, end, first, count, out);
                     }};
}

}  // namespace envmap
