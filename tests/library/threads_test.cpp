// Ownership, threads, progress and cancellation.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <filesystem>
#include <functional>
#include <mutex>
#include <set>
#include <stdexcept>
#include <stop_token>
#include <thread>
#include <vector>

#include "envmap/envmap.h"

namespace threads_test {
namespace {

using namespace envmap;

bool same(const EnvironmentMap& a, const EnvironmentMap& b) {
  for (int face = 0; face < a.base().faces(); ++face)
    for (int j = 0; j < a.base().height(); ++j)
      if (!std::ranges::equal(a.base().row(face, j), b.base().row(face, j))) return false;
  return true;
}

EnvironmentMap sun(int size) { return generate(Sun{.radius_degrees = 5}, Projection::latlong, size); }

// A map that is given away lives as long as what reads it. Under the address sanitizer this fails where it does not.
TEST(Ownership, WhatIsGivenAwayIsKept) {
  const EnvironmentMap map = sun(32);
  const Prefilterer copied(sun(32)), lent(borrowed(map)), given(std::make_shared<const EnvironmentMap>(sun(32)));
  for (const double roughness : {0.05, 0.3, 1.0}) {
    const PrefilterOptions wanted{.lobe = Lobe::ggx(roughness), .size = 8};
    const EnvironmentMap made = lent.make(wanted).map;
    EXPECT_TRUE(same(made, given.make(wanted).map)) << roughness;
    EXPECT_TRUE(same(made, copied.make(wanted).map)) << roughness;
  }
  const auto first = [](const Rows& rows) {
    std::vector<Colour> row(std::size_t(rows.width()));
    rows.fill(0, 3, row);
    return row;
  };
  const std::vector<Colour> wanted(map.base().row(0, 3).begin(), map.base().row(0, 3).end());
  EXPECT_EQ(first(rows_of(sun(32))), wanted);
  const Rows kept = rows_of(sun(32)), level = rows_of(sun(32).base().clone(), Forward::plus_z);
  const std::vector<Rows> all = all_rows_of(sun(32));
  EXPECT_EQ(first(kept), wanted);
  EXPECT_EQ(first(level), wanted);
  EXPECT_EQ(first(all.front()), wanted);
}

TEST(Threads, ShareAPrefilterer) {
  const Prefilterer source(sun(16));
  std::vector<PrefilterOptions> lobes;
  for (const Method method : {Method::automatic, Method::treecode})
    for (const double exponent : {1.0, 2.0, 20.0, 100.0})
      lobes.push_back({.lobe = Lobe::phong(exponent), .size = 8, .method = method});
  for (const double roughness : {0.05, 0.3, 0.9}) lobes.push_back({.lobe = Lobe::ggx(roughness), .size = 8});
  std::vector<EnvironmentMap> wanted;
  for (const PrefilterOptions& p : lobes) wanted.push_back(source.make(p).map);
  // Nothing depends on what was made before.
  std::atomic<int> wrong{0};
  const Prefilterer fresh(sun(16));
  const auto make_of = [&](const Prefilterer& from, std::size_t k) {
    k %= lobes.size();
    wrong += compare(from.make(lobes[k]).map, wanted[k]).maximum != 0;
  };
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (std::size_t k = 0; k < lobes.size(); ++k) {
        make_of(source, k + 3 * t);
        make_of(fresh, k + 5 * t);
      }
    });
  for (std::thread& t : threads) t.join();
  // From tasks of the caller's own loop, which a waiting thread would otherwise take while it holds the lock.
  tbb::parallel_for(std::size_t{0}, lobes.size(), [&](std::size_t k) { make_of(source, k); });
  EXPECT_EQ(wrong, 0);
}

using Operation = std::function<void(const Run&)>;

std::vector<Operation> operations() {
  static const EnvironmentMap map = sun(64);
  static const Prefilterer source(map);
  return {
      [](const Run& p) { (void)convert(map, {.size = 48, .filter = Filter::area}, p); },
      [](const Run& p) { (void)generate(Checker{}, Projection::cube, 64, p); },
      [](const Run& p) { (void)project(map, 4, p); },
      [](const Run& p) { (void)brdf_table(48, p); },
      [](const Run& p) { (void)sheen_table(48, p); },
      [](const Run& p) { (void)source.make({.size = 16}, p); },
      [](const Run& p) { (void)source.make({.lobe = Lobe::ggx(0.4), .size = 16}, p); },
      [](const Run& p) { (void)source.make({.lobe = Lobe::ggx(0.0), .size = 16}, p); },
      [](const Run& p) { (void)source.make({.lobe = Lobe::charlie(0.5), .size = 8}, p); },
      [](const Run& p) {
        (void)source.make_chain(std::vector{Lobe::ggx(0), Lobe::ggx(0.3), Lobe::ggx(1)}, {.size = 16}, p);
      },
      [](const Run& p) { (void)photograph(map.clone(), {.width = 32, .height = 32}, p); },
      [](const Run& p) { (void)read(encode(map, {.format = "exr"}), {}, p); },
      [](const Run& p) { (void)encode(map, {.format = "exr"}, p); },
      [](const Run& p) { (void)encode(map, {.format = "ktx2", .depth = Depth::bc6h, .clamp = true}, p); },
      [](const Run& p) { (void)pack(map, {.clamp = true}, p); },
  };
}

TEST(Progress, IsOneCallAtATimeRisingToOne) {
  const std::vector<Operation> all = operations();
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::atomic<int> inside{0}, most{0};
    std::vector<double> parts;
    const auto watch = [&](double part) {
      most = std::max(most.load(), ++inside);
      parts.push_back(part);
      std::this_thread::yield();
      --inside;
    };
    all[k]({.progress = watch});
    ASSERT_FALSE(parts.empty()) << k;
    EXPECT_EQ(most, 1) << k;
    EXPECT_TRUE(std::ranges::is_sorted(parts)) << k;
    EXPECT_GE(parts.front(), 0) << k;
    EXPECT_EQ(parts.back(), 1) << k;
    EXPECT_EQ(std::ranges::count(parts, 1.0), 1) << k;
  }
}

struct Thrown {};

TEST(Progress, AnExceptionCancels) {
  const auto stop = [](double) { throw Thrown(); };
  const std::vector<Operation> all = operations();
  for (std::size_t k = 0; k < all.size(); ++k) EXPECT_THROW(all[k]({.progress = stop}), Thrown) << k;
  EXPECT_THROW(write("cancelled.exr", sun(64), {}, {.progress = stop}), Thrown);
  EXPECT_FALSE(std::filesystem::exists("cancelled.exr"));
  // The source can be used again.
  EXPECT_NO_THROW(all[6]({}));
}

// Before it begins, and from another thread while it works, with a callback and without.
TEST(Run, IsStopped) {
  const std::vector<Operation> all = operations();
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::stop_source before;
    before.request_stop();
    EXPECT_THROW(all[k]({.stop = before.get_token()}), Cancelled) << k;
    std::stop_source meanwhile;
    const auto stop = [&](double) { meanwhile.request_stop(); };
    EXPECT_NO_THROW(all[k]({.stop = meanwhile.get_token()})) << k;
    const auto stops_after = [&](double part) {
      stop(part);
      if (part == 1) throw Cancelled();  // An operation may report once, at its end.
    };
    EXPECT_THROW(all[k]({.progress = stops_after, .stop = meanwhile.get_token()}), Cancelled) << k;
  }
  std::stop_source stopped;
  const std::jthread soon([&] { stopped.request_stop(); });
  EXPECT_THROW(while (true) write("stopped.exr", sun(64), {}, {.stop = stopped.get_token()}), Cancelled);
}

TEST(Run, KeepsToItsThreads) {
  const EnvironmentMap map = sun(64);
  std::mutex lock;
  std::set<std::thread::id> seen;
  const Rows rows{Projection::cube, 64, Forward::plus_z, [&](int, int, std::span<Colour> out) {
                    std::ranges::fill(out, Colour(1));
                    const std::lock_guard one(lock);
                    seen.insert(std::this_thread::get_id());
                  }};
  (void)encode(std::span(&rows, 1), {.format = "exr"}, {.threads = 1});
  EXPECT_EQ(seen, std::set{std::this_thread::get_id()});
  for (const int threads : {-1, 1025}) EXPECT_THROW((void)convert(map, {}, {.threads = threads}), UsageError);
}

}  // namespace
}  // namespace threads_test
