/// @file
/// Where the running program lies.
#pragma once

#include <filesystem>

namespace envmap {

/// The file of the running program, by which it finds what lies beside it. Empty where the system does not tell.
std::filesystem::path own_program();

}  // namespace envmap
