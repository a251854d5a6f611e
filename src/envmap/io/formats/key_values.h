/// @file
/// The key/value pairs of KTX and KTX2 files, whose layout is the same: KTX 1.0, section 2.12; KTX2, section 3.11.2.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>

#include "envmap/io/metadata.h"

namespace envmap {

using KeyValues = std::map<std::string, std::string>;

/// What a writer says of a map: pairs envmap:NAME of its facts, and those of the caller.
KeyValues key_values(const Metadata& data, const KeyValues& more);

/// As bytes, in the order of the keys' code points: values end in NUL, pairs are padded to 4 bytes.
std::string key_value_bytes(const KeyValues& pairs);

/// @throws InputError, without the name of the file, where a pair reaches beyond the bytes.
KeyValues parse_key_values(std::span<const std::byte> bytes);

/// Of pairs envmap:NAME; values that are no words are passed over.
Metadata recorded(const KeyValues& pairs);

}  // namespace envmap
