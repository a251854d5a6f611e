#include "drawing/letters.h"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/base/system.h"

namespace tools {
namespace {

using namespace envmap;
namespace fs = std::filesystem;

std::string setting(const char* name, const std::string& otherwise) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0' ? value : otherwise;
}

// XDG Base Directory Specification 0.8, and the folder that came before it.
std::vector<fs::path> font_folders() {
  const fs::path home = setting("HOME", "/");
  std::vector<fs::path> folders{fs::path(setting("XDG_DATA_HOME", home / ".local/share")) / "fonts", home / ".fonts"};
  std::istringstream shared(setting("XDG_DATA_DIRS", "/usr/local/share:/usr/share"));
  for (std::string folder; std::getline(shared, folder, ':');) folders.push_back(fs::path(folder) / "fonts");
  folders.push_back(own_program().parent_path() / "../share/fonts");  // Of the portable archive.
  return folders;
}

// The first by its path, so that the order of a folder's entries does not count.
std::string find_below(const fs::path& folder, const std::string& name) {
  std::string found;
  std::error_code error;
  for (auto at = fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied, error);
       !error && at != fs::recursive_directory_iterator(); at.increment(error))
    if (at->path().filename() == name && (found.empty() || at->path() < found)) found = at->path();
  return found;
}

std::string find_font() {
  const std::vector<fs::path> folders = font_folders();
  for (const char* name : {"DejaVuSans.ttf", "LiberationSans-Regular.ttf", "NotoSans-Regular.ttf"})
    for (const fs::path& folder : folders)
      if (std::string found = find_below(folder, name); !found.empty()) return found;
  return {};
}

constexpr Colour light_grey(0.8F);

class Font {
 public:
  explicit Font(const std::string& file) {
    if (FT_Init_FreeType(&library_) != 0 || FT_New_Face(library_, file.c_str(), 0, &face_) != 0) {
      FT_Done_FreeType(library_);
      throw OutputError(file, "no text can be drawn with this font");
    }
  }
  ~Font() { FT_Done_FreeType(library_); }
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;

  void set_height(int pixels) { FT_Set_Pixel_Sizes(face_, 0, FT_UInt(pixels)); }
  // Null where it cannot be drawn.
  FT_GlyphSlot glyph(char32_t letter) {
    return FT_Load_Char(face_, letter, FT_LOAD_RENDER) == 0 ? face_->glyph : nullptr;
  }

 private:
  FT_Library library_ = nullptr;
  FT_Face face_ = nullptr;
};

// One for each thread: FreeType's are not shared.
Font& font_of(int height) {
  thread_local Font font(font_file());
  font.set_height(height);
  return font;
}

// Takes the next letter off UTF-8 text. Bytes that are no letter stand for themselves.
char32_t take_letter(std::string_view& text) {
  const std::size_t length = std::max<std::size_t>(1, utf8_length(text));
  const auto byte = [&](std::size_t k) { return unsigned(static_cast<unsigned char>(text[k])); };
  char32_t letter = length == 1 ? byte(0) : byte(0) & (0x7FU >> length);
  for (std::size_t k = 1; k < length; ++k) letter = letter << 6U | (byte(k) & 0x3FU);
  text.remove_prefix(length);
  return letter;
}

void blend(Picture& onto, int left, int top, const FT_Bitmap& cover) {
  for (int j = 0; j < int(cover.rows); ++j)
    for (int i = 0; i < int(cover.width); ++i)
      if (onto.holds(left + i, top + j)) {
        Colour& pixel = onto.at(left + i, top + j);
        pixel = glm::mix(pixel, light_grey, float(cover.buffer[j * cover.pitch + i]) / 255);
      }
}

}  // namespace

const std::string& font_file() {
  static const std::string found = find_font();
  return found;
}

int width_of_letters(std::string_view text, int height) {
  Font& font = font_of(height);
  int width = 0;
  while (!text.empty())
    if (const FT_GlyphSlot glyph = font.glyph(take_letter(text))) width += int(glyph->advance.x >> 6);
  return width;
}

void draw_letters(Picture& onto, int x, int y, std::string_view text, int height) {
  Font& font = font_of(height);
  while (!text.empty()) {
    const FT_GlyphSlot glyph = font.glyph(take_letter(text));
    if (glyph == nullptr) continue;
    if (glyph->bitmap.pixel_mode == FT_PIXEL_MODE_GRAY)
      blend(onto, x + glyph->bitmap_left, y - glyph->bitmap_top, glyph->bitmap);
    x += int(glyph->advance.x >> 6);
  }
}

}  // namespace tools
