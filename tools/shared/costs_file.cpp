#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "shared/maps.h"

namespace tools {
namespace {

using namespace envmap;

constexpr std::size_t longest = 1 << 16;
constexpr double most = 1e12;

}  // namespace

Costs read_costs(const std::string& path) {
  if (path.empty()) return {};
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path, "not found, or not to be read");
  std::string text(longest + 1, '\0');
  file.read(text.data(), std::streamsize(text.size()));
  text.resize(std::size_t(file.gcount()));
  const auto json = text.size() > longest ? nlohmann::json() : nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("nanoseconds") || !json["nanoseconds"].is_object())
    throw InputError(path, "is no file of 'envmap tradeoff --calibrate --save'");
  const auto& figures = json["nanoseconds"];
  for (const auto& [name, value] : figures.items())
    if (std::ranges::find(cost_facts(), name, &CostFact::name) == cost_facts().end())
      throw InputError(path, fmt::format("'{}' is not a known timing: run 'envmap tradeoff --calibrate' again",
                                         printable(name.substr(0, 40))));
  Costs costs;
  for (std::size_t k = 0; k < cost_count; ++k) {
    const std::string name(cost_facts()[k].name);
    if (!figures.contains(name)) throw InputError(path, fmt::format("has no figure '{}'; calibrate anew", name));
    if (!figures[name].is_number()) throw InputError(path, fmt::format("'{}' must be a number", name));
    costs.nanoseconds[k] = figures[name].get<double>();
    if (!(costs.nanoseconds[k] > 0 && costs.nanoseconds[k] <= most))
      throw InputError(path, fmt::format("'{}' is not above 0 and up to 1e12", name));
  }
  settings().also_read.push_back(path);
  return costs;
}

std::string text_of(const Costs& costs) {
  nlohmann::ordered_json json{{"version", 1}};
  for (std::size_t k = 0; k < cost_count; ++k)
    json["nanoseconds"][std::string(cost_facts()[k].name)] = costs.nanoseconds[k];
  return json.dump(1) + "\n";
}

}  // namespace tools
