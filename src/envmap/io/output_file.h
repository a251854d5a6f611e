/// @file
/// Files that appear whole or not at all.
#pragma once

#include <OpenImageIO/filesystem.h>

#include <string>

namespace envmap {

/// Bytes on their way to a file. They go to a temporary file in the same folder; commit() renames it over the target.
/// Without commit(), or where a write failed, nothing is left. Standard output, devices and pipes take the bytes at
/// commit(). An interrupted program removes its temporary files, too.
class OutputFile final : public OIIO::Filesystem::IOProxy {
 public:
  /// @param path `-` for standard output. @throws OutputError where the folder cannot be written.
  explicit OutputFile(const std::string& path);
  ~OutputFile() override;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Makes the file appear. @throws OutputError if this or any write before it failed (a full disk).
  void commit();

  const char* proxytype() const override { return "envmap"; }
  void close() override {}
  bool opened() const override { return true; }
  int64_t tell() override { return m_pos; }
  bool seek(int64_t offset) override;
  size_t read(void* buffer, size_t size) override;
  size_t write(const void* buffer, size_t size) override;
  size_t pread(void* buffer, size_t size, int64_t offset) override;
  size_t pwrite(const void* buffer, size_t size, int64_t offset) override;
  size_t size() const override { return static_cast<size_t>(end_); }

 private:
  void copy_to_stream();

  std::string path_, target_, temporary_;
  int descriptor_ = -1;
  int64_t end_ = 0;
  int error_ = 0;  // errno of the first write that failed.
  bool stream_ = false;
};

}  // namespace envmap
