// add_texel(), compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/exact_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/exact_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/maths/trigonometry-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, ExactSums::lanes>;
using V = hn::Vec<D>;

// log2(1 - x) for x in [0,1): as in lanes-inl.h, to 3e-16 of it.
HWY_INLINE V log2_one_minus(V x) {
  const D d;
  const hn::RebindToSigned<D> di;
  const V one = hn::Set(d, 1);
  const auto bits = hn::BitCast(di, hn::Max(hn::Sub(one, x), hn::Set(d, 1e-300)));
  const auto exponent = hn::ShiftRight<52>(hn::Sub(bits, hn::Set(di, 0x3fe8000000000000)));
  const V rest = hn::Sub(one, hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<52>(exponent))));
  const V z = hn::IfThenElse(hn::RebindMask(d, hn::Eq(exponent, hn::Zero(di))), x, rest);
  const V t = hn::Div(z, hn::Sub(hn::Set(d, 2), z));
  const V sum = polynomial(d, hn::Mul(t, t), -2.8853900817779268, -0.96179669392597555, -0.57707801635558531,
                           -0.41219858311113239, -0.32059889797532518, -0.26230818925253879, -0.22195308321368667,
                           -0.1923593387851951, -0.16972882833987804, -0.15186263588304878, -0.13739952770371080,
                           -0.12545174268599681, -0.11541560327111707);
  return hn::Add(hn::ConvertTo(d, exponent), hn::Mul(t, sum));
}

// 2^y for y up to 0; below -1000 as that.
HWY_INLINE V exp2_small(V y) {
  const D d;
  const hn::RebindToSigned<D> di;
  y = hn::Max(y, hn::Set(d, -1000));
  const V shift = hn::Set(d, 0x1.8p52), shifted = hn::Add(y, shift), f = hn::Sub(y, hn::Sub(shifted, shift));
  const V power = polynomial(d, f, 1, 0.69314718055994529, 0.24022650695910072, 0.055504108664821583,
                             0.0096181291076284769, 0.0013333558146428443, 0.00015403530393381609, 1.5252733804059841e-05,
                             1.3215486790144309e-06, 1.0178086009239699e-07, 7.0549116208011234e-09, 4.4455382718708116e-10,
                             2.5678435993488206e-11, 1.3691488853904128e-12, 6.7787263548225457e-14);
  return hn::BitCast(d, hn::Add(hn::BitCast(di, power), hn::ShiftLeft<52>(hn::BitCast(di, shifted))));
}

// value() and rate() of lobe.h.
HWY_INLINE V value(const Cosine&, V x) {
  const D d;
  return hn::Mul(hn::Set(d, 1 / pi), hn::Max(hn::Zero(d), hn::Sub(hn::Set(d, 1), x)));
}
HWY_INLINE V rate(const Cosine&, V x) {
  const D d;
  return hn::Div(hn::Set(d, 1), hn::Sub(hn::Set(d, 1), x));
}
HWY_INLINE V value(const Phong& l, V x) {
  const D d;
  const V power = exp2_small(hn::Mul(hn::Set(d, l.exponent), log2_one_minus(x)));
  return hn::IfThenElseZero(hn::Lt(x, hn::Set(d, 1)), hn::Mul(hn::Set(d, l.scale()), power));
}
HWY_INLINE V rate(const Phong& l, V x) {
  const D d;
  return hn::Div(hn::Set(d, l.exponent), hn::Sub(hn::Set(d, 1), x));
}
HWY_INLINE V value(const Ggx& l, V x) {
  const D d;
  const V q = hn::Add(hn::Set(d, l.a), hn::Mul(hn::Set(d, l.b), x));
  return hn::Div(hn::Mul(hn::Set(d, l.scale), hn::Max(hn::Zero(d), hn::Sub(hn::Set(d, 1), x))), hn::Mul(q, q));
}
HWY_INLINE V rate(const Ggx& l, V x) {
  const D d;
  const V q = hn::Add(hn::Set(d, l.a), hn::Mul(hn::Set(d, l.b), x));
  return hn::Add(hn::Div(hn::Set(d, 1), hn::Sub(hn::Set(d, 1), x)), hn::Div(hn::Set(d, 2 * l.b), q));
}

HWY_INLINE V square_of(const ExactSums& sums, std::size_t k, const Direction& p) {
  const D d;
  const V x = hn::Sub(hn::LoadU(d, &sums.direction[0][k]), hn::Set(d, p.x)),
          y = hn::Sub(hn::LoadU(d, &sums.direction[1][k]), hn::Set(d, p.y)),
          z = hn::Sub(hn::LoadU(d, &sums.direction[2][k]), hn::Set(d, p.z));
  return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
}

template <class L, std::size_t N>
HWY_INLINE V over_points(const L& lobe, const ExactSums& sums, std::size_t k, const std::array<Direction, N>& points,
                         const std::array<double, N>& weights) {
  const D d;
  V sum = hn::Zero(d);
  for (std::size_t n = 0; n < N; ++n) {
    const V x = hn::Mul(hn::Set(d, 0.5), square_of(sums, k, points[n]));
    sum = hn::Add(sum, hn::Mul(hn::Set(d, weights[n]), value(lobe, x)));
  }
  return sum;
}

template <class L>
void add_lanes(const L& lobe, const Closeness& close, const ExactTexel& t, ExactSums& sums, std::vector<std::uint32_t>& left) {
  const D d;
  const V one = hn::Set(d, 1), half = hn::Set(d, 0.5), reach = hn::Set(d, t.reach);
  for (std::size_t k = 0; k < sums.direction[0].size(); k += hn::Lanes(d)) {
    const V distance = hn::Sqrt(square_of(sums, k, t.centre));
    const V near = hn::Max(hn::Zero(d), hn::Sub(distance, reach)), far = hn::Add(distance, reach);
    const V low = hn::Mul(half, hn::Mul(near, near)), high = hn::Mul(half, hn::Mul(far, far));
    const auto seen = hn::Lt(low, hn::Set(d, close.end));
    if (hn::AllFalse(d, seen)) continue;
    // How much of its value the lobe loses over the texel, at most.
    const V fall = hn::Mul(hn::Max(rate(lobe, low), rate(lobe, high)), hn::Mul(hn::Min(one, far), reach));
    const auto whole = hn::And(seen, hn::Lt(high, one));
    const auto faint = hn::And(seen, hn::Ge(low, hn::Set(d, close.faint)));
    const auto few = hn::Or(faint, hn::And(whole, hn::Lt(fall, hn::Set(d, t.simple ? 0.05 : 0.0))));
    const auto many = hn::AndNot(few, hn::And(whole, hn::Le(fall, hn::Set(d, close.most_uneven))));
    V part = hn::Zero(d);
    if (!hn::AllFalse(d, few)) part = hn::IfThenElseZero(few, over_points(lobe, sums, k, t.few, t.few_weights));
    if (!hn::AllFalse(d, many)) part = hn::IfThenElse(many, over_points(lobe, sums, k, t.many, t.many_weights), part);
    for (std::size_t c = 0; c < 3; ++c) {
      double* to = &sums.flux[c][k];
      hn::StoreU(hn::Add(hn::LoadU(d, to), hn::Mul(part, hn::Set(d, t.radiance[c]))), d, to);
    }
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::AndNot(hn::Or(few, many), seen), bits);
    for (std::size_t n = 0; n < hn::Lanes(d) && k + n < sums.count; ++n)
      if (bits[0] >> n & 1) left.push_back(static_cast<std::uint32_t>(k + n));
  }
}

void AddTexel(const Lobe& lobe, const Closeness& close, const ExactTexel& texel, ExactSums& sums,
              std::vector<std::uint32_t>& left) {
  std::visit([&](const auto& l) HWY_ATTR { add_lanes(l, close, texel, sums, left); }, lobe);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap {

HWY_EXPORT(AddTexel);

ExactSums::ExactSums(std::span<const Direction> directions) : count(directions.size()) {
  const std::size_t padded = (count + lanes - 1) / lanes * lanes;
  for (std::size_t n = 0; n < 3; ++n) {
    direction[n].resize(padded, 0), flux[n].resize(padded, 0);
    for (std::size_t k = 0; k < count; ++k) direction[n][k] = directions[k][static_cast<int>(n)];
  }
}

void add_texel(const Lobe& lobe, const Closeness& close, const ExactTexel& texel, ExactSums& sums,
               std::vector<std::uint32_t>& left) {
  left.clear();
  HWY_DYNAMIC_DISPATCH(AddTexel)(lobe, close, texel, sums, left);
}

}  // namespace envmap
#endif  // HWY_ONCE
