/// @file
/// NaN, infinite and negative radiance of a map that was read.
#pragma once

#include <string>

#include "envmap/io/read.h"

namespace envmap {

/// Refuses, repairs or keeps them, as the options say. @param name of the file. @throws InputError.
void settle_flaws(const std::string& name, const ReadOptions& options, Source& source);

}  // namespace envmap
