// Reads PNG row by row through libpng (libpng-manual.txt, section III).
#include <fmt/format.h>
#include <png.h>
#include <strings.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/exif.h"
#include "envmap/io/png.h"
#include "envmap/io/png_colour.h"

namespace envmap {
namespace {

// libpng leaves by longjmp() where it cannot go on, so its callbacks and run() hold nothing that has a destructor.
class PngFile {
 public:
  explicit PngFile(const InputFile& file)
      : file_(file), png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, take_warning)) {
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

  /// What libpng passed over in the chunks of colours, or nothing.
  [[nodiscard]] std::string_view damage() const { return damage_.data(); }

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
  // A claim of colours with a wrong checksum is none to pass over.
  static void take_warning(png_structp png, png_const_charp message) {
    auto& self = *static_cast<PngFile*>(png_get_error_ptr(png));
    for (std::size_t at = 0; at < sizeof png_colour_chunks; at += 5)
      if (std::string_view(message).starts_with(std::string_view(png_colour_chunks + at, 4)))
        std::snprintf(self.damage_.data(), self.damage_.size(), "%s", message);
  }
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
  std::array<char, 100> damage_ = {};
};

struct Header {
  png_uint_32 width = 0, height = 0;
  int bits = 0, kind = 0, interlace = 0, channels = 0;
  std::size_t row_bytes = 0;
  bool has_offset = false;  // Which OpenImageIO reads.
  int stored_bits = 0;
  png_textp texts = nullptr;
  png_unknown_chunkp chunks = nullptr;  // Those of colours and EXIF.
  int text_count = 0, chunk_count = 0;

  [[nodiscard]] bool has_alpha() const { return channels % 2 == 0; }
};

constexpr char exif_chunk[] = "eXIf";

// 1, 2 and 4 bits become 8, a palette its colours, and tRNS an alpha channel. Texts and chunks belong to libpng, whose
// versions differ in what they make of chunks of colours: they are kept as they are.
Header read_header(PngFile& png) {
  Header h;
  png.run([&](png_structp p, png_infop info) {
    const auto keep = [&](const char* names, std::size_t size) {
      png_set_keep_unknown_chunks(p, PNG_HANDLE_CHUNK_ALWAYS, reinterpret_cast<png_const_bytep>(names), int(size / 5));
    };
    keep(png_colour_chunks, sizeof png_colour_chunks);
    keep(exif_chunk, sizeof exif_chunk);
    png_read_info(p, info);
    h.stored_bits = png_get_bit_depth(p, info);
    png_set_expand(p);
    png_read_update_info(p, info);
    png_get_IHDR(p, info, &h.width, &h.height, &h.bits, &h.kind, &h.interlace, nullptr, nullptr);
    h.channels = png_get_channels(p, info);
    h.row_bytes = png_get_rowbytes(p, info);
    h.has_offset = png_get_valid(p, info, PNG_INFO_oFFs) != 0;
    h.chunk_count = png_get_unknown_chunks(p, info, &h.chunks);
    png_get_text(p, info, &h.texts, &h.text_count);
  });
  if (!png.damage().empty()) throw InputError(fmt::format("damaged: {}", png.damage()), Remedy::choose_space);
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

// Of a texture, whose channels need not be colours, only whether it is linear: gammas are told apart by hundredths.
bool is_encoded(std::span<const PngChunk> chunks) {
  const auto find = [&](const char* type) { return std::ranges::find(chunks, type, &PngChunk::type); };
  const auto gamma = find("gAMA");
  if (find("sRGB") != chunks.end() || gamma == chunks.end() || gamma->data.size() != 4) return true;
  double value = 0;
  for (const std::byte b : gamma->data) value = 256 * value + std::to_integer<int>(b);
  return value == 0 || std::round(1e7 / value) != 100;
}

void read_chunks(const Header& h, bool for_texture, ImageFacts& facts) {
  std::vector<PngChunk> chunks;
  for (const png_unknown_chunk& c : std::span(h.chunks, std::size_t(h.chunk_count))) {
    const std::string type(reinterpret_cast<const char*>(c.name), 4);
    if (type == exif_chunk) read_exif({c.data, c.size}, facts);
    chunks.push_back({type, {reinterpret_cast<const std::byte*>(c.data), c.size}});
  }
  facts.encoded = is_encoded(chunks);
  if (!for_texture) read_png_colours(chunks, h.stored_bits, facts);
}

ImageFacts facts_of(const Header& h, bool for_texture) {
  constexpr const char* names[] = {"R", "G", "B", "A"};
  ImageFacts f{.width = int(h.width),
               .height = int(h.height),
               .names = false,
               .depth = h.bits == 16 ? Depth::uint16 : Depth::uint8,
               .attributes = attributes_of(h)};
  if (h.channels < 3) f.channels = {"Y"};
  if (h.channels == 2) f.channels.emplace_back("A");
  if (h.channels > 2) f.channels.assign(names, names + h.channels);
  read_chunks(h, for_texture, f);
  // A curve other than sRGB's is undone before colours are multiplied.
  f.straight_alpha = h.has_alpha() && !for_texture && (f.colour || !f.icc_profile.empty());
  return f;
}

class Reader {
 public:
  explicit Reader(const InputFile& file) : file_(file) { start(); }

  [[nodiscard]] const Header& header() const { return header_; }
  /// Colours stay as stored, not multiplied by alpha.
  void keep_straight() { straight_ = true; }

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
  bool straight_ = false;
  std::optional<PngFile> png_;
  Header header_;
  int next_ = 0;  // Row that libpng reads.
  std::vector<png_byte> row_, whole_;
};

}  // namespace

std::optional<ImageReader> open_png(const InputFile& file, bool straight_alpha, ImageFacts* found) {
  const auto reader = std::make_shared<Reader>(file);
  const Header& h = reader->header();
  const ImageFacts facts = facts_of(h, straight_alpha);
  if (found) *found = facts;
  if (straight_alpha || facts.straight_alpha) reader->keep_straight();
  if (h.has_offset) return std::nullopt;
  for (const auto& [name, text] : facts.attributes)
    if (is_for_openimageio(name)) return std::nullopt;
  return ImageReader{.format = "png",
                     .facts = facts,
                     .read = [reader](int, int begin, int end, int first, int count, std::span<float> out) {
                       reader->read(begin, end, first, count, out);
                     }};
}

}  // namespace envmap
