// The help texts of a command, from text/COMMAND.txt, which is built into the program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tools {

struct Example {
  std::string command, what;
};

/// A key of the report. `levels[].flux` is in each element of an array. Types: text, texts, words (an object of texts),
/// number, count, boolean, triple, triples, texel, object. After a type: "?" for keys that may be absent, or " or null".
struct Key {
  std::string path, type, what;
};

struct Text {
  std::string summary;
  std::vector<std::string> description;  ///< Paragraphs.
  std::vector<Example> examples;
  std::vector<Key> keys;  ///< Includes the keys that every report has.
};

/// Reads text/COMMAND.txt. Its first line is the summary. Other lines are paragraphs, but for these:
/// "  LINE" continues a paragraph on a line of its own; "$ COMMAND" is an example, and the next line says what it does;
/// "KEY | TYPE | WHAT" is a key of the report; "+NAME" stands for text/NAME.txt. {filters} becomes a sentence for each
/// filter.
Text text_of(std::string_view command);

}  // namespace tools
