// Operations that take long end soon after they are asked to: by processor time, which a busy machine does not change.
#include <gtest/gtest.h>

#include <chrono>
#include <ctime>
#include <functional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "envmap/envmap.h"

namespace cancel_test {
namespace {

using namespace envmap;

struct Operation {
  std::string name;
  std::function<void(const Run&)> run;
};

// Each takes seconds on the machine that this was written on.
std::vector<Operation> operations() {
  static const EnvironmentMap sky = generate(Sun{.radius_degrees = 2}, Projection::latlong, 512);
  static const EnvironmentMap ball = generate(Sun{.radius_degrees = 2}, Projection::sphere, 1024);
  static const Prefilterer source(sky);
  const auto lobe = [](LobeShape shape, double parameter, int size, double error) {
    return [=](const Run& run) {
      (void)source.make({.lobe = Lobe(shape, parameter), .size = size, .max_error = error}, run);
    };
  };
  return {
      {"a source's cube", [](const Run& run) { (void)Prefilterer(ball, run); }},
      {"charlie", lobe(LobeShape::charlie, 0.3, 256, 1e-3)},
      {"ggx .3", lobe(LobeShape::ggx, 0.3, 1024, 1e-5)},
      {"ggx .1", lobe(LobeShape::ggx, 0.1, 1024, 1e-5)},
      {"phong 20", lobe(LobeShape::phong, 20, 1024, 1e-5)},
      {"a chosen filter",
       [](const Run& run) {
         (void)Resampler(sky, {.to = Projection::octahedral, .size = 2000, .max_error = 1e-7}, run);
       }},
      {"area",
       [](const Run& run) {
         (void)convert(sky, {.to = Projection::sphere, .size = 2000, .filter = Filter::area}, run);
       }},
      {"a sky", [](const Run& run) { (void)generate(Atmosphere{}, Projection::latlong, 1024, run); }},
      {"harmonics", [](const Run& run) { (void)project(sky, 200, run); }},
      {"a series",
       [](const Run& run) {
         static const Harmonics h = project(sky, 60);
         (void)evaluate(h, Projection::latlong, 2048, Forward::plus_z, run);
       }},
      {"blocks", [](const Run& run) { (void)pack(sky, {.format = PixelFormat::bc6h, .clamp = true}, run); }},
      {"a table", [](const Run& run) { (void)brdf_table(512, run); }},
  };
}

double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

TEST(Cancel, EndsSoon) {
  for (const Operation& operation : operations())
    for (const int milliseconds : {0, 20, 100, 300, 700}) {
      std::stop_source button;
      double asked = 0, ended = 0;
      bool cancelled = false;
      std::thread caller([&] {
        try {
          operation.run({.stop = button.get_token(), .threads = 2});
        } catch (const Cancelled&) {
          cancelled = true;
        }
        ended = processor_seconds();
      });
      std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
      asked = processor_seconds();
      button.request_stop();
      caller.join();
      // 0.19 s at most were measured on a quiet machine with two cores.
      EXPECT_LT(ended - asked, 1) << operation.name << " after " << milliseconds << " ms";
      EXPECT_TRUE(cancelled || milliseconds > 20) << operation.name << " after " << milliseconds << " ms";
    }
}

TEST(Cancel, EndsACallThatWaitsForItsTurn) {
  const Prefilterer source(generate(Sun{.radius_degrees = 2}, Projection::latlong, 512));
  std::stop_source first, second;
  std::thread working([&] {
    try {
      (void)source.make({.lobe = Lobe::ggx(0.3), .size = 1024, .max_error = 1e-5}, {.stop = first.get_token()});
    } catch (const Cancelled&) {
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  bool cancelled = false;
  std::thread waiting([&] {
    try {
      (void)source.make({.size = 8}, {.stop = second.get_token()});
    } catch (const Cancelled&) {
      cancelled = true;
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  second.request_stop();
  waiting.join();
  const bool first_goes_on = !first.stop_requested();
  first.request_stop();
  working.join();
  EXPECT_TRUE(cancelled);
  EXPECT_TRUE(first_goes_on);
}

// An operation that is not stopped is not changed by one that is, in another thread.
TEST(Cancel, LeavesOthersAlone) {
  const EnvironmentMap sky = generate(Sun{.radius_degrees = 5}, Projection::latlong, 128);
  const EnvironmentMap wanted = convert(sky, {.size = 128, .filter = Filter::area});
  std::stop_source button;
  std::thread stopped([&] {
    try {
      (void)convert(sky, {.to = Projection::sphere, .size = 1000, .filter = Filter::area},
                    {.stop = button.get_token()});
    } catch (const Cancelled&) {
    }
  });
  button.request_stop();
  EXPECT_EQ(compare(convert(sky, {.size = 128, .filter = Filter::area}), wanted).maximum, 0);
  stopped.join();
}

}  // namespace
}  // namespace cancel_test
