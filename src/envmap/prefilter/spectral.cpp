#include "envmap/prefilter/spectral.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "envmap/base/parallel.h"
#include "envmap/maths/legendre.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/on_rings.h"

namespace envmap::prefiltering {
namespace {

// Samples on a ring. Interpolation by eight points is off by at most 1.07e-3 (2 pi l / columns)^8 of degree l, the
// product of their distances over 8!; both ways, there and back.
// What the lobe leaves of that is to be a small part of the error.
int columns_for(std::span<const double> factors, double error) {
  for (int columns = 64;; columns *= 2) {
    double off = 0, peak = 0;
    for (std::size_t l = 0; l < factors.size(); ++l) {
      const double part = (2.0 * double(l) + 1) * std::abs(factors[l]);
      peak += part;
      off += 4 * 1.07e-3 * portable::pow(2 * pi * double(l) / columns, 8) * part;
    }
    if (columns > 2 * int(factors.size()) && off <= 0.1 * error * peak) return columns;
  }
}

// ---- along the rings ------------------------------------------------------------------------------------------------

// Sum of z_k exp(-2 pi i k m / n), n a power of two: Stockham's scheme, which needs no reordering.
class Fourier {
 public:
  explicit Fourier(int n) : n_(std::size_t(n)), cosine_(n_ / 2), sine_(n_ / 2), re_(n_), im_(n_) {
    for (std::size_t k = 0; k < n_ / 2; ++k) {
      const double angle = -2 * pi * double(k) / n;
      cosine_[k] = portable::cos(angle), sine_[k] = portable::sin(angle);
    }
  }
  [[nodiscard]] int size() const { return int(n_); }
  void operator()(std::vector<double>& re, std::vector<double>& im) {
    for (std::size_t half = n_ / 2, run = 1; half >= 1; half /= 2, run *= 2) {
      for (std::size_t p = 0; p < half; ++p) {
        const double c = cosine_[p * run], s = sine_[p * run];
        const double *ar = &re[run * p], *ai = &im[run * p], *br = &re[run * (p + half)], *bi = &im[run * (p + half)];
        double *sr = &re_[2 * run * p], *si = &im_[2 * run * p], *dr = sr + run, *di = si + run;
        for (std::size_t q = 0; q < run; ++q) {
          const double x = ar[q] - br[q], y = ai[q] - bi[q];
          sr[q] = ar[q] + br[q], si[q] = ai[q] + bi[q];
          dr[q] = c * x - s * y, di[q] = c * y + s * x;
        }
      }
      std::swap(re, re_), std::swap(im, im_);
    }
  }

 private:
  std::size_t n_;
  std::vector<double> cosine_, sine_, re_, im_;
};

// A block of northern rings and their mirror images: sums and differences of the two, of one m.
struct Band {
  std::array<Parts, block> even{}, odd{};
};

// The bands of all m and all blocks.
struct Bands {
  int blocks;
  std::vector<Band> values;
  Bands(int order, int rings)
      : blocks((rings / 2) / int(block)),
        values(std::size_t(order + 1) * std::size_t(blocks)) {}
  Band& at(int m, int b) { return values[std::size_t(m * blocks + b)]; }
};

// Two real rings at once, as real and imaginary part.
void analyse_rings(RingGrid& grid, int order, Bands& bands) {
  for_each_row(1, bands.blocks, {}, [&](int, int b) {
    const auto n = std::size_t(grid.columns);
    Fourier transform(grid.columns);
    std::vector<double> re(n), im(n);
    for (std::size_t k = 0; k < block; ++k)
      for (std::size_t c = 0; c < 3; ++c) {
        const int ring = b * int(block) + int(k);
        std::copy_n(grid.row(ring, c), n, re.begin());
        std::copy_n(grid.row(grid.rings - 1 - ring, c), n, im.begin());
        transform(re, im);
        for (int m = 0; m <= order; ++m) {
          const auto to = std::size_t(m), from = (n - to) % n;
          const std::complex north(0.5 * (re[to] + re[from]), 0.5 * (im[to] - im[from]));
          const std::complex south(0.5 * (im[to] + im[from]), 0.5 * (re[from] - re[to]));
          Band& band = bands.at(m, b);
          band.even[k][2 * c] = (north + south).real(), band.even[k][2 * c + 1] = (north + south).imag();
          band.odd[k][2 * c] = (north - south).real(), band.odd[k][2 * c + 1] = (north - south).imag();
        }
      }
  });
}

// ---- rows of a latlong image ----------------------------------------------------------------------------------------

// A latlong image is rings already, if there are enough of them: a Fourier transform along each row, the integral over
// its texels' width in closed form, and Gauss points over their height. Rows go to the rings as points do.
bool is_on_rings(const Level& source, int order) {
  const auto width = unsigned(source.width());
  return source.projection() == Projection::latlong && std::has_single_bit(width) && order * pi < source.height();
}

// Integrals of exp(-i m longitude) over the width of the first of n texels, m = 0, 1, ... order.
std::vector<std::complex<double>> first_texel(int n, int order) {
  std::vector<std::complex<double>> found;
  for (int m = 0; m <= order; ++m) {
    const double half = pi * m / n;
    const double size = 2 * pi / n * (m > 0 ? portable::sin(half) / half : 1);
    found.emplace_back(size * portable::cos(half), -size * portable::sin(half));
  }
  return found;
}

// Coefficients of a row: integrals of radiance x exp(-i m longitude). @param turns those of the first texel.
std::vector<Parts> row_waves(const Level& source, int row, std::span<const std::complex<double>> turns,
                             Fourier& transform) {
  const auto n = std::size_t(source.width());
  const std::span<const Colour> texels = source.row(0, row);
  std::vector<Parts> waves(turns.size(), Parts{});
  std::vector<double> re(n), im(n);
  for (std::size_t c = 0; c < 3; ++c) {
    // Red and green at once, as real and imaginary part; blue alone.
    if (c == 1) continue;
    for (std::size_t k = 0; k < n; ++k) re[k] = texels[k][int(c)], im[k] = c == 0 ? texels[k].y : 0;
    transform(re, im);
    for (std::size_t m = 0; m < waves.size(); ++m) {
      const std::size_t back = (n - m) % n;
      const std::complex first(0.5 * (re[m] + re[back]), 0.5 * (im[m] - im[back]));
      const std::complex second(0.5 * (im[m] + im[back]), 0.5 * (re[back] - re[m]));
      waves[m][2 * c] = (turns[m] * first).real(), waves[m][2 * c + 1] = (turns[m] * first).imag();
      if (c == 0) waves[m][2] = (turns[m] * second).real(), waves[m][3] = (turns[m] * second).imag();
    }
  }
  return waves;
}

// Gauss points over the height of a row, with their weights.
std::array<std::pair<Stencil, double>, 3> row_points(int row, int height, const RingGrid& places) {
  const auto& rule = quadrature::rule<3>();
  std::array<std::pair<Stencil, double>, 3> points;
  for (std::size_t g = 0; g < points.size(); ++g) {
    const double v = (row + 0.5 + 0.5 * rule.node[g]) / height;
    points[g] = {stencil_at(places, 0, v), 0.5 * rule.weight[g] * pi / height * portable::sin(pi * v)};
  }
  return points;
}

void analyse_rows(const Level& source, int order, int rings, Bands& bands, const Progress& progress) {
  RingGrid places;  // Without values: only where rings lie.
  places.rings = rings, places.columns = 2 * rings;
  const auto count = std::size_t(order + 1);
  std::vector<Parts> waves(std::size_t(rings) * count, Parts{});
  const std::vector<std::complex<double>> turns = first_texel(source.width(), order);
  constexpr int batch = 256;
  for (int start = 0; start < source.height(); start += batch) {
    const int rows = std::min(batch, source.height() - start);
    const auto found = map_rows<std::vector<Parts>>(rows, [&](int k) {
      thread_local std::optional<Fourier> transform;
      if (!transform || transform->size() != source.width()) transform.emplace(source.width());
      return row_waves(source, start + k, turns, *transform);
    });
    // Each wave by itself: threads share no sum.
    constexpr std::size_t few = 16;
    tbb::parallel_for(std::size_t{0}, (count + few - 1) / few, [&](std::size_t part) {
      const std::size_t begin = part * few, end = std::min(count, begin + few);
      for (int k = 0; k < rows; ++k)
        for (const auto& [stencil, weight] : row_points(start + k, source.height(), places))
          for (std::size_t n = 0; n < taps; ++n) {
            // Beyond a pole longitudes are half a turn on: odd waves change sign.
            const int ring = stencil.ring + int(n);
            const bool beyond = ring < 0 || ring >= rings;
            const int to = ring < 0 ? -1 - ring : ring >= rings ? 2 * rings - 1 - ring : ring;
            const double even = weight * stencil.down[n], odd = beyond ? -even : even;
            for (std::size_t m = begin; m < end; ++m) {
              Parts& sum = waves[std::size_t(to) * count + m];
              const Parts& wave = found[std::size_t(k)][m];
              for (std::size_t s = 0; s < sum.size(); ++s) sum[s] += (m % 2 == 0 ? even : odd) * wave[s];
            }
          }
    });
    if (progress) progress(0.8 * (start + rows) / source.height());
  }
  for (int b = 0; b < bands.blocks; ++b)
    for (std::size_t k = 0; k < block; ++k) {
      const auto ring = std::size_t(b) * block + k;
      const Parts *north = &waves[ring * count], *south = &waves[(std::size_t(rings) - 1 - ring) * count];
      for (int m = 0; m <= order; ++m)
        for (std::size_t s = 0; s < 6; ++s) {
          bands.at(m, b).even[k][s] = north[m][s] + south[m][s];
          bands.at(m, b).odd[k][s] = north[m][s] - south[m][s];
        }
    }
}

void synthesise_rings(Bands& bands, int order, RingGrid& grid) {
  for_each_row(1, bands.blocks, {}, [&](int, int b) {
    const auto n = std::size_t(grid.columns);
    Fourier transform(grid.columns);
    std::vector<double> re(n), im(n);
    for (std::size_t k = 0; k < block; ++k)
      for (std::size_t c = 0; c < 3; ++c) {
        std::ranges::fill(re, 0), std::ranges::fill(im, 0);
        for (int m = 0; m <= order; ++m) {
          const Band& band = bands.at(m, b);
          const std::complex even(band.even[k][2 * c], band.even[k][2 * c + 1]);
          const std::complex odd(band.odd[k][2 * c], band.odd[k][2 * c + 1]);
          const std::complex north = even + odd, south = even - odd;
          const auto to = std::size_t(m), back = (n - to) % n;
          re[back] = north.real() + south.imag(), im[back] = south.real() - north.imag();
          re[to] = north.real() - south.imag(), im[to] = north.imag() + south.real();
          if (m == 0) re[0] = north.real(), im[0] = south.real();
        }
        transform(im, re);  // Parts changed about: the other way round the circle.
        const int ring = b * int(block) + int(k);
        double *north = grid.row(ring, c), *south = grid.row(grid.rings - 1 - ring, c);
        std::ranges::copy(re, north), std::ranges::copy(im, south);
        std::copy_n(north, taps, north + n), std::copy_n(south, taps, south + n);
      }
  });
}

// ---- across the rings -----------------------------------------------------------------------------------------------

std::size_t first_of(int order, int m) { return std::size_t(m * (order + 1) - m * (m - 1) / 2); }

// f(block, Legendre functions of l = m, m + 1, ... order) for every block of rings on which any of them counts.
template <class F>
void for_blocks(int order, int m, int rings, F&& f) {
  const auto count = std::size_t(order - m + 1);
  std::vector<double> a(count), b(count);
  for (int l = m + 1; l <= order; ++l) {
    const legendre::Step step = legendre::step(l, m);
    a[std::size_t(l - m)] = step.a, b[std::size_t(l - m)] = step.b;
  }
  double scale = legendre::first();
  for (int k = 0; k < m; ++k) scale *= legendre::diagonal(k);
  std::vector<std::array<double, block>> p(count);
  for (int n = 0; n < rings / 2 / int(block); ++n) {
    std::array<double, block> y, first;
    for (std::size_t k = 0; k < block; ++k) {
      const double polar = pi * (n * int(block) + int(k) + 0.5) / rings;
      y[k] = portable::cos(polar);
      // No P_l^m of a degree that we go to grows from here to where it matters.
      const double power = m * portable::log(portable::sin(polar));
      first[k] = power < -400 ? 0 : scale * portable::exp(power);
    }
    if (std::ranges::max(first) == 0) continue;
    legendre(a, b, y, first, p);
    f(n, p);
  }
}

// Size of degree l in what a lobe makes of the light of one steradian: (2 l + 1) / (4 pi) |factor|,
// |P_l| being 1 at most.
double part(std::span<const double> factors, std::size_t l) {
  return (2.0 * double(l) + 1) / (4 * pi) * std::abs(factors[l]);
}

}  // namespace

Cut spectral_cut(std::vector<double> factors, double tail) {
  const auto most = double(factors.size() - 1);
  // What lies beyond is taken to fall as it does in the last ten, and no slower than l^-3.
  double last = 0;
  for (std::size_t l = factors.size() - 10; l < factors.size(); ++l) last = std::max(last, std::abs(factors[l]));
  Cut cut{std::move(factors), last * 2 * most * most / (4 * pi)};
  while (cut.factors.size() > 10 && cut.tail + part(cut.factors, cut.factors.size() - 1) <= tail) {
    cut.tail += part(cut.factors, cut.factors.size() - 1);
    cut.factors.pop_back();
  }
  return cut;
}

Spectrum::Spectrum(const Level& source, std::span<const double> factors, double error, const Progress& progress)
    : order_(int(factors.size()) - 1), error_(error), coefficients_(first_of(order_, order_) + 1) {
  const int order = order_, columns = columns_for(factors, error), rings = columns / 2;
  Bands bands(order, rings);
  if (is_on_rings(source, order)) {
    analyse_rows(source, order, rings, bands, progress);
  } else {
    RingGrid grid = on_rings(source, order, columns, error, progress);
    analyse_rings(grid, order, bands);
  }
  tbb::parallel_for(0, order + 1, [&](int m) {
    const std::span<Parts> all =
        std::span(coefficients_).subspan(first_of(order, m), std::size_t(order - m + 1));
    for_blocks(order, m, rings, [&](int b, const auto& p) {
      const Band& band = bands.at(m, b);
      project_rings(p, band.even, band.odd, all);
    });
  });
}

void Spectrum::convolve(std::span<const double> factors, const Target& target, Level& out,
                        const Progress& progress) const {
  const int order = int(factors.size()) - 1;
  RingGrid grid(columns_for(factors, error_));
  Bands bands(order, grid.rings);
  tbb::parallel_for(0, order + 1, [&](int m) {
    std::vector<Parts> scaled(std::size_t(order - m + 1));
    for (std::size_t k = 0; k < scaled.size(); ++k)
      for (std::size_t c = 0; c < scaled[k].size(); ++c)
        scaled[k][c] = factors[std::size_t(m) + k] * coefficients_[first_of(order_, m) + k][c];
    for_blocks(order, m, grid.rings, [&](int b, const auto& p) {
      Band& band = bands.at(m, b);
      evaluate_rings(p, scaled, band.even, band.odd);
    });
  });
  synthesise_rings(bands, order, grid);
  for_each_row(out.faces(), out.height(), progress, [&](int face, int row) {
    const Columns in = columns(out.projection(), out.height(), row);
    const auto count = std::size_t(std::max(0, in.end - in.first));
    std::vector<Direction> d(count);
    std::vector<Location<double>> places(count);
    texel_directions(out.projection(), out.height(), face, row, in.first, d);
    rotate(target.to_source, d);
    locate(Projection::latlong, d, places);
    for (std::size_t k = 0; k < count; ++k) {
      const std::array<double, 3> found = interpolate(grid, stencil_at(grid, places[k].u, places[k].v));
      *out.texel(face, in.first + int(k), row) = Colour(glm::max(Flux(found[0], found[1], found[2]), Flux(0)));
    }
  });
}

// ---- what is off ----------------------------------------------------------------------------------------------------

namespace {

// A lobe so much wider that what the transform makes wrong of the narrow one lies below a small part of it.
Lobe widened(const Lobe& lobe) {
  struct Wider {
    Lobe operator()(const Cosine& l) const { return l; }
    Lobe operator()(const Phong& l) const { return Phong{l.exponent / 4}; }
    Lobe operator()(const Charlie& l) const { return l; }
    Lobe operator()(const BlinnPhong& l) const { return BlinnPhong(l.power / 2); }
    Lobe operator()(const Ggx& l) const { return Ggx(std::min(1.0, 1.5 * portable::pow(0.5 * l.a, 0.25))); }
  };
  return std::visit(Wider{}, lobe);
}

// The n-th difference of a lobe at an angle, over steps h along a great circle that leaves the meridian by an azimuth.
double difference(const Lobe& lobe, double angle, double azimuth, double h, int n) {
  double sum = 0, binomial = 1;
  for (int k = 0; k <= n; ++k) {
    const double t = (k - 0.5 * n) * h;
    const double x =
        1 - portable::cos(angle) * portable::cos(t) - portable::sin(angle) * portable::sin(t) * portable::cos(azimuth);
    sum += (k % 2 == 0 ? binomial : -binomial) *
           std::visit([x](const auto& l) { return l.value(std::max(0.0, x)); }, lobe);
    binomial *= double(n - k) / (k + 1);
  }
  return std::abs(sum);
}

// What light at some angle is off by, for a flux of 1: `envelope` x the wider lobe there, and no more than `rest` where
// that is nothing.
struct Leak {
  double envelope = 0, rest = 0;
};

// Eight points interpolate to 1.07e-3 of the eighth difference, along and across the rings, there and back; texels
// taken as one point are off by 1/24 of the second difference each way, as four by 1/4320 of the fourth. Differences
// are taken at all angles and in all azimuths, from the lobe itself. At the horizon, where it may have a kink or a
// step, they are off by up to 1/70 (half a step, whose eighth difference is 35), 1/8 and 1/90 of them; the wider lobe
// is nothing there, so that this counts as `rest`.
Leak leak_of(const Lobe& lobe, const Lobe& wide, const Level& source, int order, int columns, double error) {
  const double h = 2 * pi / columns, peak = std::visit([](const auto& l) { return l.value(0); }, wide);
  const double pitch = source.projection() == Projection::cube ? 2.0 / source.height() : pi / source.height();
  const Reaches most = reaches(order, error, false);
  const double one = std::min(pitch, most.one / 1.1), four = std::min(pitch, most.four / 1.41);
  const bool points = !is_on_rings(source, order), single = points && most.one > 0.3 * pitch;
  const double near = std::max({4 * h, points ? 2 * four : 0, single ? one : 0});
  Leak leak;
  for (double angle = 0; angle < 0.6 * pi; angle += 0.5 * h) {
    const bool at_horizon = std::abs(angle - 0.5 * pi) < near;
    const double eighth = at_horizon ? 1.0 / 70 : 1.07e-3, fourth = at_horizon ? 1.0 / 90 : 1.0 / 4320,
                 second = at_horizon ? 1.0 / 8 : 1.0 / 24;
    double off = 0;
    for (const double azimuth : {0.0, 0.25 * pi, 0.4 * pi, 0.5 * pi}) {
      double sum = 4 * eighth * difference(lobe, angle, azimuth, h, 8);
      if (points) sum += 2 * fourth * difference(lobe, angle, azimuth, four, 4);
      if (single) sum += 2 * second * difference(lobe, angle, azimuth, one, 2);
      off = std::max(off, sum);
    }
    const double x = 1 - portable::cos(angle), cover = std::visit([x](const auto& l) { return l.value(x); }, wide);
    if (cover > 1e-6 * peak && !at_horizon)
      leak.envelope = std::max(leak.envelope, off / cover);
    else
      leak.rest = std::max(leak.rest, off);
  }
  return leak;
}

// What a lobe is off without the degrees left out, at most: the lobe itself less the sum of those that are there, at
// sixteen angles for each half wave of the last, the horizon's among them, and 5% for what lies between. Where a lobe
// has a kink at its horizon this is some fifty times less than the sizes of the degrees added up, since they are small
// there and of either sign elsewhere.
double left_out(const Lobe& lobe, std::span<const double> factors) {
  const std::size_t count = 16 * factors.size() + 1;
  std::vector<double> cosine(count), sum(count, 0), now(count, 1), before(count, 0);
  for (std::size_t k = 0; k < count; ++k) cosine[k] = portable::cos(pi * double(k) / double(count - 1));
  for (std::size_t l = 0; l < factors.size(); ++l) {
    const auto degree = double(l);
    const double factor = (2 * degree + 1) / (4 * pi) * factors[l], a = (2 * degree + 1) / (degree + 1),
                 b = degree / (degree + 1);
    for (std::size_t k = 0; k < count; ++k) {
      sum[k] += factor * now[k];
      before[k] = a * cosine[k] * now[k] - b * before[k];
    }
    std::swap(now, before);
  }
  double most = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double half = portable::sin(0.5 * pi * double(k) / double(count - 1));
    most = std::max(most, std::abs(std::visit([&](const auto& l) { return l.value(2 * half * half); }, lobe) - sum[k]));
  }
  return 1.05 * most;
}

// The largest error of interpolation of a lobe's map anywhere, for a flux of 1 (columns_for() has the same sum).
double interpolation_error(std::span<const double> factors, int columns) {
  double sum = 0;
  for (std::size_t l = 0; l < factors.size(); ++l)
    sum += 4 * 1.07e-3 * portable::pow(2 * pi * double(l) / columns, 8) * part(factors, l);
  return sum;
}

}  // namespace

std::size_t spectral_prefilter(const Level& source, const Totals& light, const Lobe& lobe, const Target& target,
                               double max_error, double grid_error, std::unique_ptr<Spectrum>& kept, Level& out,
                               std::span<float> figures, const Progress& progress) {
  const auto& [total, mean] = light;
  const double brightest = std::max({total.x, total.y, total.z});
  if (brightest <= 0) return 0;
  const double wanted = 0.2 * max_error * 1e-3 * mean / brightest;
  Cut cut = spectral_cut(zonal(lobe, most_spectral_order), wanted);
  if (cut.tail > wanted) cut.tail = std::min(cut.tail, left_out(lobe, cut.factors));
  const int order = int(cut.factors.size()) - 1;
  const Lobe wide = widened(lobe);
  const int columns = columns_for(cut.factors, grid_error);
  const Leak leak = leak_of(lobe, wide, source, order, columns, grid_error);
  // Where most texels would be refused the transform is not worth its time.
  if ((cut.tail + leak.rest) * brightest > 0.1 * max_error * mean) return 0;
  if (!kept || kept->order() < order || kept->error() > grid_error)
    kept = std::make_unique<Spectrum>(source, cut.factors, grid_error, progress);
  kept->convolve(cut.factors, target, out, progress);

  const double wide_peak = std::visit([](const auto& l) { return l.value(0); }, wide);
  const Cut cover = spectral_cut(zonal(wide, order), 1e-6 * wide_peak);
  const double cover_off = cover.tail + interpolation_error(cover.factors, columns_for(cover.factors, grid_error));
  Level wider(out.projection(), out.height());
  kept->convolve(cover.factors, target, wider);
  const double floor = 1e-3 * mean;
  const Flux everywhere = total * (leak.envelope * cover_off + leak.rest + cut.tail);
  std::size_t finer = 0;
  for (const Texel& t : texels_of(out)) {
    const Flux value = glm::max(Flux(*out.texel(t.face, t.i, t.j)), Flux(floor)), above(*wider.texel(t.face, t.i, t.j));
    const auto largest = [&](const Flux& off) { return std::max({off.x / value.x, off.y / value.y, off.z / value.z}); };
    float& figure = figures[index_of(out, t)];
    figure = float(largest(leak.envelope * above + everywhere));
    if (figure > max_error && largest(total * (cut.tail + leak.rest)) <= 0.5 * max_error) ++finer;
  }
  return finer;
}

}  // namespace envmap::prefiltering
