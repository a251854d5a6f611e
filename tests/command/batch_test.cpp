// Many commands through Ninja and Make themselves: what they make, what they leave alone, what they say.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>

#include "run.h"

namespace command_tests::batch_test {
namespace {

namespace fs = std::filesystem;

class Batch : public CommandTest {
 protected:
  Batch() {
    for (const char* name : {"a", "b c"}) succeeds({"generate", "sky", std::string(name) + ".hdr", "--size", "8"});
  }
  // Makes a file look newer than all that is made of it, without waiting for the clock.
  void touch(const std::string& name) const {
    for (const auto& entry : fs::recursive_directory_iterator(path("."))) {
      const auto back = std::chrono::seconds(10);
      if (entry.is_regular_file()) fs::last_write_time(entry.path(), fs::last_write_time(entry.path()) - back);
    }
    fs::last_write_time(path(name), fs::last_write_time(path(name)) + std::chrono::seconds(5));
  }
  [[nodiscard]] fs::file_time_type time_of(const std::string& name) const { return fs::last_write_time(path(name)); }
};

const std::string lines =
    "# every probe, and what is made of what was made\n"
    "envmap convert *.hdr {stem}.exr --to cube --size 6\n"
    "mipmap *.exr \"chains {name}.ktx2\" --depth half\n"
    "\n"
    "preview *.hdr sheet.png --height 16\n";

TEST_F(Batch, OfLinesMakesWhatChanged) {
  write("maps.txt", lines);
  succeeds({"batch", "-q", "maps.txt"});
  succeeds({"convert", "b c.hdr", "alone.exr", "--to", "cube", "--size", "6"});
  EXPECT_EQ(read("b c.exr"), read("alone.exr"));
  succeeds({"mipmap", "alone.exr", "alone.ktx2", "--depth", "half"});
  EXPECT_EQ(read("chains b c.ktx2"), read("alone.ktx2"));
  EXPECT_FALSE(read("sheet.png").empty());
  fs::remove(path("alone.exr"));
  const Result again = envmap({"batch", "maps.txt"});
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(again.err, "envmap batch: nothing to do\n");
  fs::remove(path("a.exr"));
  const auto other = time_of("b c.exr");
  EXPECT_EQ(envmap({"batch", "maps.txt"}).err, "envmap batch: 2 jobs done, 3 up to date\n");
  EXPECT_TRUE(fs::exists(path("a.exr")));
  EXPECT_EQ(time_of("b c.exr"), other);
  // Another option is another command.
  write("maps.txt", "convert *.hdr {stem}.exr --to cube --size 5\n");
  succeeds({"batch", "-q", "maps.txt"});
  succeeds({"convert", "a.hdr", "alone.exr", "--to", "cube", "--size", "5"});
  EXPECT_EQ(read("a.exr"), read("alone.exr"));
}

TEST_F(Batch, OfJsonGoesOnAfterFailuresAndNamesEach) {
  write("bad.hdr", "no image");
  write(
      "maps.json",
      R"([["convert", "bad.hdr", "bad $1 #.exr"], "convert 'b c.hdr' 'odd $1 #.exr' --to sphere", ["convert", "gone.hdr", "gone.exr"]])");
  const Result r = envmap({"batch", "maps.json", "-k"});
  EXPECT_EQ(r.status, 4);
  EXPECT_NE(r.err.find("envmap batch: not made: bad $1 #.exr: envmap convert: bad.hdr: "), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("envmap batch: not made: gone.exr: envmap convert: gone.hdr: "), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("envmap batch: 2 of 3 jobs failed\n"), std::string::npos) << r.err;
  EXPECT_EQ(std::ranges::count(r.err, '\n'), 3) << r.err;
  EXPECT_TRUE(fs::exists(path("odd $1 #.exr")));
  EXPECT_FALSE(fs::exists(path("gone.exr")));
}

TEST_F(Batch, CountsTheJobsThatItSkips) {
  write("maps.txt",
        "convert gone.hdr gone.exr\nconvert gone.exr later.exr\nconvert a.hdr a.exr\nconvert a.exr again.exr\n");
  EXPECT_NE(envmap({"batch", "maps.txt", "-k"})
                .err.find("envmap batch: 1 of 4 jobs failed; skipped 1 that needed outputs of failed jobs\n"),
            std::string::npos);
  EXPECT_NE(envmap({"batch", "maps.txt"})
                .err.find("envmap batch: 1 of 4 jobs failed; skipped 1 that had not started (-k continues"),
            std::string::npos);
  write("one.txt", "convert gone.hdr gone.exr\n");
  EXPECT_NE(envmap({"batch", "one.txt"}).err.find("envmap batch: the job failed\n"), std::string::npos);
}

TEST_F(Batch, KnowsTheFilesOfSeveralPlaces) {
  write("scene.obj", "v -1 -1 -1\nv 1 -1 -1\nv 0 1 -1\nf 1 2 3\n");
  write("maps.txt",
        "render scene.obj {at}.exr --at 0,0,0 --at 0,0,1 --size 4 --method raycast --ambient 1\n"
        "convert 0,0,1.exr second.hdr --size 4\n"
        "mipmap 0,0,0.exr chain.exr\n");
  succeeds({"batch", "-q", "maps.txt"});
  EXPECT_FALSE(read("second.hdr").empty());
  EXPECT_EQ(envmap({"batch", "maps.txt"}).err, "envmap batch: nothing to do\n");
  fs::remove(path("0,0,1.exr"));
  succeeds({"batch", "-q", "maps.txt"});
  EXPECT_FALSE(read("0,0,1.exr").empty());
  write("maps.txt", "render scene.obj out.exr --at 0,0,0 --at 0,0,1\n");
  fails(2, {"batch", "maps.txt"}, {"line 1", "must contain {at} or {index}"});
}

TEST_F(Batch, OfJsonTakesNumbersAsWords) {
  write("maps.json", R"([["convert", "a.hdr", "n.exr", "--size", 8, "--exposure", -1.5, "--max-error", 1e-2]])");
  succeeds({"batch", "-q", "maps.json"});
  succeeds({"convert", "a.hdr", "w.exr", "--size", "8", "--exposure", "-1.5", "--max-error", "0.01", "-q"});
  EXPECT_EQ(read("n.exr"), read("w.exr"));
}

TEST_F(Batch, BakesProbesForAnEngine) {
  succeeds({"batch", "-q", "--for", "blender", "a.hdr", "b c.hdr", "--into", "lights"});
  EXPECT_TRUE(fs::exists(path("lights/a/world.py")));
  EXPECT_TRUE(fs::exists(path("lights/b c/background.exr")));
  EXPECT_EQ(envmap({"batch", "--for", "blender", "a.hdr", "b c.hdr", "--into", "lights"}).err,
            "envmap batch: nothing to do\n");
}

TEST_F(Batch, KnowsEveryFileOfABakedFolder) {
  write("maps.txt", "convert lights/background.exr small.exr --size 4\nbake a.hdr lights --for BLENDER\n");
  succeeds({"batch", "-q", "maps.txt", "-j", "2"});
  EXPECT_TRUE(fs::exists(path("small.exr")));
  fs::remove(path("lights/world.py"));
  succeeds({"batch", "-q", "maps.txt"});
  EXPECT_TRUE(fs::exists(path("lights/world.py")));
  EXPECT_EQ(envmap({"batch", "maps.txt"}).err, "envmap batch: nothing to do\n");
  write("maps.txt", "bake a.hdr lights\n");
  fails(2, {"batch", "maps.txt"}, {"line 1: needs --for ENGINE"});
}

TEST_F(Batch, ManifestsOfOneNameHaveTheirOwnState) {
  for (const std::string folder : {"d1", "d2"}) {
    fs::create_directory(path(folder));
    write(folder + "/maps.txt", "convert a.hdr " + folder + "/out.exr --size 4\n");
    succeeds({"batch", folder + "/maps.txt", "--make", folder + ".mk", "-q"});
    EXPECT_EQ(shell("make -s -f " + folder + ".mk").status, 0);
    EXPECT_TRUE(fs::exists(path(".envmap-batch/" + folder + "+maps.txt/1.d")));
  }
}

TEST_F(Batch, TakesOperandsBehindTwoHyphens) {
  write("maps.txt", "convert --size 4 -- a.hdr out.exr\n");
  succeeds({"batch", "-q", "maps.txt"});
  EXPECT_TRUE(fs::exists(path("out.exr")));
}

TEST_F(Batch, APatternBesideThatOfTheJobsIsAllItsFiles) {
  write("maps.txt", "preview a.hd? b*.hdr {name}-sheet.png --height 16\n");
  succeeds({"batch", "-q", "maps.txt"});
  EXPECT_TRUE(fs::exists(path("a-sheet.png")));
  write("maps.txt", "preview a.hd? c*.hdr {name}-sheet.png --height 16\n");
  fails(2, {"batch", "maps.txt"}, {"line 1: no file matches c*.hdr"});
}

TEST_F(Batch, AnotherVersionIsAnotherCommand) {
  write("maps.txt", "convert a.hdr out.exr --size 4\n");
  succeeds({"batch", "-q", "maps.txt"});
  std::string version = envmap({"--version"}).out;
  EXPECT_NE(read(".envmap-batch/maps.txt/build.ninja").find(version.substr(0, version.find('\n'))), std::string::npos);
}

TEST_F(Batch, WritesAMakefile) {
  write("maps.txt", lines + "convert a.hdr 'f$1_{face}.exr' --to cube --size 4\n");
  succeeds({"batch", "maps.txt", "--make", "maps.mk", "-q"});
  EXPECT_FALSE(fs::exists(path("a.exr")));
  const Result made = shell("make -s -j 2 -f maps.mk");
  EXPECT_EQ(made.status, 0) << made.err;
  for (const char* file : {"a.exr", "chains b c.ktx2", "sheet.png", "f$1_px.exr", "f$1_nz.exr"})
    EXPECT_TRUE(fs::exists(path(file))) << file;
  EXPECT_EQ(shell("make -q -f maps.mk").status, 0);
  touch("b c.hdr");
  const auto a = time_of("a.exr"), b = time_of("b c.exr");
  EXPECT_EQ(shell("make -s -f maps.mk").status, 0);
  EXPECT_EQ(time_of("a.exr"), a);
  EXPECT_NE(time_of("b c.exr"), b);
}

TEST_F(Batch, WritesAMakefileOfOddNames) {
  write("maps.txt", "convert a.hdr './x $y #1:.exr' --size 4\nmipmap 'x $y #1:.exr' 'in a/folder//x.ktx2'\n");
  succeeds({"batch", "maps.txt", "--make", "maps.mk", "-q"});
  const Result made = shell("make -s -f maps.mk");
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_TRUE(fs::exists(path("in a/folder/x.ktx2")));
  EXPECT_EQ(shell("make -q -f maps.mk").status, 0);
  touch("a.hdr");
  EXPECT_EQ(shell("make -q -f maps.mk").status, 1);
  for (const char character : std::string_view(";=%(*[\\")) {
    const std::string name = std::string("a") + character + "b.exr";
    write("maps.txt", "convert a.hdr '" + name + "'\n");
    fails(2, {"batch", "maps.txt", "--make", "odd.mk"}, {name, "a name with", "Make"});
    succeeds({"batch", "-q", "maps.txt"});
    EXPECT_TRUE(fs::exists(path(name))) << name;
  }
  write("maps.txt", "convert a.hdr 'a|b.exr'\n");
  fails(2, {"batch", "maps.txt"}, {"a|b.exr", "a name with |", "Ninja"});
}

TEST_F(Batch, OneFileHasOneName) {
  fs::create_directory(path("sub"));
  fs::create_directory_symlink(path("sub"), path("link"));
  write("maps.txt",
        "convert a.hdr ./k2.exr --size 4\nmipmap ./k?.exr {stem}_m.exr\nconvert a.hdr link/z.exr --size 4\n"
        "convert sub/z.exr " +
            path("y.exr") + " --size 4\nconvert y.exr w.exr --size 4\n");
  succeeds({"batch", "-q", "maps.txt"});
  for (const char* file : {"k2_m.exr", "sub/z.exr", "w.exr"}) EXPECT_TRUE(fs::exists(path(file))) << file;
  EXPECT_EQ(envmap({"batch", "maps.txt"}).err, "envmap batch: nothing to do\n");
}

TEST_F(Batch, QuotedCharactersStandForThemselves) {
  fs::copy(path("a.hdr"), path("q[1]?.hdr"));
  write("maps.txt", "convert 'q[1]?.hdr' \"[*]\".exr --size 4\nconvert q\\[*.hdr {stem}-small.exr --size 4\n");
  succeeds({"batch", "-q", "maps.txt"});
  EXPECT_TRUE(fs::exists(path("[*].exr")));
  EXPECT_TRUE(fs::exists(path("q[1]?-small.exr")));
  succeeds({"batch", "-q", "--for", "blender", "q[1]?.hdr", "--into", "lights"});
  EXPECT_TRUE(fs::exists(path("lights/q[1]?/world.py")));
}

TEST_F(Batch, APatternLeavesOutWhatItsLineWrites) {
  write("maps.txt", "convert *.hdr {stem}-small.hdr --size 4\npreview *.png *.hdr all.png --height 16\n");
  succeeds({"generate", "sky", "x.png", "--size", "8"});
  succeeds({"batch", "-q", "maps.txt"});
  const auto names_before = names();
  EXPECT_EQ(envmap({"batch", "maps.txt"}).err, "envmap batch: nothing to do\n");
  EXPECT_EQ(names(), names_before);
  EXPECT_TRUE(fs::exists(path("b c-small.hdr")));
  EXPECT_FALSE(fs::exists(path("a-small-small.hdr")));
}

TEST_F(Batch, JoinsShards) {
  write("shards.txt",
        "prefilter a.hdr p1.exr --size 8 --shard 1/3\nmerge p3.exr p1.exr p2.exr whole.exr\n"
        "prefilter a.hdr p2.exr --size 8 --shard 2/3\nprefilter a.hdr p3.exr --size 8 --shard 3/3\n");
  succeeds({"batch", "-q", "shards.txt", "-j", "2"});
  succeeds({"prefilter", "a.hdr", "alone.exr", "--size", "8", "-q"});
  EXPECT_EQ(read("whole.exr"), read("alone.exr"));
}

TEST_F(Batch, JoinsShardsOfAChain) {
  std::string jobs;
  for (int k = 1; k <= 3; ++k)
    jobs += "prefilter a.hdr p" + std::to_string(k) + ".exr --lobe ggx --levels 3 --size 16 --shard " +
            std::to_string(k) + "/3\n";
  write("shards.txt", jobs + "merge p?.exr whole.ktx\n");
  succeeds({"batch", "-q", "shards.txt", "-j", "2"});
  succeeds({"prefilter", "a.hdr", "alone.ktx", "--lobe", "ggx", "--levels", "3", "--size", "16", "-q"});
  EXPECT_TRUE(read("whole.ktx") == read("alone.ktx"));
}

TEST_F(Batch, RefusesWrongManifestsBeforeAnyWork) {
  const auto refused = [&](const std::string& text, const std::vector<std::string>& words, int status = 2) {
    write("wrong.txt", text);
    fails(status, {"batch", "wrong.txt"}, words);
  };
  refused("convert a.hdr a.exr\nconvert a.hdr b.exr --tow cube\n", {"line 2", "--tow", "--to"});
  refused("convert a.hdr x.exr\nmipmap a.hdr x.exr\n", {"line 2", "x.exr", "line 1"});
  refused("convert a.hdr x.exr\nmipmap a.hdr ./x.exr\n", {"line 2", "x.exr", "line 1"});
  refused("convert a.hdr x.exr\nmipmap a.hdr " + path("x.exr") + "\n", {"line 2", "x.exr", "line 1"});
  refused("sh a.hdr --evaluate x.exr\n", {"line 1", "sh is not for a batch"});
  refused("view a.gltf f%04d.png --frames 0:1\n", {"line 1", "names of their own"});
  refused("convert '*.hdr' {stem}.exr\n", {"line 1", "without quotation marks"});
  refused("convert *.hdr x.exr --to cube\n", {"line 1", "unexpected argument"});
  refused("convert a.hdr b.exr c.exr\n", {"wrong.txt: line 1: unexpected argument 'c.exr'"});
  refused("convert *.jpg {stem}.exr\n", {"line 1", "*.jpg"});
  refused("convert a.hdr {stem}.exr\n", {"line 1", "{stem}"});
  refused("info a.hdr\n", {"line 1", "info"});
  refused("convert a.hdr -\n", {"line 1"});
  refused("convert 'a.hdr x.exr\n", {"line 1", "'"});
  refused("\n# nothing\n", {"wrong.txt"}, 3);
  refused("[1]", {"wrong.txt", "job 1"}, 3);
  refused("[[\"convert\", null]]", {"wrong.txt", "job 1"}, 3);
  refused("convert c.exr b.exr\nconvert a.hdr d.exr\nconvert b.exr c.exr\nconvert c.exr e.exr\n",
          {"wrong.txt", "line 1", "line 3", "circle"});
  refused("convert c.exr b.exr\nconvert b.exr c.exr\n", {"(line 1, line 2, line 1)"});
  refused("[\"convert a.hdr a.exr\"", {"wrong.txt", "JSON"}, 3);
  refused(std::string("convert a.hdr a.exr\0.hdr\n", 25), {"line 1", "NUL"});
  refused(R"(["convert a.hdr a.exr\u0000.hdr"])", {"job 1", "NUL"});
  fails(3, {"batch", "none.txt"}, {"none.txt", "batch -"});
  fails(3, {"batch", "."}, {"folder"});
  fails(3, {"batch", "--for", "blender", "."}, {"folder", "*.hdr"});
  fails(2, {"batch", "a.txt", "b.txt"}, {"b.txt"});
}

TEST_F(Batch, WritesAScriptForSlurmThatWaitsForWhatIsRead) {
  write("maps.txt", "convert a.hdr a.exr --to cube\nconvert 'b c.hdr' b.exr\nmipmap a.exr a.ktx2\n");
  for (const std::string scheduler : {"--make", "--slurm"}) {
    fails(2, {"batch", "maps.txt", scheduler, "./maps.txt"}, {"is both input and output"});
    fails(2, {"batch", "maps.txt", scheduler, ""}, {"the name is empty"});
    fails(2, {"batch", "maps.txt", scheduler, "jobs", "--threads", "2"}, {"--threads", scheduler});
  }
  succeeds({"batch", "maps.txt", "--slurm", "maps.sh", "-q"});
  // sbatch as this test has it: runs every task of an array at once, and says what it was asked for.
  write("sbatch",
        "#!/bin/sh\nprintf '%s ' \"$@\" >> asked\nfor word; do case $word in --array=1-*) n=${word#--array=1-} ;; "
        "--export=ALL,*) export "
        "\"${word#--export=ALL,}\" ;; esac; script=$word; done\nk=1; while [ $k -le $n ]; do SLURM_ARRAY_TASK_ID=$k sh "
        "\"$script\" >&2 || exit 1; "
        "k=$((k + 1)); done\necho $((40 + n))\n");
  const Result r = shell("chmod +x sbatch && PATH=$PWD:$PATH sh maps.sh --mem=1G");
  EXPECT_EQ(r.status, 0) << r.err;
  EXPECT_EQ(r.out, "41\n");
  EXPECT_TRUE(fs::exists(path("b.exr")));
  EXPECT_TRUE(fs::exists(path("a.ktx2")));
  EXPECT_EQ(read("asked"),
            "--parsable --array=1-2 --export=ALL,ENVMAP_FIRST=0 --mem=1G maps.sh --parsable --array=1-1 "
            "--export=ALL,ENVMAP_FIRST=2 "
            "--dependency=afterok:42 --mem=1G maps.sh ");
}

}  // namespace
}  // namespace command_tests::batch_test
