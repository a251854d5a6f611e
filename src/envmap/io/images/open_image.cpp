#include "envmap/io/images/open_image.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "envmap/base/error.h"
#include "envmap/io/claims/icc_profile.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/io/formats/openimageio_module.h"
#include "envmap/io/images/check_tiles.h"
#include "envmap/io/images/exif_orientation.h"

namespace envmap {

namespace fs = std::filesystem;

void Image::read(int level, int begin, int end, int first, int count, std::span<float> out) const {
  try {
    reader->read(level, begin, end, first, count, out);
  } catch (const InputError& e) {
    const std::string why = e.what();
    fail(why.starts_with("not supported") ? why : "truncated or damaged: " + why);
  }
}

void Image::fail(std::string why, Remedy remedy) const {
  std::ranges::replace_if(
      why, [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
  throw InputError(name, why, remedy);
}

namespace {

// Errors name the image, and what they say follows `before`.
template <class F>
void naming(const Image& image, const std::string& before, F&& action) {
  try {
    action();
  } catch (const InputError& e) {
    // A sound file of a kind that is not read is an image all the same.
    const std::string why = e.what();
    image.fail(why.starts_with("not supported") ? why : before + why, e.remedy());
  }
}

// Our own readers know more of colours than OpenImageIO tells.
void add_found(const ImageFacts& found, ImageFacts& facts) {
  facts.claims.insert(facts.claims.end(), found.claims.begin(), found.claims.end());
  if (!found.icc_profile.empty()) facts.icc_profile = found.icc_profile;
  if (!found.colour) return;
  facts.colour = found.colour;
  facts.icc_profile.clear();
}

// Image::file -> its reader. OpenImageIO asked about a file it does not know tries 30 readers in turn, and some write
// beyond their memory, even for sound files (2.4: ICO, IFF, DPX): none is asked but the one that fits. @param path of a
// file on disk that OpenImageIO may open itself; of others it is a name.
void open_as_its_bytes_say(Image& image, const std::string& path, const ImageChoice& choice) {
  InputFile& file = *image.file;
  if (file.size() == 0) image.fail(path.empty() ? "is empty: what should have written it may have failed" : "is empty");
  char head[head_size] = {};
  const std::size_t size = file.pread(head, head_size, 0);
  const FileFormat* known = format_of({head, size}, path);
  const std::string unread = "not an image that can be read: ";
  if (!known) image.fail(unread + "none of " + readable_formats());
  const std::string format(known->name);
  if (choice.of_part() && !known->can(FileFormat::parts))
    throw UsageError(image.name, "parts, layers and channels are chosen of EXR files alone");
  if (choice.crop && !known->can(FileFormat::window))
    throw UsageError(image.name, "only EXR and TIFF files have a data window that could be read alone");
  if (choice.headroom && !known->can(FileFormat::gain_map))
    throw UsageError(image.name, "only JPEG and HEIF files have gain maps, which headroom is for");
  naming(image, "", [&] {
    file.read_all();
    image.size = file.size();
  });
  // Readers of formats with levels speak for themselves.
  naming(image, known->levels ? "" : unread, [&] {
    if (known->open) known->open(image, choice);
  });
  if (image.texture) return;
  naming(image, unread, [&] {
    if (!image.reader) {
      if (path.empty()) file.hold();
      image.reader =
          formats().open(format, path.empty() ? image.name : path, file.bytes(), image.for_texture, choice.crop);
      check_tiles(image.reader->facts);
      add_found(image.found, image.reader->facts);
    }
    if (!image.for_texture && !image.reader->facts.icc_profile.empty()) honour_profile(*image.reader);
    // The coordinates of a texture count from its first texel, whatever way a camera was held.
    if (!image.for_texture && image.reader->facts.orientation != Orientation::upright)
      image.reader = turned_upright(std::move(*image.reader));
  });
}

void check_file(const Image& image, const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    image.fail(error && error != std::errc::no_such_file_or_directory ? error.message() : "no such file");
  if (fs::is_directory(status)) image.fail("is a folder: give a file name");
}

}  // namespace

void open_bytes(Image& image, std::string name, std::span<const char> bytes, bool for_texture,
                const ImageChoice& choice) {
  image.name = std::move(name);
  image.file = std::make_unique<InputFile>(bytes);
  image.for_texture = for_texture;
  open_as_its_bytes_say(image, image.name, choice);
}

void open(Image& image, const std::string& path, const ImageChoice& choice) {
  const bool standard = path == "-";
  image.name = standard ? "standard input" : path;
  if (!standard) check_file(image, path);
  try {
    image.file = standard ? std::make_unique<InputFile>(STDIN_FILENO) : std::make_unique<InputFile>(path);
  } catch (const InputError& e) {
    image.fail(e.what());
  }
  open_as_its_bytes_say(image, standard ? "" : path, choice);
}

}  // namespace envmap
