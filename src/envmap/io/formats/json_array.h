#pragma once

#include <initializer_list>
#include <string>

namespace envmap {

/// Numbers as a JSON array, each with the digits that give the same number back.
std::string json_array(std::initializer_list<double> numbers);

}  // namespace envmap
