/// @file
/// Whether a disk can hold a file.
#pragma once

#include <sys/vfs.h>

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace envmap {

/// @param descriptor an open file on the disk.
/// @param bytes that the file surely gets.
/// @return false where the disk has fewer free bytes; true where that is not known,
/// or where the file system compresses.
inline bool has_room(int descriptor, std::uint64_t bytes) {
  // Btrfs, ZFS, bcachefs, F2FS.
  constexpr std::uint32_t compressing[] = {0x9123683e, 0x2fc12fc1, 0xca451a4e, 0xf2f52010};
  struct statfs disk = {};
  if (::fstatfs(descriptor, &disk) != 0 || disk.f_blocks == 0) return true;
  if (std::find(std::begin(compressing), std::end(compressing), std::uint32_t(disk.f_type)) != std::end(compressing))
    return true;
  return bytes / std::uint64_t(disk.f_frsize > 0 ? disk.f_frsize : disk.f_bsize) <= disk.f_bavail;
}

}  // namespace envmap
