// Writes PNG row by row through libpng (libpng-manual.txt, section IV).
#include <png.h>

#include <algorithm>
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
  explicit PngFile(OutputFile& file)
      : file_(file), png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, this, fail, ignore_warning)) {
    if (png_) info_ = png_create_info_struct(png_);
    if (!info_) throw OutputError("no memory for libpng");
    png_set_write_fn(png_, this, put, nullptr);
  }
  ~PngFile() { png_destroy_write_struct(&png_, &info_); }
  PngFile(const PngFile&) = delete;
  PngFile& operator=(const PngFile&) = delete;

  template <class Calls>
  void run(const Calls& calls) {
    if (setjmp(png_jmpbuf(png_)) == 0) return calls(png_, info_);
    file_.check();
    throw OutputError(message_);
  }

 private:
  [[noreturn]] static void fail(png_structp png, png_const_charp message) {
    static_cast<PngFile*>(png_get_error_ptr(png))->message_ = message;
    png_longjmp(png, 1);
  }
  static void ignore_warning(png_structp, png_const_charp) {}
  static void put(png_structp png, png_bytep bytes, png_size_t size) {
    if (static_cast<PngFile*>(png_get_io_ptr(png))->file_.write(bytes, size) != size) png_error(png, "a write failed");
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

void write_header(PngFile& png, const ImagePlan& plan) {
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
  const auto png = std::make_shared<PngFile>(file);
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

}  // namespace envmap
