// The module envmap-formats.so: the one file that OpenImageIO's 250 libraries are linked to.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/oiioversion.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>

#include "envmap/base/error.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/formats/openimageio_module.h"
#include "envmap/io/images/data_window.h"

namespace envmap {

// A file of ours as OpenImageIO writes to it, and what its versions name or call differently.

namespace {

/// A file of ours as OpenImageIO writes to it.
class OpenImageIoFile final : public OIIO::Filesystem::IOProxy {
 public:
  explicit OpenImageIoFile(OutputFile& file) : IOProxy("", Write), file_(file) {}
  const char* proxytype() const override { return "envmap"; }
  void close() override {}
  bool opened() const override { return true; }
#if OIIO_VERSION < 30000
  int64_t tell() override { return file_.tell(); }
#else
  int64_t tell() const override { return file_.tell(); }
#endif
  bool seek(int64_t offset) override { return file_.seek(offset), true; }
  size_t read(void* buffer, size_t size) override {
    const size_t n = file_.pread(buffer, size, file_.tell());
    return file_.seek(file_.tell() + static_cast<int64_t>(n)), n;
  }
  size_t write(const void* buffer, size_t size) override { return file_.write(buffer, size); }
  size_t pread(void* buffer, size_t size, int64_t offset) override { return file_.pread(buffer, size, offset); }
  size_t pwrite(const void* buffer, size_t size, int64_t offset) override {
    const int64_t before = file_.tell();
    file_.seek(offset);
    const size_t n = file_.write(buffer, size);
    return file_.seek(before), n;
  }
  size_t size() const override { return static_cast<size_t>(file_.size()); }

 private:
  OutputFile& file_;
};

// libpng and libjpeg print to standard error what OpenImageIO then reports, too. An error is one line: ours.
class SilentLibraries {
 public:
  explicit SilentLibraries(bool silence) : kept_(silence ? ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3) : -1) {
    if (kept_ < 0) return;
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO), ::close(nowhere);
  }
  ~SilentLibraries() {
    if (kept_ >= 0) ::dup2(kept_, STDERR_FILENO), ::close(kept_);
  }
  SilentLibraries(const SilentLibraries&) = delete;

 private:
  int kept_;
};

std::string first_line(const std::string& message, const char* otherwise) {
  const std::string line = message.substr(0, message.find('\n'));
  return line.empty() ? otherwise : line;
}

void use_our_threads() {
  static const bool told =
      OIIO::attribute("threads", int(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)));
  (void)told;
}

// ---- reading --------------------------------------------------------------------------------------------------------

Depth depth_of(OIIO::TypeDesc t) {
  switch (t.basetype) {
    case OIIO::TypeDesc::UINT8:
    case OIIO::TypeDesc::INT8: return Depth::uint8;
    case OIIO::TypeDesc::UINT16:
    case OIIO::TypeDesc::INT16:
    case OIIO::TypeDesc::UINT32:
    case OIIO::TypeDesc::INT32: return Depth::uint16;
    case OIIO::TypeDesc::HALF: return Depth::half;
    default: return Depth::single;
  }
}

// OpenImageIO 2 says Linear, 3 says lin_rec709 or lin_rec709_scene.
bool is_linear(const std::string& space) {
  return OIIO::Strutil::iequals(space, "linear") || OIIO::Strutil::istarts_with(space, "lin_");
}

ImageFacts facts_of(const OIIO::ImageSpec& spec, const OIIO::ImageInput& input) {
  const bool linear = spec.format.is_floating_point() || is_linear(spec.get_string_attribute("oiio:ColorSpace"));
  ImageFacts f{.width = spec.width,
               .height = spec.height,
               .tile_width = spec.tile_width,
               .tile_height = spec.tile_height,
               .flat = spec.depth <= 1 && !spec.deep,
               .encoded = !linear,
               .names = input.supports("arbitrary_metadata") != 0,
               .depth = depth_of(spec.format)};
  for (int c = 0; c < spec.nchannels; ++c) f.channels.emplace_back(spec.channel_name(c));
  for (const OIIO::ParamValue& p : spec.extra_attribs)
    if (p.type() == OIIO::TypeDesc::STRING) f.attributes.emplace(p.name().string(), p.get_string());
  // Only in OpenEXR files do its environment maps have samples on their border.
  if (spec.get_int_attribute("oiio:sampleborder") == 0) f.attributes.erase("textureformat");
  // Of planes a strip is read from its first row on: the rows of a strip go together, as those of tiles do.
  const int rows = spec.get_int_attribute("tiff:RowsPerStrip", 0);
  if (spec.get_string_attribute("planarconfig") == "separate" && spec.tile_width == 0 && rows > 0)
    f.tile_width = spec.width, f.tile_height = std::min(rows, spec.height);
  if (const OIIO::ParamValue* profile = spec.find_attribute("ICCProfile");
      profile && profile->type().basetype == OIIO::TypeDesc::UINT8)
    f.icc_profile.assign(static_cast<const char*>(profile->data()), profile->type().size());
  const int orientation = spec.get_int_attribute("Orientation", 1);
  if (orientation >= 1 && orientation <= 8) f.orientation = static_cast<Orientation>(orientation);
  return f;
}

void read_rows(OIIO::ImageInput& input, int level, int begin, int end, int first, int count, std::span<float> out) {
  const OIIO::ImageSpec spec = input.spec(0, level);
  const OIIO::stride_t pixel = static_cast<OIIO::stride_t>(sizeof(float)) * count, line = pixel * spec.width;
  const SilentLibraries silent(!spec.format.is_floating_point());
  const bool read =
      spec.tile_width > 0
          ? input.read_tiles(0, level, spec.x, spec.x + spec.width, spec.y + begin, spec.y + end, spec.z, spec.z + 1,
                             first, first + count, OIIO::TypeDesc::FLOAT, out.data(), pixel, line)
          : input.read_scanlines(0, level, spec.y + begin, spec.y + end, spec.z, first, first + count,
                                 OIIO::TypeDesc::FLOAT, out.data(), pixel, line);
  // Some readers say true and leave a message: a cut TIFF would be black from there on.
  if (!read || input.has_error()) throw InputError(first_line(input.geterror(), "it ends too early"));
}

// What is read, where it is in memory, and its reader.
struct Input {
  OIIO::Filesystem::IOMemReader memory;
  std::unique_ptr<OIIO::ImageInput> reader;

  Input(std::span<const char> bytes, const std::string& format)
      : memory(const_cast<char*>(bytes.data()), bytes.size()), reader(OIIO::ImageInput::create(format)) {}
};

// An ICC profile says in bytes 16 to 19 what its values are (ICC.1, section 7.2.6).
bool is_of_inks(const std::string& profile) { return profile.size() > 20 && profile.compare(16, 4, "CMYK") == 0; }

// Of inks, OpenImageIO makes RGB by a rule of thumb, which knows no profile, unless it is asked for the inks.
void reopen_raw(Input& in, const std::string& path, OIIO::ImageSpec config, ImageFacts& facts) {
  OIIO::ImageSpec spec;
  config.attribute("oiio:RawColor", 1);
  in.reader->close();
  if (!in.reader->open(path, spec, config)) throw InputError(first_line(in.reader->geterror(), "no image"));
  if (spec.nchannels < 4) return;
  facts = facts_of(spec, *in.reader);
  facts.inks = std::string(in.reader->format_name()) == "psd" ? ImageFacts::Inks::inverted : ImageFacts::Inks::there;
}

ImageReader open(const std::string& format, const std::string& path, std::span<const char> bytes, bool straight_alpha,
                 bool crop) {
  use_our_threads();
  const SilentLibraries silent(true);
  const auto in = std::make_shared<Input>(bytes, format);
  OIIO::ImageSpec spec, config;
  void* proxy = &in->memory;
  if (!bytes.empty()) config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  if (straight_alpha) config.attribute("oiio:UnassociatedAlpha", 1);
  if (!in->reader || !in->reader->open(path, spec, config))
    throw InputError(first_line(in->reader ? in->reader->geterror() : OIIO::geterror(), "no image format reads it"));
  ImageReader reader{.format = in->reader->format_name(),
                     .facts = facts_of(spec, *in->reader),
                     .level = [in](int level) -> std::optional<ImageFacts> {
                       if (in->reader->seek_subimage(0, level))
                         return facts_of(in->reader->spec(0, level), *in->reader);
                       (void)in->reader->geterror();
                       return std::nullopt;
                     },
                     .read =
                         [in](int level, int begin, int end, int first, int count, std::span<float> out) {
                           read_rows(*in->reader, level, begin, end, first, count, out);
                         }};
  if (is_of_inks(reader.facts.icc_profile)) reopen_raw(*in, path, config, reader.facts);
  // The window of a cube in a DDS file is that of its first face.
  const bool is_cube = spec.find_attribute("dds:CubeMapSides") != nullptr;
  if (is_cube || (spec.full_width == spec.width && spec.full_height == spec.height && spec.full_x == spec.x &&
                  spec.full_y == spec.y))
    return reader;
  reader.facts.notes.push_back(std::string("its data window is not its display window: ") +
                               (crop ? "the data window is read as the whole image" : "what is missing is black"));
  if (crop) return reader;
  return in_window(std::move(reader), {std::int64_t{spec.x} - spec.full_x, std::int64_t{spec.y} - spec.full_y,
                                       spec.full_width, spec.full_height});
}

// ---- writing --------------------------------------------------------------------------------------------------------

OIIO::TypeDesc type(Depth d) {
  return d == Depth::uint8    ? OIIO::TypeDesc::UINT8
         : d == Depth::uint16 ? OIIO::TypeDesc::UINT16
                              : OIIO::TypeDesc::FLOAT;
}

// Around calls of writers: libjpeg ends the program itself where it cannot go on, with 1,
// which means something else here.
class Writing {
 public:
  Writing() {
    static const int registered = std::atexit([] {
      if (calls_ > 0) ::_exit(4);
    });
    (void)registered;
    ++calls_;
  }
  ~Writing() { --calls_; }
  Writing(const Writing&) = delete;

 private:
  static inline std::atomic<int> calls_{0};
};

struct Output {
  OpenImageIoFile file;
  std::unique_ptr<OIIO::ImageOutput> writer;

  Output(OutputFile& f, const std::string& name) : file(f), writer(OIIO::ImageOutput::create(name)) {}
};

ImageWriter create(OutputFile& file, const std::string& extension, const ImagePlan& plan) {
  use_our_threads();
  const std::string name = "x." + extension;
  const auto out = std::make_shared<Output>(file, name);
  if (!out->writer) throw OutputError("no writer for ." + extension);
  OIIO::ImageSpec spec(plan.levels[0].width, plan.levels[0].height, 3, type(plan.depth));
  spec.attribute("DateTime", "");  // OpenImageIO would write the time of day.
  const std::string profile = plan.icc_profile.value_or("");
  if (!profile.empty())
    spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, int(profile.size())), profile.data());
  // Not in TIFF: it would go into an EXIF directory, and OpenImageIO 2.4 leaves the file's header pointing at that.
  // Where there is a profile that says it, a name that is no space: OpenImageIO 3.1 takes none for sRGB.
  if (out->writer->format_name() != std::string("tiff"))
    spec.attribute("oiio:ColorSpace", plan.icc_profile ? "unknown" : is_integer(plan.depth) ? "sRGB" : "Linear");
  // From 2.5 on, OpenImageIO turns blocks of float rows upside down in any PNM file. Only PFM needs that (pfm.cpp).
  if (out->writer->format_name() == std::string("pnm")) spec.attribute("pnm:pfmflip", 0);
  for (const auto& [key, text] : plan.attributes) spec.attribute(key, text);
  void* proxy = &out->file;
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const auto check = [out](bool done) {
    if (!done) throw OutputError(out->writer->geterror());
  };
  const Writing writing;
  constexpr int longest_of_jpeg = 65500;
  if (out->writer->format_name() == std::string("jpeg") && std::max(spec.width, spec.height) > longest_of_jpeg)
    throw OutputError(
        fmt::format("JPEG holds {} texels a side at most, not {}x{}", longest_of_jpeg, spec.width, spec.height));
  check(out->writer->open(name, spec));
  return {.write =
              [out, check](int, int begin, int end, std::span<const Colour> rows) {
                const Writing now;
                check(out->writer->write_scanlines(begin, end, 0, OIIO::TypeDesc::FLOAT, rows.data()));
              },
          .close =
              [out, check] {
                const Writing now;
                check(out->writer->close());
              }};
}

}  // namespace
}  // namespace envmap

extern "C" const envmap::Formats envmap_formats{envmap::open, envmap::create};
