/// @file
/// The one header that depends on OpenImageIO's version.
#pragma once

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/oiioversion.h>

#include "envmap/io/output_file.h"

namespace envmap {

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

}  // namespace envmap
