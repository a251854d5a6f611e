"""The recipes "Where to add things" of docs/architecture.md, followed: adds an invented projection, lobe and file format to a copy of
the sources, builds the program, and holds what it makes of them against known answers. Every file that is changed here must be
named in its recipe, and every file that the recipes name must be there.

  extend.py ROOT [FOLDER]      FOLDER: where the copy and its build stay (default: a temporary folder)
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(sys.argv[1]).resolve()
PARTS = ('CMakeLists.txt', 'LICENSE', 'README.md', 'cmake', 'man', 'packaging', 'src', 'tools')  # What a build reads.


class Recipe:
    """Changes of a copy by one recipe of the page."""

    def __init__(self, copy, title):
        section = (ROOT / 'docs/architecture.md').read_text().split('\n## Where to add things\n')[1].split('\n## ')[0]
        self.copy, self.title, self.text = copy, title, section.split(f'\n### {title}\n')[1].split('\n### ')[0]

    def path(self, name):
        """A file that the recipe names."""
        named = f'`{name}`' in self.text or f'`{re.sub("(drum|veil|plain)", "NAME", name)}`' in self.text
        assert named, f'docs/architecture.md, "{self.title}": does not name {name}, which has to be changed'
        return self.copy / name

    def add(self, name, text):
        path = self.path(name)
        assert not path.exists(), name
        path.write_text(text)

    def change(self, name, pattern, replacement):
        """Replaces the only text that matches; \\g<0> is that text itself."""
        path = self.path(name)
        text, count = re.subn(pattern, replacement, path.read_text(), flags=re.S | re.M)
        assert count == 1, f'{name}: {count} places for {pattern!r}'
        path.write_text(text)


# ---- a projection: Lambert's equal-area cylinder (1772) on a square: longitude across, height down --------------------

DRUM_H = '''/// @file
/// Lambert's equal-area cylinder (1772), its sides made equal: longitude across, height down.
#pragma once

#include <cmath>
#include <limits>

#include "envmap/maths/portable.h"
#include "envmap/projection/projection.h"

namespace envmap {

struct Drum {
  static constexpr Projection id = Projection::drum;
  static constexpr const char* name = "drum";
  static constexpr int faces = 1, aspect = 1;
  static constexpr double span = 180, stretch = std::numeric_limits<double>::infinity();  // Towards a pole.
  static constexpr bool on_disc = false, filled = true, has_forward = true;

  /// Beyond a pole the map goes on with the meridian opposite.
  template <class T>
  static Vec3<T> direction(int /*face*/, T u, T v) {
    double y = 1 - 2.0 * v, longitude = 2 * (0.5 - u);  // Over pi.
    if (std::abs(y) > 1) y = std::copysign(2, y) - y, longitude += 1;
    const double r = std::sqrt((1 - y) * (1 + y));
    return Vec3<T>(r * portable::sin_pi(longitude), y, r * portable::cos_pi(longitude));
  }
  template <class T>
  static Location<T> locate(const Vec3<T>& d) {
    return {0, static_cast<T>(0.5 - portable::atan2(double(d.x), double(d.z)) / (2 * pi)),
            static_cast<T>(0.5 - 0.5 * d.y)};
  }
  static double density(double /*u*/, double /*v*/) { return 4 * pi; }
  static double solid_angle(const Rect& r) { return 4 * pi * (r.u1 - r.u0) * (r.v1 - r.v0); }
};

}  // namespace envmap
'''
DRUM_DIRECTION = '''template <class D, class V>
HWY_INLINE void direction(Drum, D d, const Scale& scale, int /*face*/, V a, V b, V& x, V& y, V& z) {
  const V n = hn::Set(d, scale.n), one = hn::Set(d, 1);
  y = hn::Div(b, n);
  const auto beyond = hn::Gt(hn::Abs(y), one);
  y = hn::IfThenElse(beyond, hn::Sub(hn::CopySign(hn::Set(d, 2), y), y), y);
  V sine, cosine;
  sin_cos_pi(d, hn::Sub(hn::IfThenElseZero(beyond, one), hn::Div(a, n)), sine, cosine);
  const V r = hn::Sqrt(hn::Mul(hn::Sub(one, y), hn::Add(one, y)));
  x = hn::Mul(r, sine);
  z = hn::Mul(r, cosine);
}

'''
DRUM_LOCATE = '''template <class D, class V>
HWY_INLINE void locate(Drum, D d, V x, V y, V z, V& face, V& u, V& v) {
  const V half = hn::Set(d, 0.5);
  face = hn::Zero(d);
  u = hn::Sub(half, hn::Mul(half, atan2_pi(d, x, z)));
  v = hn::Sub(half, hn::Mul(half, y));
}

'''


def add_projection(copy):
    at = Recipe(copy, 'A projection')
    at.add('src/envmap/projection/drum.h', DRUM_H)
    at.change('src/envmap/projection/projection.h', r'(enum class Projection \{[^}]*)\}', r'\1, drum}')
    at.change('src/envmap/projection/projection.h', r'(all_projections\[\] = \{[^}]*)\}', r'\1, Projection::drum}')
    at.change('src/envmap/projection/visit.h', r'^#include "envmap/projection/equal_area.h"\n', r'#include "envmap/projection/drum.h"\n\g<0>')
    at.change('src/envmap/projection/visit.h', r'(using Projections = ProjectionList<[^>]*)>', r'\1, Drum>')
    at.change('src/envmap/projection/lanes-inl.h', r'^// -+ direction -> place', lambda m: DRUM_DIRECTION + m[0])
    at.change('src/envmap/projection/lanes-inl.h', r'^}  // namespace HWY_NAMESPACE', lambda m: DRUM_LOCATE + m[0])
    at.change('src/envmap/sample/area.cpp', r'if \(source\.projection\(\) == Projection::equal_area\) return 1;',
              r'\g<0>\n  if (source.projection() == Projection::drum) return 1;')


# ---- a lobe: (t + t^2) x 3/5 / pi of the cosine t, which is 3/5 of the diffuse lobe and 2/5 of Phong's of exponent 2 ----

VEIL = '''/// An invented lobe: value = (t + t^2) 3 / (5 pi), t = 1 - x.
struct Veil {
  static constexpr double scale = 0.6 / pi;
  static double whole(double t) { return t * t * (0.6 + 0.4 * t); }
  [[nodiscard]] double value(double x) const { return x < 1 ? scale * (1 - x) * (2 - x) : 0; }
  [[nodiscard]] double share(double x) const { return x < 1 ? 1 - whole(1 - x) : 1; }
  [[nodiscard]] double missing(double x) const { return x < 1 ? whole(1 - x) : 0; }
  [[nodiscard]] double rate(double x) const { return x < 1 ? (3 - 2 * x) / ((1 - x) * (2 - x)) : 0; }
  [[nodiscard]] double peak() const { return 0; }
  [[nodiscard]] double width() const { return 0.5; }
  [[nodiscard]] double kink() const { return scale; }
};

'''
VEIL_VALUE = '''
template <class D, class V>
HWY_INLINE V value(const Veil& l, D d, V x) {
  const V t = hn::Max(hn::Zero(d), hn::Sub(broadcast(d, 1), x));
  return broadcast(d, l.scale) * (t * (broadcast(d, 1) + t));
}
'''
VEIL_RATE = '''HWY_INLINE V log_slope(const Veil&, V x) {
  const D d;
  const V t = hn::Sub(hn::Set(d, 1), x), more = hn::Add(t, hn::Set(d, 1));
  return hn::Div(hn::Add(more, t), hn::Mul(t, more));
}

'''
VEIL_REST = '''
// Nothing is left of a polynomial that prefix sums take whole.
template <>
struct Rest<Veil> {
  explicit Rest(const Veil&) {}
  HWY_INLINE Taylor taylor(V) const { return {broadcast(0), broadcast(0), broadcast(0)}; }
  HWY_INLINE Bounds over(V, V, hn::Mask<LaneTag>) const {
    const V none = broadcast(0);
    return {none, none, none, none, none, none, none, none, none};
  }
};

'''


def add_lobe(copy):
    at = Recipe(copy, 'A lobe')
    prefilter = 'src/envmap/prefilter/'
    at.change(prefilter + 'lobe_formulas.h', r'^using LobeFormula = std::variant<[^>]*', lambda m: VEIL + m[0] + ', Veil')
    at.change(prefilter + 'lobe_formulas.h', r'RadialLobe<Charlie>\)', r'RadialLobe<Charlie> && RadialLobe<Veil>)')
    at.change(prefilter + 'lobe_lanes-inl.h', r'^}  // namespace HWY_NAMESPACE', lambda m: VEIL_VALUE + m[0])
    at.change(prefilter + 'exact/exact_kernels.cpp', r'^HWY_INLINE V square_of\(', lambda m: VEIL_RATE + m[0])
    at.change(prefilter + 'lobe_in_rectangle.cpp', r'^ENVMAP_ROUND\(Cube, Charlie\);', r'\g<0>\nENVMAP_ROUND(Latlong, Veil);\nENVMAP_ROUND(Cube, Veil);')
    at.change(prefilter + 'treecode/lobe_bounds-inl.h', r'^}  // namespace HWY_NAMESPACE', lambda m: VEIL_REST + m[0])
    at.change(prefilter + 'prefix_sums/prefix_sums.cpp', r'^std::optional<ClampedCosinePolynomial> clamped_cosine_polynomial\(const LobeFormula& lobe\) \{\n',
              r'\g<0>  if (std::holds_alternative<Veil>(lobe)) return ClampedCosinePolynomial{{Veil::scale, Veil::scale, 0}};\n')
    at.change(prefilter + 'lobe.h', r'(enum class LobeShape \{[^}]*), table\}', r'\1, veil, table}')
    at.change(prefilter + 'lobe.h', r'(lobe_shape_names\[\] = \{[^}]*), "table"\}', r'\1, "veil", "table"}')
    at.change(prefilter + 'lobe.cpp', r'if \(shape == LobeShape::diffuse\) \{', r'if (shape == LobeShape::diffuse || shape == LobeShape::veil) {')
    at.change(prefilter + 'lobe_formulas.cpp', r'    case LobeShape::diffuse: return Cosine\{\};\n', r'\g<0>    case LobeShape::veil: return Veil{};\n')
    at.change('tools/commands/prefilter.cpp', r'else if \(o\.shape != LobeShape::diffuse\)\s+p\.lobe = Lobe\(o\.shape, parameters\[k\]\);', r'else p.lobe = o.shape == LobeShape::diffuse || o.shape == LobeShape::veil ? Lobe(o.shape) : Lobe(o.shape, parameters[k]);')


# ---- a file format: a line of size, then the floats ---------------------------------------------------------------------

PLAIN_H = '''/// @file
/// An invented format: "PLAIN width height", then rows of floats from the top.
#pragma once

#include "envmap/base/run.h"
#include "envmap/io/files/input_file.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/images/image_reader.h"
#include "envmap/map/atlas.h"

namespace envmap {

struct TexturePlan;

ImageReader open_plain(const InputFile& file);
void write_plain(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress);

}  // namespace envmap
'''
PLAIN_CPP = '''#include "envmap/io/formats/plain.h"

#include <cstdio>

#include "envmap/base/error.h"

namespace envmap {
namespace {

constexpr std::size_t texels_begin = 32;

}  // namespace

ImageReader open_plain(const InputFile& file) {
  char text[texels_begin + 1] = {};
  int width = 0, height = 0;
  if (file.pread(text, texels_begin, 0) != texels_begin || std::sscanf(text, "PLAIN %d %d", &width, &height) != 2 || width < 1 ||
      height < 1)
    throw InputError("damaged: its first line has no size");
  ImageFacts facts{.width = width, .height = height, .names = false, .channels = {"R", "G", "B"}};
  return {.format = "plain",
          .facts = facts,
          .read = [&file, width](int, int begin, int end, int first, int count, std::span<float> out) {
            std::vector<float> row(3 * std::size_t(width));
            float* to = out.data();
            for (int y = begin; y < end; ++y) {
              if (file.pread(row.data(), 4 * row.size(), texels_begin + std::uint64_t(y) * 4 * row.size()) != 4 * row.size())
                throw InputError("it ends too early");
              for (std::size_t k = std::size_t(first); k < row.size(); k += 3)
                for (std::size_t c = k; c < k + std::size_t(count); ++c) *to++ = row[c];
            }
          }};
}

void write_plain(OutputFile& file, std::span<const Atlas> levels, const TexturePlan&, const Progress&) {
  const Atlas& atlas = levels[0];
  char text[texels_begin + 1] = {};
  std::snprintf(text, sizeof text, "PLAIN %d %d", atlas.width(), atlas.height());
  file.put(text, texels_begin);
  std::vector<Colour> row(std::size_t(atlas.width()));
  for (int y = 0; y < atlas.height(); ++y) {
    atlas.gather(y, y + 1, row);
    file.put(row.data(), row.size() * sizeof(Colour));
  }
}

}  // namespace envmap
'''
PLAIN_ROW = '''constexpr Extension plain_extension[] = {"plain"};
constexpr FileFormat plain{
    .name = "plain",
    .title = "Plain",
    .extensions = plain_extension,
    .depths = floats,
    .is_head = [](Head h) { return h.starts_with("PLAIN "); },
    .open = [](Image& i, const ImageChoice&) { i.reader = open_plain(*i.file); },
    .write = write_plain,
};

'''


def add_format(copy):
    at = Recipe(copy, 'A file format')
    at.add('src/envmap/io/formats/plain.h', PLAIN_H)
    at.add('src/envmap/io/formats/plain.cpp', PLAIN_CPP)
    at.change('src/envmap/CMakeLists.txt', r' io/formats/pfm\.cpp', r'\g<0> io/formats/plain.cpp')
    table = 'src/envmap/io/formats/file_format.cpp'
    at.change(table, r'^#include "envmap/io/formats/png.h"', r'#include "envmap/io/formats/plain.h"\n\g<0>')
    at.change(table, r'^// In the order in which people are told of them\.\n', lambda m: PLAIN_ROW + m[0])
    at.change(table, r'^    float_map,\n', r'\g<0>    plain,\n')


# ---- building and trying -----------------------------------------------------------------------------------------------

def build(copy):
    """Warnings are errors, so that a switch that forgets an enumerator is found. Two instruction sets are enough."""
    top = copy / 'CMakeLists.txt'
    text, count = re.subn(r'set\(disabled_targets "\(HWY_SSSE3\|\(HWY_AVX3-1\)\)"\)', 'set(disabled_targets "(HWY_SSSE3|HWY_SSE4|(HWY_AVX2-1))")', top.read_text())
    assert count == 1, 'CMakeLists.txt: no disabled_targets'
    top.write_text(text)
    # At -O0 fmt asks for -Og in its headers, and GCC's header of prefetches then takes no constants.
    options = ['-DCMAKE_BUILD_TYPE=None', '-DCMAKE_CXX_FLAGS=-Og', '-DENVMAP_WERROR=ON', '-DENVMAP_TESTS=OFF', '-DENVMAP_SAMPLES=OFF']
    for command in (['cmake', '-G', 'Ninja', '-S', copy, '-B', copy / 'build', *options], ['cmake', '--build', copy / 'build', '--target', 'envmap_program']):
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            errors = [line for line in done.stdout.splitlines() if 'error' in line]
            sys.exit('\n'.join([*errors[:20], done.stdout[-4000:], done.stderr[-2000:]]))
    return copy / 'build/envmap'


def envmap(program, line):
    done = subprocess.run([program, *line.split()], capture_output=True, text=True)
    assert done.returncode == 0, f'envmap {line}: {done.stdout}{done.stderr}'
    return done.stdout


def try_all(program):
    def run(*lines):
        return [envmap(program, line) for line in lines][-1]

    assert 'drum' in run('convert --help') and 'veil' in run('prefilter --help')
    # Directions in a drum are those of a panorama.
    run('generate directions drum.exr --to drum --size 128 --depth float', 'convert drum.exr unrolled.exr --to latlong --size 32 --filter bilinear',
        'generate directions panorama.exr --size 32 --depth float', 'compare unrolled.exr panorama.exr --max-rms 2e-3',
        'convert panorama.exr rolled.exr --to drum --size 16 --filter area --depth float')
    assert re.search(r'^projection +drum', run('info drum.exr'), re.M), run('info drum.exr')
    # What was put together out of two lobes is the sum of their maps, by whichever method.
    run('generate sun sun.exr --size 32 --radius 20 --to latlong --depth float',
        'prefilter sun.exr a.exr --size 6 --depth float --method exact -q', 'convert a.exr a6.exr --gain 0.6',
        'prefilter sun.exr b.exr --size 6 --depth float --method exact -q --lobe phong --exponent 2', 'convert b.exr b4.exr --gain 0.4',
        'convert a6.exr truth.exr --add b4.exr')
    for method in ('exact', 'auto'):
        run(f'prefilter sun.exr veil.exr --size 6 --depth float -q --lobe veil --method {method}', 'compare veil.exr truth.exr --max-error 2e-3')
    # A file comes back as it was.
    run('convert sun.exr sun.plain', 'convert sun.plain back.exr --filter nearest', 'compare back.exr sun.exr --max-error 0')
    assert 'plain' in run('info sun.plain') and pathlib.Path('sun.plain').stat().st_size == 32 + 12 * 64 * 32


def missing_files():
    """What the section names and the sources lack."""
    section = (ROOT / 'docs/architecture.md').read_text().split('\n## Where to add things\n')[1].split('\n## ')[0]
    named = re.findall(r'`((?:src|tools|tests|samples|man|docs)/[\w./-]+)`', section)
    return [name for name in named if 'NAME' not in name and not (ROOT / name).exists()]


def main(folder):
    missing = missing_files()
    assert not missing, f'docs/architecture.md, "Where to add things" names what is not there: {missing}'
    copy = pathlib.Path(folder).resolve() / 'sources'
    copy.mkdir(parents=True)
    for part in PARTS:
        (shutil.copytree if (ROOT / part).is_dir() else shutil.copy)(ROOT / part, copy / part)
    for add in (add_projection, add_lobe, add_format):
        add(copy)
    program = build(copy)
    os.chdir(folder)
    try_all(program)


if len(sys.argv) > 2:
    main(sys.argv[2])
else:
    with tempfile.TemporaryDirectory() as scratch:
        main(scratch)
        os.chdir('/')
