// Conversions to all projections against kept results, compared with the program's own `compare`.
//
// The bilinear files are the program's own, found equal to a program written apart from it within 1e-6. The area files
// are that other program's: the mean of 700 x 700 bilinear samples of each texel, weighted by solid angle, which
// differs from the mean of 300 x 300 by at most 4e-5. A difference is a mistake, then, unless a definition is changed
// on purpose. To make files anew for such a change, and only once the area files have been checked by other means,
// in this folder:
//
//   envmap generate sun golden/source.exr --size 16 --direction 3,2,1 --radius 12 --value 40,30,20
//   for p in latlong cube sphere paraboloid angular octahedral equal-area; do for f in bilinear area; do
//     envmap convert golden/source.exr golden/$p-$f.exr --to $p --filter $f --size 12 --rotate 20,30,40 --area-error
// 1e-6
//   done; done
//
// The rooms are ray casts (render's reference); what is drawn with OpenGL is compared with them:
//
//   envmap render room-4.glb golden/room-$p.exr --to $p --size 16 --method raycast --ambient 0.3 --at 0.3,0.2,0.1
// --depth half
#include "on_processor.h"
#include "picture.h"
#include "run.h"

namespace command_tests::golden_test {
namespace {

class Golden : public CommandTest {
 protected:
  static std::string kept(const std::string& name) { return std::string(ENVMAP_GOLDEN_DIR) + "/" + name + ".exr"; }

  void expect_as_kept(const std::string& file, const std::string& name, const char* error = "1e-4") const {
    const Result r = envmap({"compare", file, kept(name), "--max-error", error});
    EXPECT_EQ(r.status, 0) << name << "\n" << r.out << r.err;
    EXPECT_EQ(r.err, "") << "of another projection or size";
  }
};

TEST_F(Golden, TheSourceIsMadeAsEver) {
  succeeds(
      {"generate", "sun", "sun.exr", "--size", "16", "--direction", "3,2,1", "--radius", "12", "--value", "40,30,20"});
  expect_as_kept("sun.exr", "source", "3e-4");  // The edge of the sun is sampled.
}

constexpr const char* projections[] = {"latlong", "cube",       "sphere",    "paraboloid",
                                       "angular", "octahedral", "equal-area"};

TEST_F(Golden, BilinearIsAsEver) {
  for (const std::string to : projections) {
    succeeds({"convert", kept("source"), "out.exr", "--to", to, "--filter", "bilinear", "--size", "12", "--rotate",
              "20,30,40"});
    expect_as_kept("out.exr", to + "-bilinear");
  }
}

TEST_F(Golden, AreaIsTheMeanOfTheTexel) {
  // Three times the error at which the filter stops by itself.
  for (const std::string to : projections) {
    succeeds(
        {"convert", kept("source"), "out.exr", "--to", to, "--filter", "area", "--size", "12", "--rotate", "20,30,40"});
    expect_as_kept("out.exr", to + "-area", "3e-4");
  }
}

// The exact method knows no folds: what it cannot draw is cast again.
bool can_be_drawn(const std::string& to) { return to != "octahedral" && to != "equal-area"; }

TEST_F(Golden, ARoomIsDrawnAsItWasCast) {
  ASSERT_EQ(shell("python3 \"" ENVMAP_SCENES "/make.py\" .").status, 0);
  for (const std::string to : projections) {
    std::vector<std::string> words{"render", "room-4.glb", "out.exr", "--to", to,           "--size",
                                   "16",     "--ambient",  "0.3",     "--at", "0.3,0.2,0.1"};
    for (const char* word : {"--method", "exact", "--context", on_processor()})
      if (can_be_drawn(to)) words.emplace_back(word);
    if (!can_be_drawn(to)) words.insert(words.end(), {"--method", "raycast"});
    succeeds(words);
    const Result r = envmap({"compare", "out.exr", kept("room-" + to), "--max-rms", "1e-2"});  // Edges of shadows.
    EXPECT_EQ(r.status, 0) << to << "\n" << r.out << r.err;
  }
}

}  // namespace
}  // namespace command_tests::golden_test
