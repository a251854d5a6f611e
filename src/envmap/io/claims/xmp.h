/// @file
/// XMP, the XML in which cameras and programs describe an image. Source: ISO 16684-1:2019, section 7 (RDF/XML).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace envmap {

/// An element of the XML with its attributes, or one attribute.
struct XmpNode {
  std::string space, name;          ///< The namespace's address, and the name in it.
  std::string text;                 ///< Of an attribute its value; of an element the text in it, before other elements.
  int depth = 0;                    ///< Elements around it.
  std::vector<XmpNode> attributes;  ///< Of an element.
};

/// All elements, in their order. @param packet as a file holds it; what surrounds the XML is passed over.
/// @throws InputError, without a file's name, where it is no XML.
std::vector<XmpNode> parse_xmp(std::string_view packet);

/// The values of a property: one, those of the list it holds, or none. It may be an attribute or an element.
std::vector<std::string> xmp_values(const std::vector<XmpNode>& xmp, std::string_view space, std::string_view name);

/// Its one value as a number. @throws InputError where it is none, or there are several.
std::optional<double> xmp_number(const std::vector<XmpNode>& xmp, std::string_view space, std::string_view name);

/// The number that a text is, or nothing: digits, sign, point and exponent, between spaces.
std::optional<double> number_of(std::string_view text);

}  // namespace envmap
