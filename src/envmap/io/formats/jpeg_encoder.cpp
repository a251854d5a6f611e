// Encodes JPEG through libjpeg (libjpeg.txt of libjpeg-turbo).
// The second needs the first.
// clang-format off
#include <cstdio>
#include <jpeglib.h>
// clang-format on

#include "envmap/io/formats/jpeg_encoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdlib>

#include "envmap/base/error.h"

namespace envmap {
namespace {

// libjpeg ends the program where it cannot go on, unless error_exit() leaves by longjmp(): run() holds nothing that has
// a destructor.
class Encoder {
 public:
  Encoder() {
    jpeg_.err = jpeg_std_error(&errors_);
    errors_.error_exit = fail;
    jpeg_.client_data = this;
    run([](jpeg_compress_struct& j) { jpeg_create_compress(&j); });
  }
  ~Encoder() {
    jpeg_destroy_compress(&jpeg_);
    std::free(bytes_);
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  template <class Calls>
  void run(const Calls& calls) {
    if (setjmp(jump_) == 0) return calls(jpeg_);
    throw OutputError(message_.data());
  }
  void write_to_memory() {
    run([this](jpeg_compress_struct& j) { jpeg_mem_dest(&j, &bytes_, &size_); });
  }
  [[nodiscard]] std::string bytes() const { return {reinterpret_cast<const char*>(bytes_), size_}; }

 private:
  [[noreturn]] static void fail(j_common_ptr jpeg) {
    Encoder& self = *static_cast<Encoder*>(jpeg->client_data);
    jpeg->err->format_message(jpeg, self.message_.data());
    std::longjmp(self.jump_, 1);
  }

  jpeg_compress_struct jpeg_ = {};
  jpeg_error_mgr errors_ = {};
  std::jmp_buf jump_ = {};
  std::array<char, JMSG_LENGTH_MAX> message_ = {};
  unsigned char* bytes_ = nullptr;
  unsigned long size_ = 0;
};

}  // namespace

std::string encode_jpeg(const JpegTexels& image, int quality) {
  constexpr int longest = JPEG_MAX_DIMENSION;
  if (std::max(image.width, image.height) > longest)
    throw OutputError(
        fmt::format("JPEG holds {} texels a side at most, not {}x{}", longest, image.width, image.height));
  Encoder encoder;
  encoder.write_to_memory();
  encoder.run([&](jpeg_compress_struct& j) {
    j.image_width = JDIMENSION(image.width);
    j.image_height = JDIMENSION(image.height);
    j.input_components = image.channels;
    j.in_color_space = image.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&j);
    jpeg_set_quality(&j, quality, TRUE);
    j.optimize_coding = TRUE;
    j.comp_info[0].h_samp_factor = j.comp_info[0].v_samp_factor = 1;
    jpeg_start_compress(&j, TRUE);
    const std::size_t row = std::size_t(image.width) * std::size_t(image.channels);
    while (j.next_scanline < j.image_height) {
      JSAMPROW from = const_cast<JSAMPROW>(image.values.data() + std::size_t{j.next_scanline} * row);
      jpeg_write_scanlines(&j, &from, 1);
    }
    jpeg_finish_compress(&j);
  });
  return encoder.bytes();
}

std::string jpeg_segment(unsigned marker, const std::string& text) {
  constexpr std::size_t most = 0xffff - 2;
  if (text.size() > most) throw OutputError(fmt::format("JPEG holds texts of {} bytes at most", most));
  const std::size_t size = text.size() + 2;
  return {"\xff" + std::string{static_cast<char>(marker), static_cast<char>(size >> 8U), static_cast<char>(size)} +
          text};
}

std::string with_segments(const std::string& jpeg, const std::string& segments) {
  constexpr std::size_t behind_jfif = 2 + 18;  // The mark of an image, and JFIF's segment (JFIF 1.02).
  return jpeg.substr(0, behind_jfif) + segments + jpeg.substr(behind_jfif);
}

}  // namespace envmap
