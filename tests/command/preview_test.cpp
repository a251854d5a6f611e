// Pictures for people, pixel by pixel against what the maps hold.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "picture.h"
#include "run.h"

namespace command_tests::preview_test {
namespace {

constexpr double byte = 1.0 / 255;
constexpr int border = 8, caption = 22;  // Of the sheet, in pixels.

double encoded(double linear) {  // IEC 61966-2-1.
  const double x = std::min(1.0, std::max(0.0, linear));
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

class Preview : public CommandTest {
 protected:
  Picture preview(std::vector<std::string> options) const {
    options.insert(options.begin(), "preview");
    options.emplace_back("out.png");
    succeeds(options);
    return load(path("out.png"));
  }
  static void expect_colour(const float* pixel, const std::array<double, 3>& linear, double within = 1.01 * byte) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(pixel[k], encoded(linear[k]), within) << "channel " << k;
  }
  static std::array<double, 3> of_direction(const Vec& d) {
    const auto c = colour_of(d);
    return {c[0], c[1], c[2]};
  }
  // The sphere's upper half 8, its lower 2.
  void write_halves() const {
    Picture halves = Picture::filled(64, 32, 8);
    for (int j = 16; j < 32; ++j) std::fill_n(halves.at(0, j), 64 * 3, 2.0F);
    save(path("halves.exr"), halves);
  }
};

TEST_F(Preview, WhiteOfBytesStaysWhite) {
  Picture picture = Picture::filled(64, 32, 1);
  std::fill_n(picture.at(0, 16), 64 * 16 * 3, 0.25F);
  save(path("in.png"), picture, OIIO::TypeDesc::UINT8);
  const Picture shown = preview({"in.png", "--height", "64"});
  EXPECT_EQ(*shown.at(border + 64, border + 10), 1);
  EXPECT_NEAR(*shown.at(border + 64, border + 50), 64 * byte, 1.01 * byte);
}

TEST_F(Preview, APageOfAReadOnlyMap) {
  write_halves();
  std::filesystem::permissions(path("halves.exr"), std::filesystem::perms::owner_read);
  EXPECT_EQ(envmap({"preview", "halves.exr", "--html", "page.html", "-q"}).status, 0);
  EXPECT_TRUE(read("page.html").starts_with("<!"));
  fails(2, {"preview", "halves.exr", "page.html"}, {"--html"});
  fails(2, {"preview", "halves.exr", "--html", "halves.exr"}, {"both input and output"});
}

TEST_F(Preview, APercentileBecomesWhite) {
  write_halves();
  const Picture low = preview({"halves.exr", "--height", "64", "--percentile", "40", "--display", "clip"});
  // To a 16th of a stop.
  expect_colour(low.at(border + 64, border + 50), {2.0 / 2.08, 2.0 / 2.08, 2.0 / 2.08}, 4 * byte);
  const Picture high = preview({"halves.exr", "--height", "64", "--percentile", "99", "--display", "clip"});
  expect_colour(high.at(border + 64, border + 50), {0.24, 0.24, 0.24}, 4 * byte);
  fails(2, {"preview", "halves.exr", "out.png", "--percentile", "40", "--exposure", "1"}, {"--exposure"});
}

// White lies beyond the stops that a histogram counts.
TEST_F(Preview, HistogramsReachAsFarAsWhite) {
  write_halves();
  for (const std::string stops : {"-100", "100"})
    EXPECT_GT(preview({"halves.exr", "--histogram", "--exposure", stops}).height, 0) << stops;
}

TEST_F(Preview, WritesNamesOrSaysThatThereIsNoFont) {
  write_halves();
  const auto lightest_of_caption = [](const Picture& p) {
    return *std::max_element(p.at(0, p.height - border - caption), p.at(0, p.height - border));
  };
  EXPECT_GT(lightest_of_caption(preview({"halves.exr"})), 0.5);
  const Result r = shell("HOME=$PWD XDG_DATA_HOME= XDG_DATA_DIRS=$PWD \"$ENVMAP\" preview halves.exr bare.png");
  EXPECT_EQ(r.status, 0);
  EXPECT_NE(r.err.find("no font, so the picture has no words: install "), std::string::npos) << r.err;
  EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1);
  EXPECT_LT(lightest_of_caption(load(path("bare.png"))), 0.2);
}

// Files whose names are the expected captions.
TEST_F(Preview, CaptionsEndAfterAWordAndNameTheRoughness) {
  const auto last_caption = [&](const std::vector<std::string>& options) {
    const Picture p = preview(options);
    return std::vector<float>(p.at(0, p.height - border - caption), p.at(0, p.height - border));
  };
  const std::string level = "c level 1, roughness 1", wide = "aaa " + std::string(60, 'w');
  for (const std::string& name : {std::string("aaa..."), wide, level})
    succeeds({"generate", "sky", name, "--format", "exr", "--to", "cube", "--size", "8"});
  EXPECT_EQ(last_caption({wide, "--height", "64"}), last_caption({"aaa...", "--height", "64"}));
  succeeds({"prefilter", level, "c", "--format", "exr", "--lobe", "ggx", "--size", "8", "--levels", "2", "-q"});
  EXPECT_EQ(last_caption({"c", "--levels", "--columns", "1"}), last_caption({level}));
}

TEST_F(Preview, SingleFacesAndMarks) {
  succeeds({"generate", "directions", "in.exr", "--to", "cube", "--size", "64"});
  const Picture face = preview({"in.exr", "--height", "64", "--face", "py", "--exposure", "0", "--display", "clip"});
  EXPECT_EQ(face.width, 64 + 2 * border);
  expect_colour(face.at(border + 32, border + 32), of_direction({0, 1, 0}), 3 * byte);
  expect_colour(face.at(border + 63, border + 32), of_direction({1, 1, 0}), 4 * byte);
  fails(2, {"preview", "in.exr", "out.png", "--face", "up"}, {"--face"});
}

// Round the one bright texel, (64, 16) of 128 x 64; the text is 10 pixels high, so the ring is 7 wide.
// Files that do not say what they are: a map is shown as it is where its projection is given for it alone.
TEST_F(Preview, EachMapHasItsProjection) {
  succeeds({"generate", "directions", "known.exr", "--to", "sphere", "--size", "32"});
  save(path("ball.exr"), load(path("known.exr")));
  write_halves();
  const std::vector<std::string> look{"--height", "64", "--exposure", "0"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.end(), look.begin(), look.end());
    return preview(words);
  };
  const Picture both = with({"ball.exr", "halves.exr", "--from", "sphere,latlong", "--columns", "1"});
  const Picture ball = with({"ball.exr", "--from", "sphere"}), halves = with({"halves.exr"});
  // The narrower of the two stands in the middle.
  const int across = 64, left = (both.width - across) / 2, second = 64 + caption + border;
  for (int j = border; j < border + 64; ++j) {
    EXPECT_TRUE(std::equal(both.at(left, j), both.at(left + across, j), ball.at(border, j))) << j;
    EXPECT_TRUE(
        std::equal(both.at(border, second + j), both.at(border + 2 * across, second + j), halves.at(border, j)));
  }
  fails(2, {"preview", "ball.exr", "halves.exr", "out.png", "--from", "sphere,latlong,cube"},
        {"3 projections for 2 maps"});
  fails(2, {"preview", "ball.exr", "halves.exr", "out.png", "--from", "sphere,flat"}, {"--from"});
}

TEST_F(Preview, MarksTheBrightestDirection) {
  Picture dark = Picture::filled(128, 64, 0.1F);
  std::fill_n(dark.at(64, 16), 3, 9.0F);
  save(path("in.exr"), dark);
  const Picture marked = preview({"in.exr", "--height", "256", "--marks"}),
                plain = preview({"in.exr", "--height", "256"});
  const auto at = [](const Picture& p, int x, int y) { return *p.at(border + 258 + x, border + 66 + y); };
  for (const auto& [x, y] : {std::pair{6, 0}, {-7, 0}, {0, 6}, {0, -7}})
    EXPECT_EQ(at(marked, x, y), 1) << x << " " << y;
  for (const auto& [x, y] : {std::pair{7, 0}, {-8, 0}, {0, 7}, {0, -8}})
    EXPECT_EQ(at(marked, x, y), 0) << x << " " << y;
  for (const int x : {0, 3, 12, 30}) EXPECT_EQ(at(marked, x, 0), at(plain, x, 0)) << x;
  fails(2, {"preview", "in.exr", "out.png", "--face", "py"}, {"in.exr", "latlong"});
}

// By the definitions: a mirror shows the mirrored direction; white diffuse under radiance (1 + d) / 2 is (1 + 2/3 n) /
// 2.
TEST_F(Preview, BallsAreLitByTheMap) {
  succeeds({"generate", "directions", "in.exr", "--size", "64"});
  const Picture sheet = preview({"in.exr", "--height", "64", "--balls", "--exposure", "0", "--display", "clip"});
  constexpr int ball = (640 - 4 * border) / 5;
  const int top = border + 64 + caption + border;
  const auto at = [&](int k, int i, int j) { return sheet.at(border + k * (ball + border) + i, top + j); };
  for (const auto& [i, j] : {std::pair{60, 60}, {30, 60}, {60, 25}, {90, 80}}) {
    const double s = (2 * i + 1.0) / ball - 1, t = 1 - (2 * j + 1.0) / ball, z = std::sqrt(1 - s * s - t * t);
    expect_colour(at(0, i, j), of_direction({2 * z * s, 2 * z * t, 2 * z * z - 1}), 3 * byte);
    expect_colour(at(4, i, j), {0.5 + s / 3, 0.5 + t / 3, 0.5 + z / 3}, 3 * byte);
    // Rough balls lie between: of a map that is linear in direction a lobe keeps the direction, and takes contrast.
    const double mirror = std::abs(*at(0, i, j) - encoded(0.5)), rough = std::abs(*at(3, i, j) - encoded(0.5));
    EXPECT_LE(rough, mirror + 2 * byte);
  }
}

TEST_F(Preview, AHistogramHasItsBarsWhereTheLightIs) {
  write_halves();
  // White is at 2, so that stops 0 to 4 are shown, 160 pixels each.
  const Picture sheet = preview({"halves.exr", "--height", "64", "--histogram", "--exposure", "-1"});
  const int y = border + 64 + caption + border + 14;  // Just above the ground line.
  const auto is_bar = [&](int x) { return std::abs(*sheet.at(border + x, y) - 0.5F) < 0.01F; };
  EXPECT_TRUE(is_bar(160 + 15) && is_bar(480 + 15));
  for (const int x : {20, 100, 230, 330, 440, 600}) EXPECT_FALSE(is_bar(x)) << x;
}

TEST_F(Preview, WritesJpeg) {
  succeeds({"generate", "sky", "in.exr", "--size", "32"});
  succeeds({"preview", "in.exr", "out.jpg", "--sheet"});
  EXPECT_TRUE(bytes_of(path("out.jpg")).starts_with("\xFF\xD8\xFF"));
  fails(2, {"preview", "in.exr", "out.gif"}, {"out.gif", ".jpg"});
}

TEST_F(Preview, ShowsAViewOfAConfig) {
  succeeds({"generate", "constant", "in.exr", "--size", "16", "--value", "0.25,0.25,0.25"});
  write("film.ocio",
        "ocio_profile_version: 2\nroles: {default: linear, scene_linear: linear}\ndisplays:\n  Monitor:\n"
        "    - !<View> {name: Film, colorspace: film}\n    - !<View> {name: Raw, colorspace: linear}\ncolorspaces:\n"
        "  - !<ColorSpace> {name: lin_rec709}\n  - !<ColorSpace> {name: linear}\n"
        "  - !<ColorSpace>\n    name: film\n    from_scene_reference: !<ExponentTransform> {value: [0.5, 0.5, 0.5, "
        "1]}\n");
  const auto middle = [&](const std::string& view) {
    return *preview({"in.exr", "--height", "32", "--exposure", "0", "--ocio", "film.ocio", "--view", view})
                .at(border + 32, border + 16);
  };
  EXPECT_NEAR(middle("Film"), 0.5, byte);
  EXPECT_NEAR(middle("Monitor:Raw"), 0.25, byte);
  fails(2, {"preview", "in.exr", "out2.png", "--ocio", "film.ocio", "--view", "Films"}, {"'Films'", "Film, Raw"});
  fails(2, {"preview", "in.exr", "out2.png", "--ocio", "builtin", "--view", "Film"}, {"has no views"});
}

TEST_F(Preview, PicturesOfMapsAreTakenByConvert) {
  save(path("map.exr"), cube_directions("column", 64));
  // Towards +X, its right is +Z: a field of 90 degrees shows the face, as any other reader of the file finds it.
  succeeds({"convert", "map.exr", "view.exr", "--to", "perspective", "--fov", "90", "--look-at", "1,0,0", "--size",
            "64", "--width", "64", "--samples", "1"});
  EXPECT_LT(difference(load(path("view.exr")), face_directions(0, 64)), 1e-6);
  succeeds({"convert", "map.exr", "view.png", "--to", "fisheye", "--size", "40"});
  const Picture fish = load(path("view.png"));
  EXPECT_EQ(fish.width, 40);
  expect_colour(fish.at(0, 0), {0, 0, 0});
  expect_colour(fish.at(20, 20), of_direction({0, 0, 1}), 0.02);
  succeeds({"convert", "map.exr", "round.jpg", "--to", "cylinder", "--size", "40"});
  EXPECT_EQ(load(path("round.jpg")).width, 125);  // 40 pi.
  fails(2, {"convert", "map.exr", "view.png", "--to", "perspective", "--layout", "row"}, {"--layout is for maps"});
  fails(2, {"convert", "map.exr", "view.png", "--to", "perspective", "--zstd"}, {"--zstd is for maps"});
  fails(2, {"convert", "map.exr", "out.exr", "--to", "latlong", "--fov", "40"}, {"--fov is for", "fisheye"});
  fails(2, {"convert", "map.exr", "view.png", "--to", "perspective", "--fov", "180"}, {"less than 180"});
  fails(2, {"convert", "map.exr", "view.png", "--to", "perspective", "--filter", "sat"},
        {"do not take the filter sat"});
  fails(2, {"convert", "map.exr", "view.ktx2", "--to", "perspective"}, {"view.ktx2", ".png, .jpg, .exr or .hdr"});
}

TEST_F(Preview, ClippedLightIsTold) {
  succeeds({"generate", "constant", "four.exr", "--size", "8", "--value", "4"});
  EXPECT_EQ(envmap({"convert", "four.exr", "map.png", "--display", "clip"}).err,
            "map.png: clamped 128 texels, 75% of the flux lost\n");
  succeeds({"convert", "four.exr", "map.png", "--display", "neutral"});
  const std::vector<std::string> view{"convert", "four.exr", "view.png", "--to", "perspective",
                                      "--size",  "8",        "--width",  "8"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.begin(), view.begin(), view.end());
    return words;
  };
  const Result clipped = envmap(view);
  EXPECT_EQ(clipped.status, 0);
  EXPECT_NE(clipped.err.find("clipped 64 pixels at 1, 75% of the light lost: use --display neutral"), std::string::npos)
      << clipped.err;
  succeeds(with({"-q"}));
  succeeds(with({"--display", "neutral"}));
}

}  // namespace
}  // namespace command_tests::preview_test
