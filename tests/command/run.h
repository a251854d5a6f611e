/// @file
/// Runs the program as its users do: arguments in, bytes and an exit status out, in a folder of the test's own.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace command_tests {

std::string bytes_of(const std::filesystem::path& path);

/// A line cut at its spaces.
std::vector<std::string> split(const std::string& line);

struct Result {
  int status = -1;  ///< Exit status; -1 where a signal ended the program.
  int signal = 0;   ///< That signal, or 0.
  std::string out, err;
};

/// What surrounds a run.
struct Setting {
  std::string input;                          ///< Bytes on standard input.
  std::optional<std::uint64_t> largest_file;  ///< Writes beyond fail, as on a full disk.
  std::optional<std::uint64_t> memory;  ///< Address space; not enforced in sanitised builds, which need terabytes.
};

/// Fresh and empty for each test, removed with all it holds.
class CommandTest : public ::testing::Test {
 protected:
  CommandTest();
  ~CommandTest() override;
  CommandTest(const CommandTest&) = delete;

  /// The program with these arguments; relative names are in the test's folder.
  [[nodiscard]] Result envmap(const std::vector<std::string>& arguments, const Setting& setting = {}) const;

  /// A line for sh; "$ENVMAP" is the program.
  [[nodiscard]] Result shell(const std::string& line, const Setting& setting = {}) const;

  /// What a run said with --json, or what it says with these arguments and --json. Expects it to end with 0.
  [[nodiscard]] static nlohmann::json report(const Result& run);
  [[nodiscard]] nlohmann::json report(std::vector<std::string> arguments) const;

  /// Expects the run to end with 0 and to say nothing on standard error.
  void succeeds(const std::vector<std::string>& arguments, const Setting& setting = {}) const;

  /// Expects the exit status, exactly one line on standard error that begins with `envmap COMMAND: ` and holds all the
  /// words, nothing on standard output, and every file in the folder as it was.
  void fails(int status, const std::vector<std::string>& arguments, const std::vector<std::string>& words,
             const Setting& setting = {}) const;

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& bytes) const;
  [[nodiscard]] std::string read(const std::string& name) const;

  /// Names and bytes of all files in the folder, hidden ones too; folders end in '/', links in '@'.
  [[nodiscard]] std::map<std::string, std::string> files() const;
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  friend class Background;
  std::filesystem::path root_, folder_, temporary_;
};

/// A run that goes on while the test does something else. The destructor waits for it.
class Background {
 public:
  Background(const CommandTest& test, const std::vector<std::string>& arguments, const Setting& setting = {});
  ~Background();
  Background(const Background&) = delete;

  void send(int signal) const;
  /// Whether it has a file without a name open in a folder: an output in the making.
  [[nodiscard]] bool writes_in(const std::string& folder) const;
  Result wait();

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  File in_, out_, err_;
  pid_t process_ = -1;
};

/// Sends a signal as soon as a run writes, and expects that it ends by it.
void interrupt(Background& run, int signal, const std::function<bool()>& writes);

}  // namespace command_tests
