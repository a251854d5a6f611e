// TIFF by libtiff: what tags state of colours, and reading row by row.
#include "envmap/io/formats/tiff.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/claims/exif.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/io/images/image_reader.h"
#include "envmap/io/texels/texels.h"
#include "envmap/maths/vector.h"

namespace envmap {

// What the tags of a TIFF say of its colours. Sources: TIFF 6.0, section 20 ("RGB Image Colorimetry"); TIFF
// Technical Note "Adobe Photoshop TIFF", tag 34675; Larson, "LogLuv encoding for full-gamut, high-dynamic range
// images" (1998).

// What tags state of the colours.

namespace {

unsigned word(TIFF* tiff, unsigned tag) {
  std::uint16_t value = 0;
  TIFFGetFieldDefaulted(tiff, tag, &value);
  return value;
}

bool is_log(unsigned photometric) { return photometric == PHOTOMETRIC_LOGL || photometric == PHOTOMETRIC_LOGLUV; }

// ---- what is not read -----------------------------------------------------------------------------------------------

struct Unsupported {
  unsigned photometric;
  const char* name;
};

// Of PhotometricInterpretation. libtiff has no name for LinearRaw of DNG.
constexpr Unsupported unsupported[] = {{PHOTOMETRIC_MASK, "a transparency mask"}, {PHOTOMETRIC_CIELAB, "CIE L*a*b*"},
                                       {PHOTOMETRIC_ICCLAB, "ICC L*a*b*"},        {PHOTOMETRIC_ITULAB, "ITU L*a*b*"},
                                       {PHOTOMETRIC_CFA, "raw camera data"},      {34892, "raw camera data"}};

void check_photometric(unsigned photometric) {
  for (const Unsupported& row : unsupported)
    if (row.photometric == photometric)
      throw InputError(fmt::format("not supported: TIFF of {} (PhotometricInterpretation {})", row.name, photometric));
  constexpr unsigned known[] = {PHOTOMETRIC_MINISWHITE, PHOTOMETRIC_MINISBLACK, PHOTOMETRIC_RGB,  PHOTOMETRIC_PALETTE,
                                PHOTOMETRIC_SEPARATED,  PHOTOMETRIC_YCBCR,      PHOTOMETRIC_LOGL, PHOTOMETRIC_LOGLUV};
  if (std::ranges::find(known, photometric) == std::end(known))
    throw InputError(fmt::format("not supported: TIFF of PhotometricInterpretation {}", photometric));
}

// Refuses samples that libtiff or OpenImageIO reads as something else: as a preview of 8 bits, as zeros, not inverted.
void check_samples(TIFF* tiff, unsigned photometric) {
  const unsigned bits = word(tiff, TIFFTAG_BITSPERSAMPLE), samples = word(tiff, TIFFTAG_SAMPLESPERPIXEL);
  const bool floats = word(tiff, TIFFTAG_SAMPLEFORMAT) == SAMPLEFORMAT_IEEEFP, tiles = TIFFIsTiled(tiff) != 0;
  const auto refuse = [](bool when, const std::string& what) {
    if (when) throw InputError(fmt::format("not supported: TIFF of {}", what));
  };
  refuse(floats && bits != 16 && bits != 32 && bits != 64, fmt::format("floats of {} bits", bits));
  refuse(floats && bits == 64 && tiles, "64-bit floats in tiles: write it in strips");
  refuse(is_log(photometric) && tiles, "LogLuv in tiles: write it in strips");
  refuse(photometric == PHOTOMETRIC_SEPARATED && tiles, "CMYK in tiles: write it in strips");
  refuse(photometric == PHOTOMETRIC_SEPARATED && samples != 4, fmt::format("CMYK with {} samples", samples));
  refuse(photometric == PHOTOMETRIC_MINISWHITE && (floats || (bits > 8 && bits != 32)),
         fmt::format("white as 0 (MinIsWhite) in {} bits", bits));
  refuse(word(tiff, TIFFTAG_COMPRESSION) == COMPRESSION_PIXARLOG, "PixarLog compression");
  std::uint32_t kind = 0;
  refuse(TIFFGetField(tiff, TIFFTAG_SUBFILETYPE, &kind) == 1 && (kind & FILETYPE_REDUCEDIMAGE) != 0,
         "a reduced picture (NewSubfileType 1) before the whole one");
}

void check_inks(TIFF* tiff) {
  if (word(tiff, TIFFTAG_INKSET) != INKSET_CMYK)
    throw InputError(
        fmt::format("not supported: TIFF of inks other than CMYK (InkSet {})", word(tiff, TIFFTAG_INKSET)));
}

void check_sample_format(TIFF* tiff) {
  const unsigned format = word(tiff, TIFFTAG_SAMPLEFORMAT);
  const char* name = format == SAMPLEFORMAT_INT             ? "signed integers"
                     : format == SAMPLEFORMAT_COMPLEXINT    ? "complex integers"
                     : format == SAMPLEFORMAT_COMPLEXIEEEFP ? "complex numbers"
                                                            : nullptr;
  if (name) throw InputError(fmt::format("not supported: TIFF of {} (SampleFormat {})", name, format));
}

// ---- the tags of section 20 -----------------------------------------------------------------------------------------

void tell(ImageFacts& facts, const char* name, const std::string& value, const char* ignored_because = nullptr) {
  facts.claims.push_back({.name = name,
                          .value = value,
                          .outcome = ignored_because ? Claim::Outcome::ignored : Claim::Outcome::honoured,
                          .reason = ignored_because ? ignored_because : "",
                          .of_colour = true});
}

struct Colorimetry {
  std::optional<Point2> white = {};
  std::optional<std::array<Point2, 3>> primaries = {};
  std::vector<std::vector<double>> curves = {};  // One of grey, three of RGB.

  explicit Colorimetry(TIFF* tiff) {
    const float *xy = nullptr, *six = nullptr;
    if (TIFFGetField(tiff, TIFFTAG_WHITEPOINT, &xy) == 1) white = Point2(xy[0], xy[1]);
    if (TIFFGetField(tiff, TIFFTAG_PRIMARYCHROMATICITIES, &six) == 1)
      primaries = {Point2(six[0], six[1]), Point2(six[2], six[3]), Point2(six[4], six[5])};
    std::array<const std::uint16_t*, 3> tables = {};
    if (TIFFGetField(tiff, TIFFTAG_TRANSFERFUNCTION, &tables[0], &tables[1], &tables[2]) != 1) return;
    for (const std::uint16_t* table : tables)
      if (table) {
        curves.emplace_back();
        for (std::size_t k = 0; k < std::size_t{1} << word(tiff, TIFFTAG_BITSPERSAMPLE); ++k)
          curves.back().push_back(table[k] / 65535.0);
      }
  }

  [[nodiscard]] bool is_there() const { return white || primaries || !curves.empty(); }
  void tell(ImageFacts& facts, const char* ignored_because = nullptr) const {
    if (white) envmap::tell(facts, "WhitePoint", fmt::format("{:g} {:g}", white->x, white->y), ignored_because);
    if (primaries) {
      const auto& [r, g, b] = *primaries;
      envmap::tell(facts, "PrimaryChromaticities",
                   fmt::format("{:g} {:g} {:g} {:g} {:g} {:g}", r.x, r.y, g.x, g.y, b.x, b.y), ignored_because);
    }
    if (!curves.empty())
      envmap::tell(facts, "TransferFunction", fmt::format("{} entries", curves[0].size()), ignored_because);
  }
};

// Stored integers are looked up in a table with an entry for each.
std::function<void(std::span<Colour>)> decoder(std::vector<std::vector<double>> curves) {
  if (curves.size() == 1) curves.resize(3, curves[0]);
  return [curves = std::move(curves)](std::span<Colour> colours) {
    for (Colour& c : colours)
      for (int k = 0; k < 3; ++k) {
        const auto& curve = curves[std::size_t(k)];
        const double entry =
            std::clamp(std::round(double{c[k]} * double(curve.size() - 1)), 0.0, double(curve.size() - 1));
        c[k] = float(curve[std::size_t(entry)]);
      }
  };
}

void honour(const Colorimetry& said, ImageFacts& facts) {
  Primaries p = rec709;
  if (said.primaries) p.red = (*said.primaries)[0], p.green = (*said.primaries)[1], p.blue = (*said.primaries)[2];
  if (said.white) p.white = *said.white;
  if (!is_possible(p))
    throw InputError("damaged: no light has the colours of its tags WhitePoint and PrimaryChromaticities",
                     Remedy::choose_space);
  if (!said.curves.empty() && !is_integer(facts.depth))
    throw InputError("not supported: TransferFunction of floating-point samples", Remedy::choose_space);
  said.tell(facts);
  StatedColour stated{.space = {space_with(p), p, "its tags", true}};
  if (!said.curves.empty()) {
    stated.space.name =
        fmt::format("TransferFunction of {}", stated.space.name.empty() ? "its primaries" : stated.space.name);
    stated.decode = decoder(said.curves);
  } else if (facts.encoded) {
    stated.space.name = encoded_space_with(p);
    stated.decode = decode_srgb;
  }
  facts.colour = stated;
}

// ---- LogLuv ---------------------------------------------------------------------------------------------------------

// CIE XYZ of the picture itself: without a white of its own it is looked at under the map's.
void honour_log(TIFF* tiff, const Colorimetry& said, ImageFacts& facts) {
  const bool grey = word(tiff, TIFFTAG_PHOTOMETRIC) == PHOTOMETRIC_LOGL;
  const bool in_24_bits = word(tiff, TIFFTAG_COMPRESSION) == COMPRESSION_SGILOG24;
  StatedColour stated{.space = {"XYZ", cie_xyz, grey ? "LogL" : "LogLuv", true}};
  if (grey) stated.space = {space_with(rec709), rec709, "LogL", true};
  tell(facts, "PhotometricInterpretation", grey ? "LogL" : in_24_bits ? "LogLuv of 24 bits" : "LogLuv of 32 bits");
  if (said.primaries) tell(facts, "PrimaryChromaticities", "of a display", "LogLuv has no primaries");
  if (said.white && !grey) {
    if (!is_possible({{0.64, 0.33}, {0.3, 0.6}, {0.15, 0.06}, *said.white}))
      throw InputError("damaged: a WhitePoint that no light has", Remedy::choose_space);
    tell(facts, "WhitePoint", fmt::format("{:g} {:g}", said.white->x, said.white->y));
    stated.decode = [m = adaptation(*said.white, rec709.white)](std::span<Colour> colours) {
      for (Colour& c : colours) c = Colour(m * Flux(c));
    };
  }
  double nits = 0;
  if (TIFFGetField(tiff, TIFFTAG_STONITS, &nits) == 1 && nits > 0) {
    tell(facts, "StoNits", fmt::format("{:g}", nits));
    stated.white_luminance = float(nits);
  }
  facts.colour = stated;
}

/// Has libtiff make floats of CIE XYZ, or of luminance, out of LogLuv and LogL: before anything else is asked.
void unpack_log_luv(TIFF* tiff) {
  if (is_log(word(tiff, TIFFTAG_PHOTOMETRIC))) TIFFSetField(tiff, TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_FLOAT);
}

/// Sets colours, the profile and the claims of an image. An ICC profile comes before the other tags.
/// @throws InputError without the file's name, which names what is not supported.
void read_tiff_colours(TIFF* tiff, ImageFacts& facts) {
  const unsigned photometric = word(tiff, TIFFTAG_PHOTOMETRIC);
  check_photometric(photometric);
  check_sample_format(tiff);
  check_samples(tiff, photometric);
  if (photometric == PHOTOMETRIC_SEPARATED) check_inks(tiff);
  const Colorimetry said(tiff);
  if (is_log(photometric)) return honour_log(tiff, said, facts);
  std::uint32_t size = 0;
  const char* profile = nullptr;
  if (TIFFGetField(tiff, TIFFTAG_ICCPROFILE, &size, &profile) == 1 && size > 0) {
    facts.icc_profile.assign(profile, size);
    return said.tell(facts, "the ICC profile comes first");
  }
  if (said.is_there()) honour(said, facts);
}

}  // namespace

// Reading.

namespace {

// Files as libtiff opens them. Its functions return errors and leave a message.
class TiffFile {
 public:
  explicit TiffFile(const InputFile& file) : file_(file) {
    const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                   TIFFOpenOptionsFree);
    if (!options) throw std::bad_alloc();
    constexpr tmsize_t largest_block = 1 << 28;  // Tags and rows are smaller.
    TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), largest_block);
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_message, this);
    TIFFOpenOptionsSetWarningHandlerExtR(
        options.get(), [](TIFF*, void*, const char*, const char*, va_list) { return 1; }, nullptr);
    const auto none = [](thandle_t, void*, tmsize_t) -> tmsize_t { return 0; };
    tiff_ = TIFFClientOpenExt(
        "TIFF", "rm", this, get, none, seek, [](thandle_t) { return 0; }, size, nullptr, nullptr, options.get());
    if (!tiff_) fail();
    unpack_log_luv(tiff_);
  }
  ~TiffFile() { TIFFClose(tiff_); }
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;

  [[nodiscard]] TIFF* tiff() const { return tiff_; }
  [[noreturn]] void fail() const { throw InputError(cut_ ? "it ends too early" : message_.data()); }

 private:
  static TiffFile& of(thandle_t self) { return *static_cast<TiffFile*>(self); }
  static int keep_message(TIFF*, void* self, const char*, const char* format, va_list arguments) {
    auto& message = of(self).message_;
    if (!message[0]) std::vsnprintf(message.data(), message.size(), format, arguments);
    return 1;
  }
  static tmsize_t get(thandle_t self, void* bytes, tmsize_t size) {
    TiffFile& f = of(self);
    const std::size_t done = f.file_.pread(bytes, std::size_t(size), f.next_);
    f.next_ += done;
    f.cut_ |= done < std::size_t(size);
    return tmsize_t(done);
  }
  static toff_t seek(thandle_t self, toff_t offset, int whence) {
    TiffFile& f = of(self);
    return f.next_ = offset + (whence == SEEK_CUR ? f.next_ : whence == SEEK_END ? f.file_.size() : 0);
  }
  static toff_t size(thandle_t self) { return of(self).file_.size(); }

  const InputFile& file_;
  TIFF* tiff_ = nullptr;
  std::uint64_t next_ = 0;
  bool cut_ = false;  // Bytes were asked for that are not there.
  std::array<char, 200> message_ = {};
};

// A tag's number, or its default.
template <class Number>
Number number(TIFF* tiff, unsigned tag) {
  Number value = 0;
  TIFFGetFieldDefaulted(tiff, tag, &value);
  return value;
}

bool has(TIFF* tiff, unsigned tag) {
  std::array<std::uint64_t, 8> any = {};  // Its value, or a count and a pointer.
  return TIFFGetField(tiff, tag, &any[0], &any[1], &any[2]) == 1;
}

// What of an image is read here.
struct Header {
  std::uint32_t width, height;
  std::uint32_t rows_per_strip;
  int samples, bits, format, photometric, compression, planes;

  explicit Header(TIFF* t)
      : width(number<std::uint32_t>(t, TIFFTAG_IMAGEWIDTH)),
        height(number<std::uint32_t>(t, TIFFTAG_IMAGELENGTH)),
        rows_per_strip(number<std::uint32_t>(t, TIFFTAG_ROWSPERSTRIP)),
        samples(number<std::uint16_t>(t, TIFFTAG_SAMPLESPERPIXEL)),
        bits(number<std::uint16_t>(t, TIFFTAG_BITSPERSAMPLE)),
        format(number<std::uint16_t>(t, TIFFTAG_SAMPLEFORMAT)),
        photometric(number<std::uint16_t>(t, TIFFTAG_PHOTOMETRIC)),
        compression(number<std::uint16_t>(t, TIFFTAG_COMPRESSION)),
        planes(number<std::uint16_t>(t, TIFFTAG_PLANARCONFIG)) {}

  [[nodiscard]] bool is_floating() const { return format == SAMPLEFORMAT_IEEEFP; }
  [[nodiscard]] Depth depth() const {
    if (is_floating()) return bits == 16 ? Depth::half : Depth::single;
    return bits == 16 ? Depth::uint16 : Depth::uint8;
  }
  [[nodiscard]] bool is_log() const { return photometric == PHOTOMETRIC_LOGLUV || photometric == PHOTOMETRIC_LOGL; }
  [[nodiscard]] bool has_planes() const { return planes != PLANARCONFIG_CONTIG && samples > 1; }
  // Samples of a texel that lie side by side.
  [[nodiscard]] std::size_t together() const { return has_planes() ? 1 : std::size_t(samples); }
  [[nodiscard]] std::size_t row_bytes() const { return std::size_t(width) * together() * std::size_t(bits) / 8; }
};

bool has_usual_samples(TIFF* tiff, const Header& h) {
  std::uint16_t extra = 0;
  const std::uint16_t* kinds = nullptr;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_EXTRASAMPLES, &extra, &kinds);
  const bool grey = h.photometric == PHOTOMETRIC_MINISBLACK && h.samples == 1 && extra == 0;
  const bool rgb = h.photometric == PHOTOMETRIC_RGB && h.samples == 3 && extra == 0;
  const bool rgba =
      h.photometric == PHOTOMETRIC_RGB && h.samples == 4 && extra == 1 && kinds[0] == EXTRASAMPLE_ASSOCALPHA;
  const bool integers = h.format == SAMPLEFORMAT_UINT && (h.bits == 8 || h.bits == 16);
  return (grey || rgb || rgba || h.is_log()) &&
         (integers || (h.is_floating() && (h.bits == 16 || h.bits == 32 || h.bits == 64)));
}

bool is_for_openimageio(TIFF* tiff, const Header& h) {
  constexpr double large = 1 << 24;  // Bytes.
  constexpr int lossless[] = {COMPRESSION_LZW, COMPRESSION_DEFLATE, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS};
  if (!has_usual_samples(tiff, h) || TIFFIsTiled(tiff) || TIFFScanlineSize64(tiff) != h.row_bytes()) return true;
  // OpenImageIO reads planes, and cannot go back in them where they are compressed.
  if (h.has_planes() && h.compression == COMPRESSION_NONE && h.bits < 64) return true;
  if (!h.is_log() && !h.has_planes() && h.compression != COMPRESSION_NONE &&
      (std::ranges::find(lossless, h.compression) == std::end(lossless) || double(h.row_bytes()) * h.height > large))
    return true;
  for (const unsigned tag : {TIFFTAG_XPOSITION, TIFFTAG_YPOSITION, TIFFTAG_IMAGEDEPTH, TIFFTAG_PIXAR_IMAGEFULLWIDTH,
                             TIFFTAG_PIXAR_TEXTUREFORMAT, TIFFTAG_RICHTIFFIPTC})
    if (has(tiff, tag)) return true;
  std::uint32_t size = 0;
  const char* xmp = nullptr;
  return TIFFGetField(tiff, TIFFTAG_XMLPACKET, &size, &xmp) == 1 && tells_facts({xmp, size});
}

void add_text(TIFF* tiff, unsigned tag, const char* name, Attributes& attributes) {
  const char* text = nullptr;
  if (TIFFGetField(tiff, tag, &text) == 1) attributes.emplace(name, text);
}

ImageFacts facts_of(TIFF* tiff, const Header& h) {
  constexpr const char* names[] = {"R", "G", "B", "A"};
  ImageFacts f{.width = int(std::min(h.width, std::uint32_t{INT32_MAX})),
               .height = int(std::min(h.height, std::uint32_t{INT32_MAX})),
               .encoded = !h.is_floating(),
               .names = false,
               .depth = h.depth()};
  f.channels.assign(names, names + std::min(h.samples, 4));
  if (h.samples == 1) f.channels = {"Y"};
  add_text(tiff, TIFFTAG_IMAGEDESCRIPTION, description, f.attributes);
  add_text(tiff, TIFFTAG_COPYRIGHT, copyright, f.attributes);
  const int way = number<std::uint16_t>(tiff, TIFFTAG_ORIENTATION);
  if (way >= 1 && way <= 8) f.orientation = static_cast<Orientation>(way);
  read_tiff_colours(tiff, f);
  return f;
}

// OpenImageIO takes words out of a description that it writes itself.
bool has_words_of_openimageio(const ImageFacts& facts) {
  const auto found = facts.attributes.find(description);
  if (found == facts.attributes.end()) return false;
  return found->second.find("oiio:") != std::string::npos || found->second.find("SHA-1=") != std::string::npos;
}

// Samples of a row as floats.
void set_floats(std::span<const unsigned char> row, const Header& header, std::span<float> samples) {
  const Depth depth = header.depth();
  if (header.bits == 64) {
    std::vector<double> doubles(samples.size());
    std::memcpy(doubles.data(), row.data(), row.size());
    std::ranges::transform(doubles, samples.begin(), [](double v) { return float(v); });
    return;
  }
  std::vector<std::uint16_t> words(depth == Depth::half || depth == Depth::uint16 ? samples.size() : 0);
  if (!words.empty()) std::memcpy(words.data(), row.data(), row.size());
  if (depth == Depth::single) std::memcpy(samples.data(), row.data(), row.size());
  if (depth == Depth::half) from_half(words, samples);
  constexpr float of_16 = 1.0F / 65535, of_8 = 1.0F / 255;
  if (depth == Depth::uint16) std::ranges::transform(words, samples.begin(), [](auto v) { return float(v) * of_16; });
  if (depth == Depth::uint8) std::ranges::transform(row, samples.begin(), [](auto v) { return float(v) * of_8; });
}

class Reader {
 public:
  explicit Reader(const InputFile& f) : file_(f) {}

  [[nodiscard]] TIFF* tiff() const { return file_.tiff(); }
  [[nodiscard]] const Header& header() const { return header_; }

  void read(int begin, int end, int first, int count, float* to) {
    if (header_.has_planes()) return read_planes(begin, end, first, count, to);
    // Codecs pass over no rows: those of a strip are read from its beginning on, which libtiff itself goes back to.
    const auto start = int(begin - begin % rows_of_strip());
    std::vector<unsigned char> row(header_.row_bytes());
    std::vector<float> samples(std::size_t(header_.width) * std::size_t(header_.samples));
    for (int y = next_ < start || next_ > begin ? start : next_; y < end; next_ = ++y) {
      if (TIFFReadScanline(tiff(), row.data(), std::uint32_t(y), 0) != 1) file_.fail();
      if (y < begin) continue;
      set_floats(row, header_, samples);
      for (std::size_t k = std::size_t(first); k < samples.size(); k += std::size_t(header_.samples))
        to = std::copy_n(samples.data() + k, count, to);
    }
  }

 private:
  [[nodiscard]] std::int64_t rows_of_strip() const {
    return std::clamp<std::int64_t>(header_.rows_per_strip, 1, std::max(1U, header_.height));
  }

  // A strip of one plane after the other, each as a whole.
  void read_planes(int begin, int end, int first, int count, float* to) {
    const auto rows = rows_of_strip();
    std::vector<float> samples(header_.width);
    for (int channel = 0; channel < count; ++channel)
      for (int y = begin; y < end; ++y) {
        load_strip(TIFFComputeStrip(tiff(), std::uint32_t(y), std::uint16_t(first + channel)), y / rows * rows);
        const std::span row(strip_.data() + std::size_t(y % rows) * header_.row_bytes(), header_.row_bytes());
        set_floats(row, header_, samples);
        float* texel = to + std::size_t(y - begin) * header_.width * std::size_t(count) + channel;
        for (const float v : samples) *texel = v, texel += count;
      }
  }

  void load_strip(std::uint32_t number, std::int64_t first_row) {
    if (!strip_.empty() && number == loaded_) return;
    const auto rows = std::min<std::int64_t>(rows_of_strip(), std::int64_t{header_.height} - first_row);
    strip_.resize(std::size_t(rows) * header_.row_bytes());
    if (TIFFReadEncodedStrip(tiff(), number, strip_.data(), tmsize_t(strip_.size())) != tmsize_t(strip_.size()))
      strip_.clear(), file_.fail();
    loaded_ = number;
  }

  TiffFile file_;
  Header header_{file_.tiff()};
  int next_ = 0;  // Row that libtiff reads.
  std::uint32_t loaded_ = 0;
  std::vector<unsigned char> strip_ = {};
};

}  // namespace

std::optional<ImageReader> open_tiff(const InputFile& file, ImageFacts* found) {
  const auto reader = std::make_shared<Reader>(file);
  const ImageFacts facts = facts_of(reader->tiff(), reader->header());
  if (found) *found = facts;
  if (is_for_openimageio(reader->tiff(), reader->header()) || has_words_of_openimageio(facts)) return std::nullopt;
  return ImageReader{.format = "tiff",
                     .facts = facts,
                     .read = [reader](int, int begin, int end, int first, int count, std::span<float> out) {
                       reader->read(begin, end, first, count, out.data());
                     }};
}

}  // namespace envmap
