/// @file
/// What must not be left behind where a signal ends the program.
#pragma once

namespace envmap {

/// Registers a file or empty folder to delete when a signal ends the program (files first). Signals that are ignored or
/// have a handler are left alone. @param name must stay valid until keep_on_signal(). At most 256 at a time.
void remove_on_signal(const char* name);
/// Undoes remove_on_signal().
void keep_on_signal(const char* name);

}  // namespace envmap
