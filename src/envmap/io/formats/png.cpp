// PNG by libpng: images in memory, reading row by row with the colours that chunks state, and writing.
#include "envmap/io/formats/png.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <png.h>
#include <strings.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/claims/code_points.h"
#include "envmap/io/claims/exif.h"
#include "envmap/io/claims/power_curve.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/io/images/image_reader.h"

namespace envmap {

// What the chunks of a PNG say of its colours. Source: "Portable Network Graphics (PNG) Specification", third edition
// (2025), sections 4.3 and 11.3.2.

namespace {

struct PngChunk {
  std::string type;  ///< "gAMA".
  std::span<const std::byte> data;
};

/// The chunks of colours, each name with the zero that ends it: for png_set_keep_unknown_chunks().
inline constexpr char png_colour_chunks[] = "cICP\0iCCP\0sRGB\0gAMA\0cHRM\0mDCV\0cLLI";

}  // namespace

// What the chunks of a file state of its colours.

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
    if (is_first("iCCP", name, true)) facts_.icc_profile = inflated("iCCP", chunk->data.subspan(name_size + 2));
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

/// Sets colours, the profile and the claims of an image. The first of cICP, iCCP, sRGB, gAMA with cHRM counts.
/// @param bits of the samples in the file. @throws InputError, which names the chunk, without the file's name.
void read_png_colours(std::span<const PngChunk> chunks, int bits, ImageFacts& facts) {
  Colours(chunks, bits, facts).read();
}

}  // namespace

// PNG by libpng.

namespace {

// libpng's simplified interface ("png_image", libpng-manual.txt, section V).
struct PngMemory : png_image {
  PngMemory() : png_image{} { version = PNG_IMAGE_VERSION; }
  ~PngMemory() { png_image_free(this); }
  PngMemory(const PngMemory&) = delete;
};

void begin(PngMemory& image, std::span<const std::byte> png) {
  if (!png_image_begin_read_from_memory(&image, png.data(), png.size()))
    throw InputError(fmt::format("damaged: a face is no PNG image: {}", image.message));
  // A header can promise anything; deflate makes nothing smaller than a 1032nd.
  const double bytes = double(PNG_IMAGE_SIZE(image));
  if (image.width > 1 << 16 || image.height > 1 << 16 || bytes > 4 * 1032.0 * double(png.size()))
    throw InputError(
        fmt::format("damaged: {} bytes cannot hold a face of {}x{}", png.size(), image.width, image.height));
}

}  // namespace

std::vector<char> png_of_rgba(std::span<const std::byte> rgba, int width, int height) {
  PngMemory image;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGBA;
  std::vector<char> file(PNG_IMAGE_PNG_SIZE_MAX(image));
  png_alloc_size_t size = file.size();
  if (!png_image_write_to_memory(&image, file.data(), &size, 0, rgba.data(), 0, nullptr))
    throw OutputError(fmt::format("not written as PNG: {}", image.message));
  file.resize(size);
  return file;
}

Size size_of_png(std::span<const std::byte> png) {
  PngMemory image;
  begin(image, png);
  return {int(image.width), int(image.height)};
}

RgbaImage rgba_of_png(std::span<const std::byte> png) {
  PngMemory image;
  begin(image, png);
  image.format = PNG_FORMAT_RGBA;
  RgbaImage out{int(image.width), int(image.height), std::vector<std::byte>(PNG_IMAGE_SIZE(image))};
  if (!png_image_finish_read(&image, nullptr, out.bytes.data(), 0, nullptr))
    throw InputError(fmt::format("damaged: a face does not decompress: {}", image.message));
  return out;
}

// Reading.

namespace {

// libpng leaves by longjmp() where it cannot go on, so its callbacks and run() hold nothing that has a destructor.
class PngIn {
 public:
  explicit PngIn(const InputFile& file)
      : file_(file), png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, take_warning)) {
    if (png_) info_ = png_create_info_struct(png_);
    if (!info_) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw InputError("no memory for libpng");
    }
    png_set_read_fn(png_, this, get);
  }
  ~PngIn() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngIn(const PngIn&) = delete;
  PngIn& operator=(const PngIn&) = delete;

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
    static_cast<PngIn*>(png_get_error_ptr(png))->message_ = message;
    png_longjmp(png, 1);
  }
  // A claim of colours with a wrong checksum is none to pass over.
  static void take_warning(png_structp png, png_const_charp message) {
    auto& self = *static_cast<PngIn*>(png_get_error_ptr(png));
    for (std::size_t at = 0; at < sizeof png_colour_chunks; at += 5)
      if (std::string_view(message).starts_with(std::string_view(png_colour_chunks + at, 4)))
        std::snprintf(self.damage_.data(), self.damage_.size(), "%s", message);
  }
  static void get(png_structp png, png_bytep bytes, png_size_t size) {
    auto& self = *static_cast<PngIn*>(png_get_io_ptr(png));
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
  bool has_offset = false;  // A place on a page.
  int stored_bits = 0;
  png_textp texts = nullptr;
  png_unknown_chunkp chunks = nullptr;  // Those of colours and EXIF.
  int text_count = 0, chunk_count = 0;

  [[nodiscard]] bool has_alpha() const { return channels % 2 == 0; }
};

constexpr char exif_chunk[] = "eXIf";

// 1, 2 and 4 bits become 8, a palette its colours, and tRNS an alpha channel. Texts and chunks belong to libpng, whose
// versions differ in what they make of chunks of colours: they are kept as they are.
Header read_header(PngIn& png) {
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

// EXIF may also follow the image (PNG's third edition, 11.3.4.5), where libpng's reading of the header does not come.
void read_exif_after_image(const InputFile& file, ImageFacts& facts) {
  bool image = false;
  for (std::uint64_t at = 8; at + 12 <= file.size();) {
    std::array<unsigned char, 8> head{};
    if (file.pread(head.data(), head.size(), at) != head.size()) return;
    const std::uint64_t size = std::uint64_t{head[0]} << 24U | head[1] << 16U | head[2] << 8U | head[3];
    const std::string_view type(reinterpret_cast<const char*>(head.data()) + 4, 4);
    if (type == "IEND" || at + 12 + size > file.size()) return;
    image |= type == "IDAT";
    if (image && type == exif_chunk) {
      std::vector<unsigned char> exif(size);
      if (file.pread(exif.data(), size, at + 8) == size) read_exif(exif, facts);
      return;
    }
    at += 12 + size;
  }
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
  std::optional<PngIn> png_;
  Header header_;
  int next_ = 0;  // Row that libpng reads.
  std::vector<png_byte> row_, whole_;
};

}  // namespace

std::optional<ImageReader> open_png(const InputFile& file, bool straight_alpha, ImageFacts* found) {
  const auto reader = std::make_shared<Reader>(file);
  const Header& h = reader->header();
  ImageFacts facts = facts_of(h, straight_alpha);
  if (!straight_alpha) read_exif_after_image(file, facts);
  if (h.has_offset)
    facts.claims.push_back(
        {.name = "oFFs", .value = "an offset", .outcome = Claim::Outcome::ignored, .reason = "of a page"});
  if (found) *found = facts;
  if (straight_alpha || facts.straight_alpha) reader->keep_straight();
  for (const auto& [name, text] : facts.attributes)
    if (is_for_openimageio(name)) return std::nullopt;
  return ImageReader{.format = "png",
                     .facts = facts,
                     .read = [reader](int, int begin, int end, int first, int count, std::span<float> out) {
                       reader->read(begin, end, first, count, out);
                     }};
}

// Writing.

namespace {

// libpng leaves by longjmp() where it cannot go on, so its callbacks and run() hold nothing that has a destructor.
class PngOut {
 public:
  explicit PngOut(OutputFile& file)
      : file_(file), png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, this, fail, ignore_warning)) {
    if (png_) info_ = png_create_info_struct(png_);
    if (!info_) throw OutputError("no memory for libpng");
    png_set_write_fn(png_, this, put, nullptr);
  }
  ~PngOut() { png_destroy_write_struct(&png_, &info_); }
  PngOut(const PngOut&) = delete;
  PngOut& operator=(const PngOut&) = delete;

  template <class Calls>
  void run(const Calls& calls) {
    if (setjmp(png_jmpbuf(png_)) == 0) return calls(png_, info_);
    file_.check();
    throw OutputError(message_);
  }

 private:
  [[noreturn]] static void fail(png_structp png, png_const_charp message) {
    static_cast<PngOut*>(png_get_error_ptr(png))->message_ = message;
    png_longjmp(png, 1);
  }
  static void ignore_warning(png_structp, png_const_charp) {}
  static void put(png_structp png, png_bytep bytes, png_size_t size) {
    if (static_cast<PngOut*>(png_get_io_ptr(png))->file_.write(bytes, size) != size) png_error(png, "a write failed");
  }

  OutputFile& file_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::string message_;
};

// The keyword of PNG for an attribute (PNG 1.2, section 4.2.3).
const char* keyword(const std::string& attribute) {
  return attribute == description ? "Description" : attribute == "Artist" ? "Author" : attribute.c_str();
}

std::vector<png_text> texts_of(const Attributes& attributes) {
  std::vector<png_text> texts;
  for (const auto& [name, text] : attributes) {
    const bool ascii = std::ranges::all_of(text, [](char c) { return c >= 0; });
    png_text t{};
    t.compression = ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
    t.key = const_cast<char*>(keyword(name));
    t.text = const_cast<char*>(text.c_str());
    t.text_length = ascii ? text.size() : 0, t.itxt_length = ascii ? 0 : text.size();
    texts.push_back(t);
  }
  return texts;
}

void write_header(PngOut& png, const ImagePlan& plan) {
  const std::vector<png_text> texts = texts_of(plan.attributes);
  const std::string profile = plan.icc_profile.value_or("");
  png.run([&](png_structp p, png_infop info) {
    png_set_user_limits(p, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_IHDR(p, info, png_uint_32(plan.levels[0].width), png_uint_32(plan.levels[0].height),
                 plan.depth == Depth::uint16 ? 16 : 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (!plan.icc_profile) png_set_sRGB_gAMA_and_cHRM(p, info, PNG_sRGB_INTENT_RELATIVE);
    if (!profile.empty())
      png_set_iCCP(p, info, "ICC profile", PNG_COMPRESSION_TYPE_BASE, reinterpret_cast<png_const_bytep>(profile.data()),
                   png_uint_32(profile.size()));
    if (!texts.empty()) png_set_text(p, info, texts.data(), int(texts.size()));
    png_write_info(p, info);
  });
}

// Integers of a row, the high byte first.
void set_bytes(std::span<const Colour> row, Depth depth, std::vector<png_byte>& bytes) {
  const float most = depth == Depth::uint16 ? 65535 : 255;
  bytes.clear();
  for (const Colour& colour : row)
    for (int c = 0; c < 3; ++c) {
      const auto value = unsigned(std::min(most, std::max(0.F, colour[c]) * most + 0.5F));
      if (depth == Depth::uint16) bytes.push_back(png_byte(value >> 8U));
      bytes.push_back(png_byte(value & 0xFFU));
    }
}

}  // namespace

ImageWriter create_png(OutputFile& file, const ImagePlan& plan) {
  const auto png = std::make_shared<PngOut>(file);
  write_header(*png, plan);
  const std::size_t width = std::size_t(plan.levels[0].width);
  return {.write =
              [png, width, depth = plan.depth](int, int begin, int end, std::span<const Colour> rows) {
                std::vector<png_byte> bytes;
                for (std::size_t k = 0; k < std::size_t(end - begin); ++k) {
                  set_bytes(rows.subspan(k * width, width), depth, bytes);
                  png->run([&](png_structp p, png_infop) { png_write_row(p, bytes.data()); });
                }
              },
          .close = [png] { png->run([](png_structp p, png_infop info) { png_write_end(p, info); }); }};
}

std::string inflated(std::string_view type, std::span<const std::byte> data) {
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
  if (status != Z_STREAM_END)
    throw InputError(fmt::format("damaged: its {} chunk does not decompress", type), Remedy::choose_space);
  return out;
}

}  // namespace envmap
