/// @file
/// Our files as OpenEXR reads and writes them.
#pragma once

#include <Iex.h>
#include <ImfIO.h>
#include <ImfMultiPartInputFile.h>
#include <ImfThreading.h>

#include <string>

#if __has_include(<ImfContextInit.h>)
#include <ImfContextInit.h>
#endif

#include "envmap/base/parallel.h"
#include "envmap/io/input_file.h"
#include "envmap/io/output_file.h"

namespace envmap {

class ExrInput final : public Imf::IStream {
 public:
  explicit ExrInput(const InputFile& file) : IStream("exr"), file_(file) {}
  bool read(char* to, int size) override {
    const auto wanted = std::size_t(size);
    if (file_.pread(to, wanted, at_) != wanted) throw Iex::InputExc("it ends too early");
    at_ += wanted;
    return at_ < file_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t place) override { at_ = place; }

 private:
  const InputFile& file_;
  std::uint64_t at_ = 0;
};

/// All parts of a file. OpenEXR 3.3 and newer would also print the errors that they throw.
struct ExrParts final : Imf::MultiPartInputFile {
#if __has_include(<ImfContextInit.h>)
  explicit ExrParts(ExrInput& stream)
      : MultiPartInputFile("exr", Imf::ContextInitializer()
                                      .silentHeaderParse(true)
                                      .strictHeaderValidation(false)
                                      .setErrorHandler([](exr_const_context_t, exr_result_t, const char*){})
                                      .setInputStream(&stream)) {}
#else
  explicit ExrParts(ExrInput& stream) : MultiPartInputFile(stream) {}
#endif
};

class ExrOutput final : public Imf::OStream {
 public:
  explicit ExrOutput(OutputFile& file) : OStream("exr"), file_(file) {}
  void write(const char* from, int size) override {
    const auto wanted = std::size_t(size);
    if (file_.write(from, wanted) != wanted) throw Iex::IoExc("the disk is full or the file cannot be written");
  }
  std::uint64_t tellp() override { return std::uint64_t(file_.tell()); }
  void seekp(std::uint64_t place) override { file_.seek(std::int64_t(place)); }

 private:
  OutputFile& file_;
};

/// OpenEXR's helpers beside the caller, who works, too, where there are none.
inline void use_our_threads() {
  const int threads = thread_limit();
  Imf::setGlobalThreadCount(threads > 1 ? threads : 0);
}

/// Without what OpenEXR puts before it: `Error reading pixel data from image file "exr". `.
inline std::string plain(const std::string& message) {
  const auto quote = message.find("\"exr\". ");
  return quote == std::string::npos ? message : message.substr(quote + 7);
}

}  // namespace envmap
