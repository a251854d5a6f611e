/// @file
/// A file's bytes, wherever they are wanted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace envmap {

class InputFile {
 public:
  /// A regular file stays on disk. Of pipes and devices the first bytes are there at once, and the rest after
  /// read_all(): what is junk need not be read to its end. @throws InputError without the name where it cannot be
  /// opened.
  explicit InputFile(const std::string& path);
  /// The same of what is left of an open file, standard input for one. @param descriptor stays open, and the caller's.
  explicit InputFile(int descriptor);
  /// Copies bytes in memory.
  explicit InputFile(std::span<const char> bytes);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Those in memory; empty for a file on disk.
  [[nodiscard]] std::span<const char> bytes() const { return {block_.get(), block_ ? size_ : 0}; }
  /// Bytes [offset, offset + size), or fewer at the end. From any thread.
  std::size_t pread(void* buffer, std::size_t size, std::uint64_t offset) const;

  /// Takes a stream to its end. @throws InputError, std::bad_alloc.
  void read_all();
  /// Takes all of a file on disk into memory, too. @throws as read_all().
  void hold();

 private:
  struct Free {
    void operator()(char* block) const { std::free(block); }
  };
  void start();
  void take(std::size_t most);

  std::unique_ptr<char, Free> block_;
  int descriptor_ = -1;
  bool stream_ = false;  // There may be more to read.
  std::uint64_t size_ = 0, start_ = 0, room_ = 0;
};

}  // namespace envmap
