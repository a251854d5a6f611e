#include "envmap/io/image.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "envmap/base/error.h"
#include "envmap/io/dds.h"
#include "envmap/io/formats.h"
#include "envmap/io/ktx2.h"
#include "envmap/io/openexr.h"

namespace envmap {

namespace fs = std::filesystem;

void Image::fail(std::string why) const {
  std::ranges::replace_if(
      why, [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
  throw InputError(name + ": " + why);
}

namespace {

constexpr std::size_t head_size = 16;

// The format that the first bytes say; a Targa file has no such mark, only its name. OpenImageIO asked about a file it
// does not know tries 30 readers in turn, and some write beyond their memory, even for sound files (2.4: ICO, IFF, DPX):
// none is asked but the one that fits.
std::string format_of(std::string_view head, const std::string& path) {
  if (head.starts_with("\x76\x2f\x31\x01")) return "openexr";
  if (head.starts_with("#?")) return "hdr";
  if (head.starts_with("\x89PNG")) return "png";
  if (head.starts_with("II") || head.starts_with("MM")) return "tiff";
  if (head.starts_with("\xff\xd8")) return "jpeg";
  if (head.starts_with("DDS ")) return "dds";
  if (head.starts_with(ktx2_mark)) return "ktx2";
  if (head.size() > 1 && head[0] == 'P' && std::string_view("123456Ff").find(head[1]) != head.npos) return "pnm";
  if (head.starts_with("BM")) return "bmp";
  if (head.starts_with("8BPS")) return "psd";
  if (head.starts_with("\x01\xda")) return "sgi";
  if (head.starts_with("GIF8")) return "gif";
  if (head.find("jP  ") == 4 || head.starts_with("\xff\x4f\xff\x51")) return "jpeg2000";
  if (head.starts_with("RIFF") && head.find("WEBP") == 8) return "webp";
  return path.ends_with(".tga") || path.ends_with(".TGA") ? "targa" : "";
}

// Image::file -> its reader.
void open_as_its_bytes_say(Image& image, const std::string& path, bool straight_alpha) {
  char head[head_size] = {};
  const std::size_t size = image.file->pread(head, head_size, 0);
  const std::string format = format_of({head, size}, path), unread = "not an image that can be read: ";
  if (format.empty())
    image.fail(unread +
               "neither EXR, HDR, PFM, KTX2, DDS, PNM, TIFF, PNG, JPEG, JPEG 2000, WebP, BMP, TGA, GIF, PSD nor SGI");
  try {
    if (format == "ktx2") image.texture = open_ktx2(*image.file);
    if (format == "dds") image.texture = open_dds(*image.file);
  } catch (const InputError& e) {
    image.fail(e.what());
  }
  if (image.texture) return;
  try {
    image.reader = format == "openexr" ? open_openexr(*image.file)
                                       : formats().open(format, path, image.file->bytes(), straight_alpha);
  } catch (const InputError& e) {
    image.fail(unread + e.what());
  }
}

// Standard input and pipes, which cannot be read twice.
void open_stream(Image& image, std::istream& stream) {
  open_bytes(image, image.name, {std::istreambuf_iterator<char>(stream), {}});
}

void open_file(Image& image, const std::string& path) {
  image.name = path;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    image.fail(error && error != std::errc::no_such_file_or_directory ? error.message() : "no such file");
  if (fs::is_directory(status)) image.fail("is a folder; name a file");
  if (!fs::is_regular_file(status)) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) image.fail(std::strerror(errno));
    return open_stream(image, stream);
  }
  try {
    image.file = std::make_unique<InputFile>(path);
  } catch (const InputError& e) {
    image.fail(e.what());
  }
  image.size = image.file->size();
  if (image.size == 0) image.fail("is empty");
  open_as_its_bytes_say(image, path, false);
}

}  // namespace

void open_bytes(Image& image, std::string name, std::vector<char> bytes, bool straight_alpha) {
  image.name = std::move(name);
  image.size = bytes.size();
  if (bytes.empty()) image.fail("is empty");
  image.file = std::make_unique<InputFile>(std::move(bytes));
  open_as_its_bytes_say(image, image.name, straight_alpha);
}

void open(Image& image, const std::string& path) {
  if (path == "-") {
    image.name = "standard input";
    open_stream(image, std::cin);
  } else {
    open_file(image, path);
  }
}

}  // namespace envmap
