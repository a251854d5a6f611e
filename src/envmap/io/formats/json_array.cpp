#include "envmap/io/formats/json_array.h"

#include <nlohmann/json.hpp>

namespace envmap {

std::string json_array(std::initializer_list<double> numbers) { return nlohmann::ordered_json(numbers).dump(); }

}  // namespace envmap
