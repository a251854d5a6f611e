// How far prefiltered maps are off, in every texel, over random hostile maps.
//
//   hostile [FIRST COUNT [quick] [METHOD]]
//
// Map number N has a random projection, size, content (suns of 1e4 to 1e9 at poles, corners, seams and rims, noise,
// checkers, one lit texel; every fourth map has two halves or blocks that repeat, whose horizons run along texels;
// every fifth has up to eleven suns of 10 to 1e9 under a broad lobe, at 3e-4 or 1e-4),
// lobe, error and target. The truth is summed here in float64, by adaptive Gauss panels over every texel of the source,
// cut where the horizon crosses, from the definitions in envmap-prefilter(7): nothing of the library has a part in it.
// `quick` takes the library's own exact sum instead, which METHOD `exact` checks, at 1e-5. A line is printed for each
// map above half its error or of more than 5 s, and at the end the worst. METHOD judges that one alone.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "envmap/operate/measure.h"
#include "envmap/prefilter/exact/exact.h"
#include "envmap/prefilter/prefilter.h"
#include "formulae.h"

namespace {

using namespace envmap;

// ---- the truth ------------------------------------------------------------------------------------------------------

// A lobe from its definition, not normalised, over x = 1 - cos.
struct Kernel {
  LobeShape shape;
  double parameter, norm = 1;

  double operator()(double x) const {
    if (x >= 1) return 0;
    if (shape == LobeShape::diffuse) return norm * (1 - x);
    if (shape == LobeShape::phong) return norm * std::exp(parameter * std::log1p(-x));
    if (shape == LobeShape::charlie) return norm * (1 - x) * std::pow(x / 2, 0.5 / (parameter * parameter));
    if (shape == LobeShape::blinn_phong) return norm * (1 - x) * std::exp(0.5 * parameter * std::log1p(-x / 2));
    const double a2 = std::pow(parameter, 4), d = a2 * (1 - x / 2) + x / 2;  // n.h^2 = (1 + cos) / 2.
    return norm * (1 - x) / (d * d);
  }
  // Its largest value from lo to hi: sheen rises to x = k / (1 + k), k its power of x, and all others fall.
  [[nodiscard]] double most(double lo, double hi) const {
    const double power = shape == LobeShape::charlie ? 0.5 / (parameter * parameter) : 0;
    return (*this)(std::clamp(power / (1 + power), lo, hi));
  }
};

// Gauss points of two, of four and of six a side, Abramowitz and Stegun 1964, 25.4.30.
constexpr int least = 2, few = 4, many = 6;
constexpr double least_nodes[least] = {-0.5773502691896258, 0.5773502691896258};
constexpr double least_weights[least] = {1, 1};
constexpr double few_nodes[few] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
constexpr double few_weights[few] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
constexpr double many_nodes[many] = {-0.9324695142031521, -0.6612093864662645, -0.2386191860831969,
                                     0.2386191860831969,  0.6612093864662645,  0.9324695142031521};
constexpr double many_weights[many] = {0.1713244923791704, 0.3607615730481386, 0.4679139345726910,
                                       0.4679139345726910, 0.3607615730481386, 0.1713244923791704};

struct Panel {
  double u, v, w, h;  // Middle and size.
};
struct Point {
  Direction l;
  double omega;
};

double density(Projection p, double u, double v) {
  if (p == Projection::latlong) return 2 * pi * pi * std::sin(pi * v);
  const double s = 2 * u - 1, t = 2 * v - 1;
  return 4 / std::pow(1 + s * s + t * t, 1.5);
}

template <int N>
void points_of(Projection p, int face, const Panel& in, const double (&nodes)[N], const double (&weights)[N],
               std::vector<Point>& out) {
  for (int b = 0; b < N; ++b)
    for (int a = 0; a < N; ++a) {
      const double u = in.u + 0.5 * in.w * nodes[a], v = in.v + 0.5 * in.h * nodes[b];
      out.push_back({formulae::rounded(formulae::direction(p, face, u, v)),
                     0.25 * in.w * in.h * weights[a] * weights[b] * density(p, u, v)});
    }
}
double sum(const std::vector<Point>& points, std::size_t first, std::size_t count, const Kernel& f,
           const Direction& r) {
  double total = 0;
  for (std::size_t k = first; k < first + count; ++k) {
    const Direction d = points[k].l - r;
    total += points[k].omega * f(0.5 * glm::dot(d, d));
  }
  return total;
}

// Gauss points of ten a side, graded towards both ends (u = 3 t^2 - 2 t^3): for what vanishes, or has a kink,
// at an end.
struct Graded {
  static constexpr int count = 10;
  double at[count], weight[count];  // Of 0 to 1.
  Graded() {
    constexpr double nodes[] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244, 0.8650633666889845,
                                0.9739065285171717};
    constexpr double weights[] = {0.2955242247147529, 0.2692667193099963, 0.2190863625159821, 0.1494513491505806,
                                  0.0666713443086881};
    for (int k = 0; k < count; ++k) {
      const double t = 0.5 + (k < 5 ? -0.5 : 0.5) * nodes[k % 5];
      at[k] = t * t * (3 - 2 * t), weight[k] = 0.5 * weights[k % 5] * 6 * t * (1 - t);
    }
  }
};

// Where the horizon of r cuts the row at v, and the column at u, and where it turns back, of a latlong map (a cosine
// along a row, one along a column) and of a face of a cube (a line).
double height(Projection p, int face, double u, double v, const Direction& r) {
  const Direction d = formulae::rounded(formulae::direction(p, face, u, v));
  return glm::dot(d, r) / (p == Projection::latlong ? 1 : std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}));
}
std::vector<double> cuts_of_row(Projection p, int face, const Panel& in, double v, const Direction& r) {
  const double first = height(p, face, 0, v, r);
  if (p != Projection::latlong) return {first / (first - height(p, face, 1, v, r))};
  const double half = height(p, face, 0.5, v, r), c = (first + half) / 2, a = first - c,
               b = height(p, face, 0.25, v, r) - c;
  const double to = std::acos(std::clamp(-c / std::hypot(a, b), -1.0, 1.0)), middle = std::atan2(b, a),
               left = in.u - in.w / 2;
  std::vector<double> all;
  for (const double phi : {middle - to, middle + to}) all.push_back(phi / (2 * pi) - std::floor(phi / (2 * pi) - left));
  return all;
}
double cut_of_column(Projection p, int face, double u, const Direction& r) {
  const double first = height(p, face, u, 0, r);
  if (p != Projection::latlong) return first / (first - height(p, face, u, 1, r));
  const double v = std::atan2(-first, height(p, face, u, 0.5, r)) / pi;
  return v < 0 ? v + 1 : v;
}
std::vector<double> cuts_within(double low, double high, const std::vector<double>& cuts) {
  std::vector<double> all{low, high};
  for (const double x : cuts)
    if (x > low && x < high) all.push_back(x);
  std::ranges::sort(all);
  return all;
}

// The integral over what a panel has above the horizon: row by row, each from cut to cut.
double clipped(Projection p, int face, const Panel& in, const Kernel& f, const Direction& r) {
  static const Graded rule;
  const double left = in.u - in.w / 2, top = in.v - in.h / 2,
               turn = std::atan2(std::abs(r.y), std::hypot(r.x, r.z)) / pi;
  std::vector<double> rows{cut_of_column(p, face, left, r), cut_of_column(p, face, left + in.w, r)};
  if (p == Projection::latlong) rows.insert(rows.end(), {turn, 1 - turn});
  rows = cuts_within(top, top + in.h, rows);
  double total = 0;
  for (std::size_t k = 0; k + 1 < rows.size(); ++k)
    for (int b = 0; b < Graded::count; ++b) {
      const double tall = rows[k + 1] - rows[k], v = rows[k] + tall * rule.at[b];
      const std::vector<double> cuts = cuts_within(left, left + in.w, cuts_of_row(p, face, in, v, r));
      for (std::size_t m = 0; m + 1 < cuts.size(); ++m) {
        const double wide = cuts[m + 1] - cuts[m];
        if (height(p, face, cuts[m] + wide / 2, v, r) <= 0) continue;
        for (int a = 0; a < Graded::count; ++a) {
          const double u = cuts[m] + wide * rule.at[a];
          const Direction d = formulae::rounded(formulae::direction(p, face, u, v)) - r;
          total += tall * wide * rule.weight[a] * rule.weight[b] * density(p, u, v) * f(0.5 * glm::dot(d, d));
        }
      }
    }
  return total;
}

double adaptive(Projection p, int face, const Panel& in, const Kernel& f, const Direction& r, double tolerance,
                int depth) {
  std::vector<Point> points;
  points_of(p, face, in, few_nodes, few_weights, points);
  points_of(p, face, in, many_nodes, many_weights, points);
  const double a = sum(points, 0, 16, f, r), b = sum(points, 16, 36, f, r);
  // Where the horizon may cross a panel neither need see it.
  double low = 2, high = 0;
  for (const Point& q : points) {
    const Direction d = q.l - r;
    low = std::min(low, 0.5 * glm::dot(d, d)), high = std::max(high, 0.5 * glm::dot(d, d));
  }
  const double margin = 0.4 * (high - low) + 1e-12;
  if (low - margin >= 1) return 0;
  const bool bent = high + margin > 1;
  const double from = std::max(0.0, low - margin), most = f.most(from, high + margin);
  const bool even = !bent && most < 1e3 * std::min(f(from), f(high + margin));  // Else the rules may both miss a peak.
  if (depth == 0 || most * 1.5 * in.w * in.h * 20 < tolerance || (even && std::abs(a - b) <= tolerance)) return b;
  if (bent && high - low < 0.1) return clipped(p, face, in, f, r);
  double total = 0;
  for (int k = 0; k < 4; ++k)
    total += adaptive(p, face,
                      {in.u + (k % 2 ? 0.25 : -0.25) * in.w, in.v + (k / 2 ? 0.25 : -0.25) * in.h, in.w / 2, in.h / 2},
                      f, r, tolerance / 2, depth - 1);
  return total;
}

struct SourceTexel {
  int face;
  Panel panel;
  Direction middle;
  double reach;
  Flux radiance;
  std::vector<Point> points;
};

std::vector<SourceTexel> texels_of_source(const Level& level) {
  std::vector<SourceTexel> all;
  const double w = level.width(), h = level.height();
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (int i = 0; i < level.width(); ++i) {
        SourceTexel t{face, {(i + 0.5) / w, (j + 0.5) / h, 1 / w, 1 / h}, {}, 0, Flux(*level.texel(face, i, j)), {}};
        t.middle = formulae::rounded(formulae::direction(level.projection(), face, t.panel.u, t.panel.v));
        for (int k = 0; k < 4; ++k)
          t.reach = std::max(t.reach, glm::length(formulae::rounded(formulae::direction(
                                                      level.projection(), face, (i + k % 2) / w, (j + k / 2) / h)) -
                                                  t.middle));
        t.reach *= 1.02;
        points_of(level.projection(), face, t.panel, least_nodes, least_weights, t.points);
        points_of(level.projection(), face, t.panel, few_nodes, few_weights, t.points);
        points_of(level.projection(), face, t.panel, many_nodes, many_weights, t.points);
        all.push_back(std::move(t));
      }
  return all;
}

// @param close relative to `floor`, which is what is left alone of the result.
Flux truth(const std::vector<SourceTexel>& source, Projection p, const Kernel& f, const Direction& r, double floor) {
  Flux total(0);
  const double allowed = 1e-7 * floor / double(source.size());
  for (const SourceTexel& t : source) {
    const double brightest = std::max({t.radiance.x, t.radiance.y, t.radiance.z});
    if (brightest <= 0) continue;
    const double d = glm::length(t.middle - r), near = std::max(0.0, d - t.reach), far = d + t.reach;
    if (0.5 * near * near >= 1) continue;
    const double tolerance = allowed / brightest;
    const double most = f.most(0.5 * near * near, 0.5 * far * far);
    if (most * 4 * t.reach * t.reach < tolerance) continue;
    // What two rules agree on to 1e-6 the finer has to 1e-9 or so, for a lobe that varies over a texel by so little.
    const bool bent = 0.5 * far * far > 1;
    const bool even = !bent && most < 1e3 * std::min(f(0.5 * near * near), f(0.5 * far * far));
    const auto agree = [&](double a, double b) { return std::abs(a - b) <= std::max(tolerance, 1e-6 * b); };
    double b = sum(t.points, 4, 16, f, r);
    bool sure = even && agree(sum(t.points, 0, 4, f, r), b);
    if (!sure) {
      const double finer = sum(t.points, 20, 36, f, r);
      sure = even && agree(b, finer);
      b = finer;
    }
    total += (sure ? b : adaptive(p, t.face, t.panel, f, r, std::max(tolerance, 1e-8 * b), bent ? 9 : 7)) * t.radiance;
  }
  return total;
}

double integral(const Kernel& f) {
  double total = 0;
  for (int k = 0; k < 60; ++k) {  // x from 2^-60 up, each octave by itself; the rest is nothing.
    const double hi = std::ldexp(1.0, -k), lo = k == 59 ? 0 : hi / 2;
    constexpr int parts = 40;
    for (int n = 0; n < parts; ++n)
      for (int m = 0; m < many; ++m) {
        const double w = (hi - lo) / parts, x = lo + w * (n + 0.5 + 0.5 * many_nodes[m]);
        total += 0.5 * w * many_weights[m] * 2 * pi * f(x);
      }
  }
  return total;
}

// ---- the maps -------------------------------------------------------------------------------------------------------

struct Case {
  EnvironmentMap map;
  PrefilterOptions wanted;
  std::string words;
};

// Light in which nodes along a horizon are off alike: two halves, cut along the axes or diagonals or a little beside,
// or blocks of 2^n texels, each lit as the others.
template <class Any, class Even>
void set_pattern(Level& level, Any&& any, Even&& even) {
  const Direction normals[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 2, 0}, {0, 1, 1}};
  const double tilt = any(2) ? 0.1 * std::pow(even(), 4) : 0, shift = any(2) ? 0 : 0.1 * std::pow(even(), 2);
  const Direction normal = normals[any(6)] + tilt * Direction(even() - 0.5, even() - 0.5, even() - 0.5);
  const auto dark = float(even()), bright = float(std::pow(10, 6 * even()));
  const int side = any(2) ? 0 : 1 << (1 + any(4));
  std::vector<Colour> block(std::size_t(side * side));
  const bool grey = any(2);
  for (Colour& c : block)
    for (int k = 0; k < 3; ++k) c[k] = k > 0 && grey ? c[0] : float(std::exp(8 * even() * even()));
  for (const Texel& t : texels_of(level)) {
    const double u = (t.i + 0.5) / level.width(), v = (t.j + 0.5) / level.height();
    const Direction d = formulae::rounded(formulae::direction(level.projection(), t.face, u, v));
    Colour& c = *level.texel(t.face, t.i, t.j);
    c = side ? block[std::size_t(t.j % side * side + t.i % side)] : Colour(glm::dot(d, normal) > shift ? bright : dark);
  }
}

Case make_case(int number) {
  std::mt19937_64 random(std::uint64_t(number) * 7919 + 13);
  const auto any = [&](int n) { return int(random() % std::uint64_t(n)); };
  const auto even = [&] { return double(random() >> 11) * 0x1p-53; };
  Case c;
  const Projection from = all_projections[any(5)];
  const bool pattern = number % 4 == 3;
  const int size = pattern                    ? 1 << (from == Projection::cube ? 2 + any(5) : 3 + any(5))
                   : from == Projection::cube ? 4 + any(21)
                                              : 8 + any(33);
  c.map.levels.emplace_back(from, size);
  Level& level = c.map.base();
  const int content = any(5);  // What a pattern leaves.
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < size; ++j) {
      const Columns in = columns(from, size, j);
      for (int i = in.first; i < in.end; ++i)
        for (int k = 0; k < 3; ++k) {
          float& x = (*level.texel(face, i, j))[k];
          if (content == 0) x = 0.5F;
          if (content == 1) x = float(even());
          if (content == 2) x = (i + j) % 2 ? 1.F : 0.F;
          if (content == 3) x = 0;
          if (content == 4) x = float(std::exp(12 * even() - 6));
        }
    }
  const bool many_suns = number % 5 == 4;
  const int suns = many_suns ? 1 + any(11) : content == 3 ? 1 : any(4);
  for (int n = 0; n < suns; ++n) {
    const int face = any(level.faces());
    // At edges, corners, poles and rims, or anywhere.
    int j = any(4) == 0 ? 0 : any(4) == 0 ? size - 1 : any(size);
    const Columns in = columns(from, size, j);
    if (in.end <= in.first) j = size / 2;
    const Columns row = columns(from, size, j);
    const int i = any(3) == 0 ? row.first : any(3) == 0 ? row.end - 1 : row.first + any(row.end - row.first);
    const double strength =
        many_suns ? std::pow(10, 1 + 8 * even()) : std::pow(10, 4 + 5 * even()) * (any(3) == 0 ? 1e-4 : 1);
    *level.texel(face, i, j) = Colour(float(strength), float(strength * (any(2) ? 1 : even())),
                                      float(strength * (any(2) ? 1 : even())));
  }
  const double errors[] = {1e-2, 3e-3, 1e-3, 1e-3, 3e-4, 1e-4};
  PrefilterOptions& p = c.wanted;
  LobeShape shape = static_cast<LobeShape>(any(3));
  double parameter = unset_parameter;
  if (shape == LobeShape::phong) parameter = any(6) == 0 ? 0.5 * any(3) * even() : 0.5 * std::pow(10, 4 * even());
  if (shape == LobeShape::ggx) parameter = 0.1 + 0.9 * even();
  if (shape == LobeShape::phong && number % 3 == 0) shape = LobeShape::blinn_phong;
  if (shape == LobeShape::ggx && number % 3 == 0) shape = LobeShape::charlie;
  if (many_suns && shape == LobeShape::phong) parameter = 1.5 + 18.5 * even();
  if (many_suns && shape == LobeShape::ggx) parameter = 0.4 + 0.6 * even();
  p.lobe = Lobe(shape, parameter);
  p.max_error = many_suns ? errors[4 + any(2)] : errors[any(6)];
  p.to = all_projections[any(2)];
  p.size = p.to == Projection::cube ? 1 + any(10) : 2 + any(15);
  if (any(8) == 0) p.size *= 3;
  if (pattern) {
    set_pattern(level, any, even);
    p.size = p.to == Projection::cube ? 1 + 2 * any(5) : p.size;  // With directions along the axes.
  }
  c.words =
      fmt::format("{} {} {} {} suns {}, {} {:.4g}, {:g}, {} {}", name(from), size, pattern ? "pattern" : "content",
                  content, suns, lobe_shape_names[std::size_t(shape)], parameter, p.max_error, name(p.to), p.size);
  return c;
}

struct Found {
  double worst = 0, seconds = 0;  // Error over E.
  std::string words;
};

Found judge(int number, bool quick, Method method) {
  Case c = make_case(number);
  c.wanted.method = method;
  if (method == Method::exact) c.wanted.max_error = 1e-5;
  const Prefilterer prepared(c.map);
  const auto start = std::chrono::steady_clock::now();
  const Prefiltered done = prepared.make(c.wanted);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Level& source = prepared.source().base();
  const std::vector<SourceTexel> texels = texels_of_source(source);
  double flux = 0, sphere = 0;
  for (const SourceTexel& t : texels) {
    double omega = 0;
    for (std::size_t k = 20; k < 56; ++k) omega += t.points[k].omega;
    sphere += omega, flux += omega * (t.radiance.x + t.radiance.y + t.radiance.z) / 3;
  }
  const double floor = std::max(1e-3 * flux / sphere, 1e-300);
  Kernel f{c.wanted.lobe.shape(), c.wanted.lobe.parameter()};
  f.norm = 1 / integral(f);
  Found found;
  const Level& out = done.map.base();
  const std::vector<Texel> all = envmap::texels_of(out);
  std::vector<Direction> directions;
  for (const Texel& t : all)
    directions.push_back(formulae::rounded(
        formulae::direction(out.projection(), t.face, (t.i + 0.5) / out.width(), (t.j + 0.5) / out.height())));
  std::vector<Flux> truths;
  if (quick) {
    truths = prefiltering::exact_prefilter(source, formula_of(c.wanted.lobe), directions);
  } else {
    for (const Direction& r : directions) truths.push_back(truth(texels, source.projection(), f, r, floor));
  }
  for (std::size_t n = 0; n < all.size(); ++n) {
    const Texel& t = all[n];
    const Flux a(*out.texel(t.face, t.i, t.j)), &b = truths[n];
    for (int k = 0; k < 3; ++k) {
      const double off = std::abs(a[k] - b[k]) / std::max(b[k], floor);
      if (off / c.wanted.max_error <= found.worst) continue;
      found.worst = off / c.wanted.max_error;
      found.words = fmt::format("{:.3f} E at {} {} {}: {:.7g} for {:.7g} (mean {:.4g}), {}", found.worst, t.face, t.i,
                                t.j, a[k], b[k], 1e3 * floor, method_names[std::size_t(done.method)]);
    }
  }
  found.seconds = seconds;
  found.words = fmt::format("{}: {}; {}, {:.2f} s, {} of {} exact", number, c.words, found.words, seconds, done.exact,
                            all.size());
  return found;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && argv[1][0] == '-') return fmt::print("Usage: hostile [FIRST COUNT [quick] [METHOD]]\n"), 0;
  const int first = argc > 1 ? std::atoi(argv[1]) : 0, count = argc > 2 ? std::atoi(argv[2]) : 100;
  bool quick = false;
  Method method = Method::automatic;
  for (int k = 3; k < argc; ++k)
    if (const auto named = std::ranges::find(method_names, std::string_view(argv[k])); named != std::end(method_names))
      method = static_cast<Method>(named - std::begin(method_names));
    else
      quick = std::string_view(argv[k]) == "quick";
  std::vector<Found> all(std::size_t(std::max(0, count)));
  tbb::parallel_for(0, count, [&](int k) {
    Found& f = all[std::size_t(k)];
    f = judge(first + k, quick, method);
    if (f.worst > 0.5 || f.seconds > 5) fmt::print("{}\n", f.words), std::fflush(stdout);
  });
  int above = 0;
  double seconds = 0;
  const Found* worst = nullptr;
  for (const Found& f : all) {
    above += f.worst > 1, seconds = std::max(seconds, f.seconds);
    if (!worst || f.worst > worst->worst) worst = &f;
  }
  std::vector<double> sorted;
  for (const Found& f : all) sorted.push_back(f.worst);
  std::ranges::sort(sorted);
  if (worst)
    fmt::print("{} maps, {} above their error; median {:.3f} E, 90% {:.3f}, 99% {:.3f}; {:.2f} s at most; worst: {}\n",
               count, above, sorted[sorted.size() / 2], sorted[sorted.size() * 9 / 10],
               sorted[sorted.size() * 99 / 100], seconds, worst->words);
  return above > 0 ? 1 : 0;
}
