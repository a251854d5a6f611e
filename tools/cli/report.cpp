#include "cli/report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/text.h"

namespace tools {
namespace {

using nlohmann::ordered_json;

void make_finite(ordered_json& value, const std::string& place, ordered_json& not_finite) {
  if (value.is_number_float()) {
    const double x = value.get<double>();
    if (std::isfinite(x)) return;
    not_finite[place] = std::isnan(x) ? "nan" : x > 0 ? "infinite" : "-infinite";
    value = nullptr;
  } else if (value.is_array()) {
    for (std::size_t k = 0; k < value.size(); ++k) make_finite(value[k], fmt::format("{}/{}", place, k), not_finite);
  } else if (value.is_object()) {
    for (auto& [key, member] : value.items()) make_finite(member, place + "/" + key, not_finite);
  }
}

// Of "levels[].flux": calls `step` with "levels", true and with "flux", false.
template <class Step>
void walk(std::string_view key, Step&& step) {
  while (!key.empty()) {
    const std::size_t dot = std::min(key.find('.'), key.size());
    const std::string_view name = key.substr(0, dot);
    const bool many = name.ends_with("[]");
    key.remove_prefix(std::min(dot + 1, key.size()));
    step(std::string(name.substr(0, name.size() - (many ? 2 : 0))), many, key.empty());
  }
}

ordered_json array_of(ordered_json items, int count = -1) {
  ordered_json array{{"type", "array"}, {"items", std::move(items)}};
  if (count >= 0) array["minItems"] = array["maxItems"] = count;
  return array;
}

ordered_json object() {
  return {{"type", "object"},
          {"properties", ordered_json::object()},
          {"required", ordered_json::array()},
          {"additionalProperties", false}};
}

// Any number may be one that is not finite, and then is null.
ordered_json schema_of_type(std::string_view type) {
  const ordered_json text{{"type", "string"}}, number{{"type", {"number", "null"}}},
      count{{"type", "integer"}, {"minimum", 0}};
  const std::pair<std::string_view, ordered_json> types[] = {
      {"text", text},
      {"texts", array_of(text)},
      {"words", {{"type", "object"}, {"additionalProperties", text}}},
      {"flaws",
       {{"type", "object"},
        {"minProperties", 1},
        {"additionalProperties", {{"enum", {"infinite", "-infinite", "nan"}}}}}},
      {"number", number},
      {"count", count},
      {"boolean", {{"type", "boolean"}}},
      {"triple", array_of(number, 3)},
      {"triples", array_of(array_of(number, 3))},
      {"texel", array_of(count, 2)},
      {"one", {{"const", 1}}},
      {"object", object()}};
  for (const auto& [name, schema] : types)
    if (name == type) return schema;
  throw std::logic_error(fmt::format("no type of a key: {}", type));
}

// A type, and after it " or null", or "?" for keys that may be absent.
void add(ordered_json& root, const Key& key) {
  ordered_json* holder = &root;
  walk(key.path, [&](const std::string& name, bool many, bool last) {
    ordered_json& properties = (*holder)["properties"];
    constexpr std::string_view or_null = " or null";
    std::string_view type = last ? std::string_view(key.type) : "object";
    const bool absent = type.ends_with('?'), null = type.ends_with(or_null);
    type.remove_suffix(absent ? 1 : null ? or_null.size() : 0);
    if (last || !properties.contains(name)) {
      ordered_json schema = schema_of_type(type);
      if (null) schema["type"] = {schema["type"], "null"};
      properties[name] = many ? array_of(std::move(schema)) : std::move(schema);
      if (!absent) (*holder)["required"].push_back(name);
      if (last) properties[name]["description"] = key.what;
    }
    holder = many ? &properties[name]["items"] : &properties[name];
  });
}

}  // namespace

struct Report::Json {
  ordered_json root;

  ordered_json& at(std::string_view key) {
    ordered_json* place = &root;
    walk(key,
         [&](const std::string& name, bool many, bool) { place = many ? &(*place)[name].back() : &(*place)[name]; });
    return *place;
  }
};

Report::Report() : json_(std::make_unique<Json>()) {}
Report::~Report() = default;

void Report::put(std::string_view key, const ReportValue& value) {
  ordered_json& place = json_->at(key);
  std::visit(
      [&](const auto& v) {
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, envmap::Direction>)
          place = {v.x, v.y, v.z};
        else
          place = v;
      },
      value.value);
}

void Report::append(std::string_view key) { json_->at(key.substr(0, key.size() - 2)).push_back(nullptr); }

void Report::append(std::string_view key, const ReportValue& value) {
  append(key);
  put(key, value);
}

void Report::put_array(std::string_view key) { json_->at(key) = ordered_json::array(); }

void Report::put_word(std::string_view key, const std::string& word, const std::string& text) {
  json_->at(key)[word] = text;
}

void Report::put_written(const std::string& path, const envmap::Written& written) { put_written("", path, written); }

void Report::put_written(std::string_view array, const std::string& path, const envmap::Written& written) {
  const std::string before = array.empty() ? "" : std::string(array) + ".";
  put(before + "output", path);
  put(before + "depth", name(written.depth));
  put(before + "clamped", written.clamped);
  put(before + "flux_lost", written.flux_lost);
}

void Report::put_seconds() { put("seconds", watch_.seconds()); }

bool Report::empty() const { return json_->root.empty(); }

std::string Report::text() const {
  ordered_json all{{"version", 1}}, not_finite = ordered_json::object();
  all.update(json_->root);
  make_finite(all, "", not_finite);
  if (!not_finite.empty()) all["not_finite"] = std::move(not_finite);
  constexpr bool only_ascii = true;
  return all.dump(2, ' ', only_ascii, ordered_json::error_handler_t::replace) + "\n";
}

std::string Report::line() const { return json_->root.dump(-1, ' ', false, ordered_json::error_handler_t::replace); }


std::string schema_of(std::string_view command) {
  ordered_json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                      {"title", fmt::format("envmap {} --json", command)}};
  schema.update(object());
  for (const Key& key : text_of(command).keys) add(schema, key);
  if (schema["properties"].contains("scene")) {  // Instead of all that is said of a map.
    schema["anyOf"] = {{{"required", schema["required"]}}, {{"required", {"version", "file", "scene"}}}};
    schema.erase("required");
  }
  return schema.dump(2) + "\n";
}

}  // namespace tools
