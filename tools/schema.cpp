// JSON Schemas out of the keys that man pages list.
#include <fmt/format.h>

#include <stdexcept>

#include "command.h"

namespace tools {
namespace {

using nlohmann::ordered_json;

ordered_json array_of(ordered_json items, int count = -1) {
  ordered_json array{{"type", "array"}, {"items", std::move(items)}};
  if (count >= 0) array["minItems"] = array["maxItems"] = count;
  return array;
}

ordered_json object() {
  return {{"type", "object"}, {"properties", ordered_json::object()}, {"required", ordered_json::array()}, {"additionalProperties", false}};
}

// Any number may be one that is not finite, and then is null.
ordered_json schema_of_word(std::string_view word) {
  ordered_json text{{"type", "string"}}, number{{"type", {"number", "null"}}}, count{{"type", "integer"}, {"minimum", 0}};
  if (word == "text") return text;
  if (word == "texts") return array_of(text);
  if (word == "words") return {{"type", "object"}, {"additionalProperties", text}};
  if (word == "flaws") return {{"type", "object"}, {"minProperties", 1}, {"additionalProperties", {{"enum", {"infinite", "-infinite", "nan"}}}}};
  if (word == "number") return number;
  if (word == "count") return count;
  if (word == "boolean") return {{"type", "boolean"}};
  if (word == "triple") return array_of(number, 3);
  if (word == "triples") return array_of(array_of(number, 3));
  if (word == "texel") return array_of(count, 2);
  if (word == "one") return {{"const", 1}};
  if (word == "object") return object();
  throw std::logic_error(fmt::format("no type of a key: {}", word));
}

struct Type {
  ordered_json schema;
  bool may_be_absent = false;
};

// A word, and after it " or null", or "?" for keys that may be absent.
Type type_of(std::string_view text) {
  constexpr std::string_view or_null = " or null";
  const bool absent = text.ends_with('?'), null = text.ends_with(or_null);
  text.remove_suffix(absent ? 1 : null ? or_null.size() : 0);
  Type type{schema_of_word(text), absent};
  if (null) type.schema["type"] = {type.schema["type"], "null"};
  return type;
}

// Adds a key to the schema of the object that has it. Objects that no key of their own speaks of are always there.
void add(ordered_json& schema, std::string_view path, const Key& key) {
  const std::size_t dot = path.find('.');
  std::string_view name = path.substr(0, dot);
  const bool many = name.ends_with("[]");
  if (many) name.remove_suffix(2);
  ordered_json& properties = schema["properties"];
  const auto put = [&](Type type) {
    properties[name] = many ? array_of(std::move(type.schema)) : std::move(type.schema);
    if (!type.may_be_absent) schema["required"].push_back(name);
  };
  if (dot == path.npos) {
    put(type_of(key.type));
    properties[name]["description"] = key.what;
    return;
  }
  if (!properties.contains(name)) put({object()});
  ordered_json& holder = properties[name];
  add(many ? holder["items"] : holder, path.substr(dot + 1), key);
}

}  // namespace

std::vector<Key> all_keys(const Command& command) {
  std::vector<Key> keys{{"version", "one", "1; another where a key changes its meaning or is gone"}};
  keys.insert(keys.end(), command.keys.begin(), command.keys.end());
  keys.push_back({"not_finite", "flaws?",
                  "absent, or for each number that is not finite its JSON pointer and what it is: infinite, -infinite or nan"});
  return keys;
}

ordered_json schema_of(const Command& command) {
  ordered_json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", fmt::format("envmap {} --json", command.name)}};
  schema.update(object());
  for (const Key& key : all_keys(command)) add(schema, key.path, key);
  return schema;
}

}  // namespace tools
