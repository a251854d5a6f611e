/// @file
/// A file's bytes, wherever they are wanted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace envmap {

class InputFile {
 public:
  /// @throws InputError without the name where it cannot be opened.
  explicit InputFile(const std::string& path);
  /// Bytes in memory: of standard input, or out of another file.
  explicit InputFile(std::vector<char> bytes);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Those in memory; empty for a file on disk.
  [[nodiscard]] std::span<const char> bytes() const { return bytes_; }
  /// Bytes [offset, offset + size), or fewer at the end. From any thread.
  std::size_t pread(void* buffer, std::size_t size, std::uint64_t offset) const;

 private:
  std::vector<char> bytes_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace envmap
