// Help, pages and completions.
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "picture.h"
#include "run.h"

namespace command_tests::help_test {
namespace {

class Help : public CommandTest {
 protected:
  /// Every command there is, as the pages have them.
  [[nodiscard]] std::vector<std::string> commands() const {
    succeeds({"manual", "."});
    std::vector<std::string> all;
    for (const std::string& page : names())
      if (page.starts_with("envmap-") && page.ends_with(".1")) all.push_back(page.substr(7, page.size() - 9));
    EXPECT_GE(all.size(), 5U);
    return all;
  }

  void succeeds_and_prints(const std::vector<std::string>& arguments, const std::string& file) const {
    const Result r = envmap(arguments);
    EXPECT_EQ(r.status, 0) << r.err;
    write(file, r.out);
  }
};

TEST_F(Help, OfEachCommandHasTwoExamples) {
  const std::string overview = envmap({"--help"}).out;
  for (const std::string& command : commands()) {
    SCOPED_TRACE(command);
    EXPECT_NE(overview.find("\n  " + command + " "), std::string::npos);
    const Result r = envmap({command, "--help"});
    EXPECT_EQ(r.status, 0);
    EXPECT_EQ(r.err, "");
    const std::size_t at = r.out.find("\nExamples:\n");
    ASSERT_NE(at, std::string::npos);
    // A command at an indent of 2, what it does below at an indent of 6.
    std::istringstream lines(r.out.substr(at));
    int examples = 0;
    for (std::string line, last; std::getline(lines, line); last = line)
      examples += last.starts_with("  ") && last[2] != ' ' && last.find("envmap") != std::string::npos &&
                  line.starts_with("      ");
    EXPECT_GE(examples, 2) << r.out;
  }
}

TEST_F(Help, KnowsTheVersion) {
  const Result r = envmap({"--version"});
  EXPECT_EQ(r.status, 0);
  EXPECT_TRUE(std::regex_match(
      r.out, std::regex("envmap \\d+\\.\\d+\\.\\d+( \\([0-9a-f]{7,}\\+?\\))?\nwith OpenEXR \\d[^\n]*, zstd \\d\\S*\n"
                        "draws with (EGL|OSMesa), [^\n]+, OpenGL \\d[^\n]*\n")))
      << r.out;
}

TEST_F(Help, KnowsTheVersionsAsJson) {
  const Result text = envmap({"--version"});
  for (const std::vector<std::string>& line :
       {std::vector<std::string>{"--version", "--json"}, {"--json", "--version"}}) {
    const Result r = envmap(line);
    EXPECT_EQ(r.status, 0) << r.err;
    const auto read = nlohmann::json::parse(r.out);
    EXPECT_EQ(text.out.rfind("envmap " + read["envmap"].get<std::string>(), 0), 0U);
    for (const auto& [name, version] : read["libraries"].items())
      EXPECT_NE(text.out.find(name + " " + version.get<std::string>()), std::string::npos) << name;
    EXPECT_GE(read["libraries"].size(), 10U);
    EXPECT_NE(text.out.find("draws with " + read["renderer"].get<std::string>()), std::string::npos);
  }
}

TEST_F(Help, IsWhatTheRepositorysPagesSay) {
  succeeds({"manual", "."});
  std::map<std::string, std::string> kept;
  ASSERT_TRUE(std::filesystem::is_directory(ENVMAP_MAN_DIR));
  const auto made = files();
  for (const auto& entry : std::filesystem::directory_iterator(ENVMAP_MAN_DIR))
    if (const std::string name = entry.path().filename().string(); name.ends_with(".1") || made.contains(name))
      kept[name] = bytes_of(entry.path());
  EXPECT_EQ(kept, made) << "run 'envmap manual man' in the repository";
}

TEST_F(Help, NamesTheFolderOfTheSample) {
  std::string folder = envmap({"manual", "--samples"}).out;
  ASSERT_TRUE(folder.ends_with("\n"));
  folder.pop_back();
  EXPECT_TRUE(std::filesystem::path(folder).is_absolute()) << folder;
  succeeds({"convert", folder + "/sample.hdr", "cube.exr", "--to", "cube", "--size", "16", "--depth", "half"});
  EXPECT_LT(std::filesystem::file_size(folder + "/sample.hdr"), 300000U);
  EXPECT_TRUE(std::filesystem::exists(folder + "/scenes/make.py"));
  // A program that lies alone says where it looked.
  std::filesystem::copy_file(ENVMAP_PROGRAM, path("alone"));
  const Result r = shell("./alone manual --samples");
  EXPECT_EQ(r.status, 3);
  EXPECT_NE(r.err.find("share/envmap/samples: no sample.hdr there"), std::string::npos) << r.err;
}

// A terminal made by script(1) sees how far the work is, how fast it goes and how long it will take;
// a file sees nothing.
TEST_F(Help, LongWorkTellsATerminalHowLongItTakes) {
#ifdef ENVMAP_SANITIZED
  GTEST_SKIP() << "too slow to get anywhere in time";
#endif
  if (shell("command -v script").status != 0) GTEST_SKIP() << "script is not installed";
  succeeds({"generate", "sky", "sky.exr", "--size", "512"});
  const std::string job = "\"$ENVMAP\" prefilter sky.exr x.exr --method exact --size 24";
  write("watch.sh", "script -qfec 'exec timeout 60 " + job + R"(' seen >/dev/null </dev/null &
until tr '\r' '\n' <seen | grep -E 'prefilter diffuse +[0-9]+%, [0-9.e-]+%/s, [0-9:]+ (s|min|h) left'; do
  kill -0 $! || exit
  sleep .1
done
kill $!
wait
rm seen watch.sh
)");
  const Result seen = shell(": >seen; sh watch.sh");
  EXPECT_EQ(seen.status, 0) << seen.out << seen.err;
  EXPECT_EQ(shell("timeout 2 " + job).err, "");
  EXPECT_EQ(names(), std::vector<std::string>{"sky.exr"});
}

TEST_F(Help, HasPagesThatMandocAccepts) {
  if (shell("command -v mandoc").status != 0) GTEST_SKIP() << "mandoc is not installed";
  succeeds({"manual", "."});
  const Result r =
      shell("mandoc -T lint -W error *.1 " + std::string(ENVMAP_MAN_DIR) + "/*.3 " + ENVMAP_MAN_DIR + "/*.7");
  EXPECT_EQ(r.status, 0) << r.out << r.err;
}

// A table that is too wide, or a line that cannot be broken.
TEST_F(Help, HasPagesThatFit80Columns) {
  if (shell("command -v groff tbl").status != 0) GTEST_SKIP() << "groff is not installed";
  succeeds({"manual", "."});
  const std::string folder = ENVMAP_MAN_DIR;
  EXPECT_EQ(shell("for p in *.1 *.7 " + folder + "/*.3 " + folder +
                  "/*.7; do groff -t -man -Tutf8 -rLL=78n $p >out || echo $p; done")
                .err,
            "");
}

TEST_F(Help, CompletesInBash) {
  const Result script = envmap({"completion"});
  EXPECT_EQ(script.status, 0);
  write("envmap.bash", script.out);
  ASSERT_EQ(shell("bash -n envmap.bash").status, 0);
  const auto completed = [&](const std::string& words, int at) {
    write("try.bash", "source ./envmap.bash\nCOMP_WORDS=(" + words + ")\nCOMP_CWORD=" + std::to_string(at) +
                          "\n_envmap\necho \"${COMPREPLY[*]}\"\n");
    return shell("bash try.bash").out;
  };
  EXPECT_EQ(completed("envmap conv", 1), "convert\n");
  EXPECT_EQ(completed("envmap convert --to cu", 3), "cube\n");
  EXPECT_EQ(completed("envmap convert --repa", 2), "--repair\n");
  EXPECT_EQ(completed("envmap generate di", 2), "directions\n");
  EXPECT_EQ(completed("envmap convert --output-space ACESc", 3), "ACEScg\n");
  std::istringstream spaces(completed("envmap convert --output-space ''", 3));
  succeeds({"generate", "constant", "one.exr", "--size", "2"});
  int count = 0;
  for (std::string space; spaces >> space; ++count)
    succeeds({"convert", "one.exr", "out.exr", "--output-space", space, "--encoded"});
  EXPECT_EQ(count, 8);
  EXPECT_EQ(completed("envmap convert --size ''", 3), "\n") << "a number is expected, no option";
}

TEST_F(Help, CompletesInFish) {
  if (shell("command -v fish").status != 0) GTEST_SKIP() << "fish is not installed";
  succeeds_and_prints({"completion", "fish"}, "envmap.fish");
  const auto completed = [&](const std::string& line) {
    // One completion a line, with its description after a tab.
    return shell("HOME=$PWD fish --no-config -c 'source envmap.fish; complete -C \"" + line + "\"' | cut -f 1").out;
  };
  EXPECT_EQ(completed("envmap conv"), "convert\n");
  EXPECT_EQ(completed("envmap convert --to cu"), "cube\n");
  // fish 4 adds what holds these letters apart: --ignore-envmap-attribute.
  EXPECT_EQ(completed("envmap convert --repa").rfind("--repair\n", 0), 0U);
  EXPECT_EQ(completed("envmap generate directi"), "directions\n");
}

TEST_F(Help, CompletesInZsh) {
  if (shell("command -v zsh").status != 0) GTEST_SKIP() << "zsh is not installed";
  succeeds_and_prints({"completion", "zsh"}, "_envmap");
  // zsh completes at a terminal alone: it is given one, a line and a tab, and what stands there then is echoed.
  const auto completed = [&](const std::string& line) {
    write("try.zsh", R"(zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell 'PS1= fpath=($PWD $fpath); unsetopt zle_bracketed_paste; autoload -U compinit; compinit -u -D; stty -echo; show() { print -r - "<$BUFFER>"; BUFFER=; zle accept-line }; zle -N show; bindkey "^X" show; echo ready'
zpty -r -m shell text $'*ready\r\n*'
zpty -w -n shell $')" + line +
                         R"(\t\C-x'
zpty -r -m shell text '*<*>*'
[[ $text =~ '<([^>]*)>' ]] && print -r - $match[1]
zpty -d shell
)");
    return shell("HOME=$PWD timeout 20 zsh -f try.zsh").out;
  };
  EXPECT_EQ(completed("envmap conv"), "envmap convert \n");
  EXPECT_EQ(completed("envmap convert --to cu"), "envmap convert --to cube \n");
  EXPECT_EQ(completed("envmap convert --repa"), "envmap convert --repair \n");
  EXPECT_EQ(completed("envmap generate directi"), "envmap generate directions \n");
}

}  // namespace
}  // namespace command_tests::help_test
