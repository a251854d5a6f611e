// Photos of mirror balls and by fisheye lenses as users bring them. Each pixel is the direction that it shows, traced
// here: rays and lens formulae of the test's own.
#include <cmath>
#include <nlohmann/json.hpp>

#include "picture.h"
#include "run.h"

namespace command_tests::photo_test {
namespace {

class Photos : public CommandTest {};

constexpr double pi = 3.14159265358979323846;

double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Direction that a mirror ball of radius 1 shows at (x, y) of its outline to a camera at (0, 0, distance).
Vec mirrored(double distance, double x, double y) {
  const double z = -std::sqrt(distance * distance - 1), length = std::sqrt(x * x + y * y + z * z);
  const Vec ray{x / length, y / length, z / length};
  const double b = distance * ray[2], k = -b - std::sqrt(std::max(0.0, b * b - distance * distance + 1));
  const Vec n{k * ray[0], k * ray[1], distance + k * ray[2]};
  const double twice = 2 * dot(n, ray);
  return {ray[0] - twice * n[0], ray[1] - twice * n[1], ray[2] - twice * n[2]};
}

struct Ball {
  double x, y, radius, distance;
};

// The ball in a room whose light is the map of directions, before a background of its own; 4 x 4 samples a pixel.
Picture photo_of(const Ball& ball, int width, int height, double texture) {
  Picture p = Picture::filled(width, height);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      for (int k = 0; k < 16; ++k) {
        const double px = i + (k % 4 + 0.5) / 4, py = j + (k / 4 + 0.5) / 4;
        const double x = (px - ball.x) / ball.radius, y = (ball.y - py) / ball.radius;
        const bool hit = x * x + y * y < 1;
        const auto seen = hit ? colour_of(mirrored(ball.distance, x, y)) : std::array<float, 3>{};
        const auto wall = float(0.1 + texture * (1 + std::sin(px / 5) * std::sin(py / 7)));
        for (int c = 0; c < 3; ++c) p.at(i, j)[c] += (hit ? seen[std::size_t(c)] : wall) / 16;
      }
  return p;
}

// Largest difference from the map of directions, within `most` radians of an axis.
double off_directions(const Picture& panorama, const Vec& axis, double most) {
  const Picture expected = latlong_directions(panorama.height);
  double largest = 0;
  for (int j = 0; j < panorama.height; ++j)
    for (int i = 0; i < panorama.width; ++i) {
      const float* e = expected.at(i, j);
      if (dot({2.0 * e[0] - 1, 2.0 * e[1] - 1, 2.0 * e[2] - 1}, axis) < std::cos(most)) continue;
      for (int c = 0; c < 3; ++c) largest = std::max(largest, double(std::abs(panorama.at(i, j)[c] - e[c])));
    }
  return largest;
}

TEST_F(Photos, ABallThatIsFoundBecomesTheMapItMirrors) {
  const std::vector<std::pair<Ball, double>> balls{{{210.3, 170.8, 120.6, 8}, 0},
                                                   {{300.9, 150.2, 99.7, 20}, 0.3},
                                                   {{160.4, 190.6, 140.2, 4}, 0.1}};
  for (const auto& [ball, texture] : balls) {
    save(path("photo.exr"), photo_of(ball, 480, 360, texture));
    const auto r =
        report({"convert", "photo.exr", "map.pfm", "--from", "sphere", "--circle", "find", "--to", "latlong", "--size",
                "64", "--ball-distance", std::to_string(ball.distance), "--circle-picture", "found.png"});
    EXPECT_NEAR(r["circle"]["x"], ball.x, 0.5);
    EXPECT_NEAR(r["circle"]["y"], ball.y, 0.5);
    EXPECT_NEAR(r["circle"]["radius"], ball.radius, 0.5);
    EXPECT_GT(r["circle"]["support"], 0.5);
    EXPECT_LT(off_directions(load(path("map.pfm")), {0, 0, 1}, 2.2), 0.02) << texture;
    const Picture drawn = load(path("found.png"));
    EXPECT_EQ(drawn.width, 480);
    EXPECT_EQ(drawn.height, 360);
    // Given as it is, it is a little nearer.
    succeeds({"convert", "photo.exr", "map.pfm", "--from", "sphere", "--to", "latlong", "--size", "64", "--circle",
              std::to_string(ball.x) + "," + std::to_string(ball.y) + "," + std::to_string(ball.radius),
              "--ball-distance", std::to_string(ball.distance), "-q"});
    EXPECT_LT(off_directions(load(path("map.pfm")), {0, 0, 1}, 2.5), 0.02) << texture;
  }
}

TEST_F(Photos, ThePictureHasTheRingWhereTheBallIs) {
  save(path("photo.png"), photo_of({100, 80, 60, 10}, 240, 160, 0.1), OIIO::TypeDesc::UINT8);
  succeeds({"convert", "photo.png", "map.exr", "--from", "sphere", "--circle", "100,80,60", "--circle-picture",
            "ring.png", "--to", "latlong", "-q"});
  succeeds({"convert", "photo.png", "map.exr", "--from", "sphere", "--circle", "100,80,50", "--circle-picture",
            "other.png", "--to", "latlong", "-q"});
  const Picture ring = load(path("ring.png")), other = load(path("other.png"));
  for (int j = 0; j < 160; ++j)
    for (int i = 0; i < 240; ++i) {
      const double r = std::hypot(i + 0.5 - 100, j + 0.5 - 80);
      const bool near = std::abs(r - 60) < 4 || std::abs(r - 50) < 4 || r < 8;
      if (!near) {
        ASSERT_EQ(ring.at(i, j)[1], other.at(i, j)[1]);
      }
    }
  EXPECT_GT(std::abs(ring.at(159, 80)[1] - other.at(159, 80)[1]), 0.1);
}

TEST_F(Photos, ACroppedBallIsTheSameWithItsCircle) {
  const Picture whole = photo_of({60, 60, 60, 6}, 120, 120, 0);
  save(path("photo.exr"), whole);
  for (const std::string to : {"latlong", "cube"}) {
    succeeds({"convert", "photo.exr", "cropped.pfm", "--from", "sphere", "--to", to, "--ball-distance", "6", "-q"});
    succeeds({"convert", "photo.exr", "circle.pfm", "--from", "sphere", "--to", to, "--ball-distance", "6", "--circle",
              "60,60,60", "-q"});
    const Picture a = load(path("cropped.pfm")), b = load(path("circle.pfm"));
    int differ = 0;
    for (std::size_t k = 0; k < a.values.size(); ++k) differ += a.values[k] != b.values[k];
    EXPECT_LT(differ, int(a.values.size() / 8)) << "only near the rim";
  }
}

TEST_F(Photos, RefusesWhereItIsNotSure) {
  save(path("none.exr"), Picture::filled(200, 150, 0.4F));
  fails(3, {"convert", "none.exr", "map.exr", "--from", "sphere", "--circle", "find"}, {"none.exr", "--circle X,Y,R"});
  Picture two = photo_of({100, 120, 70, 10}, 400, 240, 0);
  const Picture right = photo_of({290, 120, 72, 10}, 400, 240, 0);
  for (int j = 0; j < 240; ++j) std::copy(right.at(200, j), right.at(200, j) + 600, two.at(200, j));
  save(path("two.exr"), two);
  fails(3, {"convert", "two.exr", "map.exr", "--from", "sphere", "--circle", "find"}, {"two circles", "--circle"});
  fails(3, {"convert", "two.exr", "map.exr", "--from", "sphere", "--circle", "100,120,130"}, {"beyond the picture"});
  for (const std::string circle : {"3,4", "a,b,c", "10,10,-3", "10,10,nan", "seek"})
    fails(2, {"convert", "two.exr", "map.exr", "--from", "sphere", "--circle", circle}, {"--circle", "find"});
}

// Equidistant and equisolid: what a lens shows at r of its circle.
Picture fisheye_of(double degrees, bool equisolid, double turn, int width, int height, double x0, double y0,
                   double radius) {
  Picture p = Picture::filled(width, height, 7);
  const double half = degrees * pi / 360;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const double x = (i + 0.5 - x0) / radius, y = (y0 - j - 0.5) / radius, r = std::hypot(x, y);
      if (r >= 1) continue;
      const double angle = equisolid ? 2 * std::asin(r * std::sin(half / 2)) : r * half;
      const double k = r > 0 ? std::sin(angle) / r : 0, a = -x * k, c = std::cos(angle);
      const auto seen =
          colour_of({a * std::cos(turn) + c * std::sin(turn), y * k, c * std::cos(turn) - a * std::sin(turn)});
      std::copy(seen.begin(), seen.end(), p.at(i, j));
    }
  return p;
}

TEST_F(Photos, FisheyesLookAlongTheForwardAxis) {
  const std::vector<std::tuple<std::string, double, Vec>> axes{{"+z", 0, {0, 0, 1}},
                                                               {"-z", pi, {0, 0, -1}},
                                                               {"+x", pi / 2, {1, 0, 0}},
                                                               {"-x", -pi / 2, {-1, 0, 0}}};
  for (const bool equisolid : {false, true})
    for (const auto& [axis, turn, towards] : axes) {
      save(path("fish.exr"), fisheye_of(180, equisolid, turn, 256, 256, 128, 128, 128));
      const auto r = report({"convert", "fish.exr", "map.pfm", "--from", equisolid ? "equisolid" : "fisheye", "--to",
                             "latlong", "--size", "64", "--from-forward", axis});
      EXPECT_NEAR(r["covered"], 0.5, 1e-3);
      const Picture map = load(path("map.pfm"));
      EXPECT_LT(off_directions(map, towards, pi / 2 - 0.05), 0.02) << axis;
      double behind = 0;
      const Picture directions = latlong_directions(64);
      for (int j = 0; j < 64; ++j)
        for (int i = 0; i < 128; ++i) {
          const float* d = directions.at(i, j);
          if (dot({2.0 * d[0] - 1, 2.0 * d[1] - 1, 2.0 * d[2] - 1}, towards) < -0.05)
            behind = std::max(behind, double(map.at(i, j)[0]));
        }
      EXPECT_LT(behind, 1e-9) << axis;
    }
}

TEST_F(Photos, ASecondFisheyeFillsTheRest) {
  for (const int degrees : {180, 200}) {
    save(path("front.exr"), fisheye_of(degrees, false, 0, 400, 300, 190.5, 152.25, 140));
    save(path("back.exr"), fisheye_of(degrees, false, pi, 400, 300, 190.5, 152.25, 140));
    const auto r = report({"convert", "front.exr", "map.pfm", "--from", "fisheye", "--fov", std::to_string(degrees),
                           "--circle", "190.5,152.25,140", "--back", "back.exr", "--to", "latlong", "--size", "48"});
    EXPECT_NEAR(r["covered"], 1, 1e-3);
    EXPECT_LT(off_directions(load(path("map.pfm")), {0, 0, 1}, 4), 0.03);
  }
}

// As 360 cameras save it: two lenses whose circles differ.
TEST_F(Photos, BothFisheyesMayBeInOnePicture) {
  const Picture left = fisheye_of(190, false, 0, 300, 300, 148.5, 152.25, 140),
                right = fisheye_of(190, false, pi, 300, 300, 151, 149.5, 136);
  const auto place = [&](Picture& both, const Picture& one, int x0, int y0) {
    for (int j = 0; j < 300; ++j)
      for (int i = 0; i < 300; ++i)
        for (int c = 0; c < 3; ++c) both.at(x0 + i, y0 + j)[c] = one.at(i, j)[c] == 7 ? 0 : one.at(i, j)[c];
  };
  Picture beside = Picture::filled(600, 300), below = Picture::filled(300, 600);
  place(beside, left, 0, 0), place(beside, right, 300, 0);
  place(below, left, 0, 0), place(below, right, 0, 300);
  save(path("beside.exr"), beside);
  save(path("below.exr"), below);
  const auto check = [&](const std::string& file, const std::string& circle, const std::string& back) {
    const auto r = report({"convert", file, "map.pfm", "--from", "fisheye", "--fov", "190", "--circle", circle,
                           "--back-circle", back, "--to", "latlong", "--size", "48", "-q"});
    EXPECT_NEAR(r["covered"], 1, 1e-3);
    EXPECT_LT(off_directions(load(path("map.pfm")), {0, 0, 1}, 4), 0.03) << file << circle;
    return r;
  };
  check("beside.exr", "148.5,152.25,140", "451,149.5,136");
  check("below.exr", "148.5,152.25,140", "151,449.5,136");
  const auto found = check("beside.exr", "find", "find");
  EXPECT_NEAR(found["circle"]["x"], 148.5, 0.5);
  EXPECT_NEAR(found["back_circle"]["x"], 451, 0.5);
  EXPECT_NEAR(found["back_circle"]["radius"], 136, 0.5);
  check("below.exr", "find", "find");
  fails(3, {"convert", "beside.exr", "map.exr", "--from", "fisheye", "--circle", "find"},
        {"two circles", "--back-circle find"});
  // Of two files each has a circle of its own.
  save(path("front.exr"), left);
  save(path("back.exr"), right);
  (void)report({"convert", "front.exr", "map.pfm", "--from", "fisheye", "--fov", "190", "--circle", "find", "--back",
          "back.exr", "--to", "latlong", "--size", "48", "-q"});
  EXPECT_LT(off_directions(load(path("map.pfm")), {0, 0, 1}, 4), 0.03);
}

TEST_F(Photos, OneHalfOfAParaboloid) {
  succeeds({"generate", "directions", "{half}.exr", "--to", "paraboloid", "--size", "64"});
  const auto r = report({"convert", "front.exr", "map.pfm", "--from", "half-paraboloid", "--to", "latlong"});
  EXPECT_EQ(r["covered"], 0.5);
  EXPECT_LT(off_directions(load(path("map.pfm")), {0, 0, 1}, pi / 2 - 0.1), 0.02);
  // Both halves are the map.
  succeeds({"convert", "front.exr", "both.exr", "--from", "half-paraboloid", "--back", "back.exr", "--to", "cube"});
  succeeds({"convert", "{half}.exr", "files.exr", "--to", "cube"});
  succeeds({"compare", "both.exr", "files.exr", "--max-error", "0"});
}

TEST_F(Photos, OptionsThatContradictEachOther) {
  save(path("photo.exr"), photo_of({100, 80, 60, 10}, 240, 160, 0.1));
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong{
      {{"--from", "latlong", "--circle", "find"}, "--circle is for"},
      {{"--circle", "find"}, "--circle is for"},
      {{"--from", "half-paraboloid", "--circle", "find"}, "--circle is for"},
      {{"--from", "sphere", "--circle-picture", "x.png"}, "use --circle"},
      {{"--from", "sphere", "--circle", "find", "--back-circle", "find"}, "--back-circle is for"},
      {{"--from", "fisheye", "--back-circle", "find"}, "--back-circle is for"},
      {{"--from", "fisheye", "--circle", "find", "--back-circle", "1,2"}, "--back-circle: '1,2'"},
      {{"--from", "fisheye", "--circle-picture", "x.exr"}, ".png or .jpg"},
      {{"--from", "sphere", "--circle", "find", "--back", "photo2.exr"}, "--back is for"},
      {{"--from", "sphere", "--circle", "find", "--fov", "100"}, "--fov is for"},
      {{"--from", "fisheye", "--level", "1"}, "--level"},
      {{"--from", "fisheye", "--to", "perspective"}, "a map first"},
      {{"--from", "sphere", "--circle", "100,80,60", "--from-forward", "-z"}, "--rotate"},
      {{"--from", "fisheye", "--ball-distance", "7"}, "--ball-distance"}};
  save(path("photo2.exr"), photo_of({100, 80, 60, 10}, 240, 160, 0.1));
  for (const auto& [options, words] : wrong) {
    std::vector<std::string> all{"convert", "photo.exr", "map.exr"};
    all.insert(all.end(), options.begin(), options.end());
    all.emplace_back("-q");
    fails(2, all, {words});
  }
}

TEST_F(Photos, ThePictureAndTheBackAreInTheDepfile) {
  save(path("front.exr"), fisheye_of(180, false, 0, 64, 64, 32, 32, 32));
  save(path("back.exr"), fisheye_of(180, false, pi, 64, 64, 32, 32, 32));
  succeeds({"convert", "front.exr", "map.exr", "--from", "fisheye", "--back", "back.exr", "--circle-picture", "c.png",
            "--depfile", "map.d"});
  const std::string made = read("map.d");
  for (const std::string name : {"map.exr", "c.png", "front.exr", "back.exr"})
    EXPECT_NE(made.find(name), made.npos) << name << made;
}

}  // namespace
}  // namespace command_tests::photo_test
