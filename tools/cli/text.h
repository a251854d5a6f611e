// The help texts of a command, from text/COMMAND.txt, which is built into the program.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tools {

struct Example {
  std::string command, what;
};

/// A key of the report. `levels[].flux` is in each element of an array. Types: text, texts, words (an object of texts),
/// number, count, boolean, triple, triples, texel, object. After a type: "?" for keys that may be absent,
/// or " or null".
struct Key {
  std::string path, type, what;
};

struct Text {
  std::string summary;
  std::vector<std::string> description;  ///< Paragraphs.
  std::vector<Example> examples;
  std::vector<Key> keys;  ///< Includes the keys that every report has.
  std::map<std::string, std::string, std::less<>> details;  ///< By option: more text for its place in the man page.
};

/// Reads text/COMMAND.txt, then text/options.txt, which has details of options that several commands share. The first
/// line is the summary. The others are:
///   $ COMMAND           an example; the next line says what it does
///   KEY | TYPE | WHAT   a key of the report
///   --OPTION: TEXT      a detail of an option; the first one counts
///   +NAME               stands for text/NAME.txt
///   = HEADING           a heading in the description
///   * NAME: TEXT        an item of a list in the description; {filters} stands for one for each filter
///   - TEXT              an item of a list
///   | A | B |           a row of a table; {engines} and {formats} stand for rows
///   two spaces          the paragraph before goes on, on a line of its own
/// and else paragraphs of the description.
Text text_of(std::string_view command);

}  // namespace tools
