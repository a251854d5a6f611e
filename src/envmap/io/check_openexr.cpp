#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "envmap/base/error.h"
#include "envmap/io/openexr.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

// The bytes of a header, one after the other ("OpenEXR file layout": little-endian, texts end in 0).
class Cursor {
 public:
  explicit Cursor(const InputFile& file) : file_(file) {}

  template <class T>
  T get() {
    T value;
    read(&value, sizeof value);
    return value;
  }
  std::string text() {
    constexpr std::size_t most = 256;
    std::string found;
    for (char c = get<char>(); c != '\0'; c = get<char>()) {
      if (found.size() == most) throw InputError("damaged: a name in its header has no end");
      found += c;
    }
    return found;
  }
  void skip_to(std::uint64_t place) { at_ = place; }
  [[nodiscard]] std::uint64_t at() const { return at_; }
  [[nodiscard]] std::uint64_t left() const { return file_.size() - std::min(at_, file_.size()); }

 private:
  void read(void* to, std::size_t size) {
    if (left() < size) throw InputError("it ends too early");
    if (at_ < from_ || at_ + size > from_ + held_) {
      from_ = at_;
      held_ = file_.pread(buffer_.data(), buffer_.size(), at_);
    }
    std::memcpy(to, buffer_.data() + (at_ - from_), size);
    at_ += size;
  }

  const InputFile& file_;
  std::uint64_t at_ = 0, from_ = 0, held_ = 0;
  std::array<char, 4096> buffer_ = {};
};

// What says how many chunks a part has.
struct Part {
  std::array<std::int32_t, 4> window{};  // Of data: least x and y, largest.
  unsigned char compression = 3;         // Zip, where nothing is said.
  bool tiled = false;
  std::uint32_t tile_width = 0, tile_height = 0;
  unsigned char mode = 0;

  [[nodiscard]] double width() const { return 1.0 + window[2] - window[0]; }
  [[nodiscard]] double height() const { return 1.0 + window[3] - window[1]; }
};

// OpenEXR reads as many bytes as a type has, whatever the attribute says of its size,
// and what is next begins after them.
constexpr std::pair<std::string_view, int> sizes_of_types[] = {{"box2f", 16},
                                                               {"box2i", 16},
                                                               {"chromaticities", 32},
                                                               {"compression", 1},
                                                               {"deepImageState", 1},
                                                               {"double", 8},
                                                               {"envmap", 1},
                                                               {"float", 4},
                                                               {"int", 4},
                                                               {"keycode", 28},
                                                               {"lineOrder", 1},
                                                               {"m33d", 72},
                                                               {"m33f", 36},
                                                               {"m44d", 128},
                                                               {"m44f", 64},
                                                               {"rational", 8},
                                                               {"tiledesc", 9},
                                                               {"timecode", 8},
                                                               {"v2d", 16},
                                                               {"v2f", 8},
                                                               {"v2i", 8},
                                                               {"v3d", 24},
                                                               {"v3f", 12},
                                                               {"v3i", 12}};

bool size_fits(Cursor& in, std::string_view type, std::uint64_t size) {
  const auto* const known = std::ranges::find(sizes_of_types, type, &std::pair<std::string_view, int>::first);
  if (known != std::end(sizes_of_types)) return size == std::uint64_t(known->second);
  if (type != "chlist") return true;
  // Names, each with its type, flags and sampling; an empty one is the last.
  const std::uint64_t begin = in.at();
  while (!in.text().empty()) in.skip_to(in.at() + 16);
  return in.at() == begin + size;
}

// Attributes as far as they are wanted. @return whether there was a header: an empty one ends a list of parts.
bool read_header(Cursor& in, Part& part) {
  bool any = false;
  for (std::string name = in.text(); !name.empty(); name = in.text(), any = true) {
    const std::string type = in.text();
    const auto size = in.get<std::int32_t>();
    // OpenEXR takes the memory before it looks.
    if (size < 0 || std::uint64_t(size) > in.left())
      throw InputError(fmt::format("damaged: an attribute of {} bytes in a file of fewer", size));
    const std::uint64_t begin = in.at(), end = begin + std::uint64_t(size);
    if (!size_fits(in, type, end - begin))
      throw InputError(fmt::format("damaged: an attribute of type {} has {} bytes", type, size));
    in.skip_to(begin);
    if (name == "dataWindow" && size == 16) part.window = in.get<std::array<std::int32_t, 4>>();
    if (name == "compression" && size == 1) part.compression = in.get<unsigned char>();
    if (name == "tiles" && size == 9) {
      part.tile_width = in.get<std::uint32_t>();
      part.tile_height = in.get<std::uint32_t>();
      part.mode = in.get<unsigned char>();
    }
    if (name == "type" && size < 16) {
      std::string kind;
      for (int k = 0; k < size; ++k) kind += in.get<char>();
      part.tiled = kind == "tiledimage" || kind == "deeptile";
    }
    in.skip_to(end);
  }
  return any;
}

// Lines that are compressed together: by the number of the compression, none rle zips zip piz pxr24 b44 b44a dwaa dwab.
double lines_of_chunk(unsigned char compression) {
  constexpr int lines[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
  return compression < std::size(lines) ? lines[compression] : 1;
}

// How many times smaller than its floats a chunk can be.
double most_smaller(unsigned char compression) {
  const bool dwa = compression == 8 || compression == 9;
  return dwa ? 2e5 : 2e4;
}

// Tiles along a side of a level; each is half the one before, rounded down or up.
double tiles_along(double side, int level, bool up, double tile) {
  const double halved = side / portable::exp2(level);
  return std::ceil(std::max(1.0, up ? std::ceil(halved) : std::floor(halved)) / tile);
}

double chunks_of(const Part& p) {
  if (!p.tiled) return std::ceil(p.height() / lines_of_chunk(p.compression));
  if (p.tile_width < 1 || p.tile_height < 1) throw InputError("damaged: tiles without a size");
  const int mode = p.mode & 15;
  const bool up = p.mode >> 4 != 0;
  const auto levels = [&](double side) {
    return 1 + int(up ? std::ceil(portable::log2(side)) : std::floor(portable::log2(side)));
  };
  const auto across = [&](int level) { return tiles_along(p.width(), level, up, p.tile_width); };
  const auto down = [&](int level) { return tiles_along(p.height(), level, up, p.tile_height); };
  double chunks = across(0) * down(0);
  if (mode == 1)
    for (int k = 1; k < levels(std::max(p.width(), p.height())); ++k) chunks += across(k) * down(k);
  if (mode == 2) {
    double columns = 0, rows = 0;
    for (int k = 0; k < levels(p.width()); ++k) columns += across(k);
    for (int k = 0; k < levels(p.height()); ++k) rows += down(k);
    chunks = columns * rows;
  }
  return chunks;
}

}  // namespace

void check_openexr(const InputFile& file) {
  static_assert(std::endian::native == std::endian::little);
  constexpr std::uint32_t flag_tiled = 0x200, flag_parts = 0x1000;
  Cursor in(file);
  in.get<std::uint32_t>();  // The mark.
  const auto version = in.get<std::uint32_t>();
  double chunks = 0;
  for (bool more = true; more;) {
    Part part{.tiled = (version & flag_tiled) != 0};
    const bool any = read_header(in, part);
    more = any && (version & flag_parts) != 0;
    if (!any) break;
    if (part.width() < 1 || part.height() < 1) throw InputError("damaged: its data window is empty");
    // No compression in use makes a map 20,000 times smaller; DWA keeps one number of 64, in zlib's 1000 times fewer
    // bytes. OpenEXR takes memory for all lines of a chunk, if there are fewer in the image, too.
    const double bytes = part.width() * std::max(part.height(), lines_of_chunk(part.compression)) * 12;
    if (bytes > 0x1p28 && bytes > most_smaller(part.compression) * double(file.size()))
      throw InputError(fmt::format("truncated or damaged: {} bytes cannot hold {:.0f}x{:.0f}", file.size(),
                                   part.width(), part.height()));
    chunks += chunks_of(part);
    // The file begins with the places of all of them, 8 bytes each.
    if (8 * chunks > double(in.left()))
      throw InputError(fmt::format("truncated or damaged: {} bytes cannot hold {:.0f} chunks", file.size(), chunks));
  }
}

}  // namespace envmap
