/// @file
/// The calls that Linux has and POSIX has not, in one place. Where a system lacks a call, its answer says so, and the
/// caller goes another way: the same files are written, later or with one left behind by a crash.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace envmap {

/// The file of the running program, by which it finds what lies beside it. Empty where the system does not tell.
std::filesystem::path own_program();

/// A file in a folder that has no name yet, so that nothing is left of it however the program ends.
/// @return its descriptor; -1 where the file system has none of those.
int open_nameless(const std::string& folder);
/// Gives it a name that nothing has. @return whether it did; else errno says why.
bool name_nameless(int descriptor, const std::string& name);

/// A file in memory. @return its descriptor; -1, and errno.
int open_in_memory();

/// Renames so that there is something of that name at any time.
/// @param exchange whether `to` is there, and gets the name `from`; else it must not be there.
/// @return whether it did; else errno: ENOSYS where the system cannot do it, EINVAL where the file system cannot.
bool rename_at_once(const std::string& from, const std::string& to, bool exchange);

enum class Lock { taken, busy, unknown };  ///< Busy: another process has one. Unknown: the file system has no locks.
/// Locks an open folder until its descriptor is closed, or the process ends.
/// @param alone whether nobody else may have a lock on it.
Lock lock_folder(int descriptor, bool alone);

/// Takes room on the disk for an open file. @return 0 or an error of errno.
int take_room(int descriptor, std::uint64_t bytes);
/// Whether the disk of an open file surely has fewer free bytes. False where the disk compresses, or does not tell.
bool lacks_room(int descriptor, std::uint64_t bytes);

/// Bytes of memory that the process has; 0 where the system does not tell.
std::size_t resident_bytes();
/// Gives pages of a mapped file back to it: they are read again when they are next wanted.
void forget_pages(void* data, std::size_t bytes);
/// Asks for pages of 2 MiB where whole ones lie in a block that nothing was written to yet: a fault for each page of
/// 4 KiB takes a tenth of the time of reading a map.
void ask_for_large_pages(void* data, std::size_t bytes);

}  // namespace envmap
