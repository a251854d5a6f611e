/// @file
/// What must not be left behind where a signal ends the program.
#pragma once

namespace envmap {

/// A file or an empty folder that signals which end the program remove before: files before folders. Not those that are
/// ignored or that the program handles itself. @param name must stay as it is until keep_on_signal().
/// No more than 256 at a time.
void remove_on_signal(const char* name);
/// No longer.
void keep_on_signal(const char* name);

}  // namespace envmap
