#include "envmap/io/claims/xmp.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

#include "envmap/base/error.h"

namespace envmap {
namespace {

constexpr std::string_view spaces = " \t\r\n", rdf = "http://www.w3.org/1999/02/22-rdf-syntax-ns#";

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(spaces), text.size()));
  return text.substr(0, text.find_last_not_of(spaces) + 1);
}

// The five entities of XML. Others, and numbered ones, stay as they are.
std::string unescaped(std::string_view text) {
  constexpr std::pair<std::string_view, char> entities[] = {
      {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
  std::string out;
  while (!text.empty()) {
    std::size_t taken = 1;
    char c = text[0];
    for (const auto& [entity, is] : entities)
      if (text.starts_with(entity)) c = is, taken = entity.size();
    out += c;
    text.remove_prefix(taken);
  }
  return out;
}

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  std::vector<XmpNode> run() {
    for (std::size_t open = text_.find('<'); open != text_.npos; open = text_.find('<', at_)) {
      add_text(text_.substr(at_, open - at_));
      at_ = open;
      if (text_.substr(at_).starts_with("<!--"))
        skip_to("-->");
      else if (text_.substr(at_).starts_with("<?"))
        skip_to("?>");
      else if (text_.substr(at_).starts_with("<!"))
        throw InputError("damaged: XMP with a declaration");
      else
        read_tag();
    }
    if (!open_.empty()) throw InputError(fmt::format("damaged: XMP whose element {} has no end", open_.back().tag));
    return std::move(found_);
  }

 private:
  static constexpr std::size_t most_depth = 64, most_elements = 1 << 16;
  struct Open {
    std::string tag;
    std::size_t element;
    bool has_children = false;
  };

  void skip_to(std::string_view end) {
    const std::size_t found = text_.find(end, at_);
    if (found == text_.npos) throw InputError(fmt::format("damaged: XMP without the '{}' of what it begins", end));
    at_ = found + end.size();
  }

  void add_text(std::string_view text) {
    if (!open_.empty() && !open_.back().has_children) found_[open_.back().element].text += unescaped(trimmed(text));
  }

  void skip_spaces() { at_ = std::min(text_.find_first_not_of(spaces, at_), text_.size()); }

  bool take(std::string_view what) {
    const bool there = text_.substr(at_).starts_with(what);
    if (there) at_ += what.size();
    return there;
  }

  void read_tag() {
    const bool closes = text_.substr(at_).starts_with("</");
    at_ += closes ? 2 : 1;
    const std::size_t begin = at_;
    at_ = std::min(text_.find_first_of(" \t\r\n/>", at_), text_.size());
    const std::string tag(text_.substr(begin, at_ - begin));
    if (closes) return close(tag);
    if (tag.empty() || open_.size() >= most_depth || found_.size() >= most_elements)
      throw InputError("damaged: XMP with an element that has no name, or too many");
    std::vector<std::pair<std::string, std::string>> attributes;
    for (skip_spaces(); !take(">"); skip_spaces()) {
      if (take("/>")) return add(tag, attributes, true);
      attributes.push_back(attribute(tag));
    }
    add(tag, attributes, false);
  }

  std::pair<std::string, std::string> attribute(const std::string& tag) {
    const std::size_t begin = at_, equals = text_.find('=', at_);
    const auto damaged = [&] {
      return InputError(fmt::format("damaged: XMP whose element {} has a broken attribute", tag));
    };
    if (equals == text_.npos) throw damaged();
    const std::string name(trimmed(text_.substr(begin, equals - begin)));
    at_ = equals + 1;
    skip_spaces();
    const char quote = at_ < text_.size() ? text_[at_] : '\0';
    const std::size_t end = text_.find(quote, at_ + 1);
    if (name.empty() || name.find_first_of("<> \t\r\n") != name.npos || (quote != '"' && quote != '\'') ||
        end == text_.npos)
      throw damaged();
    const std::string value = unescaped(text_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
    return {name, value};
  }

  // Prefixes count from where they are declared on: no file in use declares one anew with another meaning.
  XmpNode node(const std::string& qualified) const {
    const std::size_t colon = qualified.find(':');
    if (colon == qualified.npos) return {.space = "", .name = qualified};
    const auto known = prefixes_.find(qualified.substr(0, colon));
    return {.space = known == prefixes_.end() ? "" : known->second, .name = qualified.substr(colon + 1)};
  }

  void add(const std::string& tag, const std::vector<std::pair<std::string, std::string>>& attributes, bool empty) {
    for (const auto& [name, value] : attributes)
      if (name.starts_with("xmlns:")) prefixes_[name.substr(6)] = value;
    XmpNode element = node(tag);
    element.depth = int(open_.size());
    for (const auto& [name, value] : attributes) {
      if (name.starts_with("xmlns")) continue;
      element.attributes.push_back(node(name));
      element.attributes.back().text = value;
    }
    if (!open_.empty()) open_.back().has_children = true;
    found_.push_back(std::move(element));
    if (!empty) open_.push_back({tag, found_.size() - 1});
  }

  void close(const std::string& tag) {
    skip_to(">");
    if (open_.empty() || open_.back().tag != tag)
      throw InputError(fmt::format("damaged: XMP where </{}> ends nothing", tag));
    open_.pop_back();
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::map<std::string, std::string> prefixes_;
  std::vector<Open> open_;
  std::vector<XmpNode> found_;
};

// What surrounds the XML: JPEG's mark before it, zeros and spaces after it.
std::string_view xml_in(std::string_view packet) {
  const std::size_t begin = packet.find('<'), end = packet.find_last_of('>');
  return begin == packet.npos || end == packet.npos || end < begin ? std::string_view()
                                                                   : packet.substr(begin, end - begin + 1);
}

}  // namespace

std::vector<XmpNode> parse_xmp(std::string_view packet) { return Parser(xml_in(packet)).run(); }

std::vector<std::string> xmp_values(const std::vector<XmpNode>& xmp, std::string_view space, std::string_view name) {
  std::vector<std::string> values;
  for (std::size_t k = 0; k < xmp.size(); ++k) {
    for (const XmpNode& a : xmp[k].attributes)
      if (a.space == space && a.name == name) values.push_back(a.text);
    if (xmp[k].space != space || xmp[k].name != name) continue;
    bool is_list = false;
    for (std::size_t j = k + 1; j < xmp.size() && xmp[j].depth > xmp[k].depth; ++j)
      if (xmp[j].space == rdf) {
        is_list = true;
        if (xmp[j].name == "li") values.push_back(xmp[j].text);
      }
    if (!is_list) values.push_back(xmp[k].text);
  }
  return values;
}

std::optional<double> xmp_number(const std::vector<XmpNode>& xmp, std::string_view space, std::string_view name) {
  const std::vector<std::string> values = xmp_values(xmp, space, name);
  if (values.empty()) return std::nullopt;
  const std::optional<double> number = values.size() == 1 ? number_of(values[0]) : std::nullopt;
  if (!number) throw InputError(fmt::format("damaged: XMP where {} is not one number", name));
  return number;
}

std::optional<double> number_of(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  if (!whole || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace envmap
