/// @file
/// Text of lines that begin with a keyword: OBJ and MTL files.
#pragma once

#include <string>
#include <string_view>

namespace envmap {

/// UTF-8's, with which a text may begin.
inline constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

/// The lines of a text, ended by LF or CR LF, or by CR in a text without LF; a line that ends in a backslash goes on in
/// the next one, unless it begins with #. UTF-8's mark at the beginning is passed over.
class TextLines {
 public:
  explicit TextLines(std::string_view text);

  /// Goes to the next line. @return whether there is one.
  bool next();
  /// Without what ends it; as long as next() is not called.
  [[nodiscard]] std::string_view line() const { return line_; }
  /// From 1; of the first line where one goes on in the next.
  [[nodiscard]] int number() const { return number_; }

 private:
  std::string_view rest_, line_;
  char end_;
  std::string joined_;
  int number_ = 0, lines_ = 0;
};

/// The words of a line, one after the other, as they are expected.
class Words {
 public:
  explicit Words(const TextLines& lines) : rest_(lines.line()), line_(lines.number()) {}

  /// The next word; empty at the end of the line and before a comment, a word that begins with #.
  std::string_view word();
  /// The next word without taking it.
  [[nodiscard]] std::string_view peek() const { return Words(*this).word(); }
  [[nodiscard]] bool more() const { return !peek().empty(); }
  /// All that is left, without space around it: a name, which may hold spaces.
  std::string name();
  /// The next word as a number that float32 holds. @throws InputError as fail() where it is none, or there is no word.
  float number();
  /// The same; `otherwise` at the end of the line.
  float number(float otherwise) { return more() ? number() : otherwise; }
  /// @throws InputError("line N: why").
  [[noreturn]] void fail(const std::string& why) const;

 private:
  std::string_view rest_;
  int line_;
};

/// Text of a file for a message: cut to a length that fits one.
std::string quoted(std::string_view text);

/// @throws InputError where it is not text in a code that begins with ASCII: UTF-16, or a file of something else.
void check_text(std::string_view bytes);

}  // namespace envmap
