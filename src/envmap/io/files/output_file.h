/// @file
/// Files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "envmap/io/files/commit.h"

namespace envmap {

/// Refuses to replace a file or folder without any write bit, unless `how` forces it. Root may write it, too, so the
/// bits decide.
/// @throws OutputError
void check_replaceable(const std::string& path, const CommitOptions& how);

/// @throws OutputError where the folder is missing that a file or folder of this name is to lie in.
void require_folder_of(const std::string& path);

/// Flushes a file or folder to disk. @return 0 or errno. Unreadable files and file systems without fsync count as
/// success.
int synchronise(const std::string& path);

/// $TMPDIR, or /tmp.
std::string temporary_folder();

/// Bytes on their way to a file. They go to a file without a name in the same folder (O_TMPFILE), which commit() names;
/// where the file system has no such files, to a temporary one, which commit() renames. Without commit(), or where a
/// write failed, nothing is left; nor where the program is interrupted, or killed where files without names are. What
/// is replaced keeps its mode bits, and its owner where the process may set that; what is read-only is not replaced.
/// Standard output, devices and pipes take the bytes at commit(), out of $TMPDIR.
class OutputFile {
 public:
  /// @param path `-` for standard output. @throws OutputError where the folder cannot be written.
  explicit OutputFile(const std::string& path, const CommitOptions& how = {});
  /// A file in memory, which is never committed. @throws OutputError where there is no memory for it.
  OutputFile();
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// @throws OutputError if a write failed, as commit() would.
  void check() const;
  /// Whether commit() copies the bytes to standard output, a device or a pipe.
  [[nodiscard]] bool is_stream() const { return stream_; }

  /// Makes the file appear. @throws OutputError if this or any write before it failed (a full disk).
  void commit();

  [[nodiscard]] std::int64_t tell() const { return at_; }
  void seek(std::int64_t offset) { at_ = offset; }
  /// Ends a job before it begins where the disk cannot hold its result. @param bytes that the file surely gets.
  /// @throws OutputError
  void expect(std::uint64_t bytes) const;
  /// write(), and check().
  void put(const void* buffer, std::size_t size);
  /// @return bytes written: fewer where it failed, which commit() then says.
  std::size_t write(const void* buffer, std::size_t size);
  std::size_t pread(void* buffer, std::size_t size, std::int64_t offset) const;
  [[nodiscard]] std::int64_t size() const { return end_; }
  /// All that was written. @throws OutputError as check().
  [[nodiscard]] std::vector<std::byte> bytes() const;

 private:
  void copy_to_stream();
  void take_name();
  [[nodiscard]] bool is_there_already() const;

  std::string path_, target_, temporary_;
  int descriptor_ = -1;
  std::int64_t at_ = 0, end_ = 0;
  int error_ = 0;  // errno of the first write that failed.
  bool stream_ = false;
  CommitOptions how_;
};

}  // namespace envmap
