/// @file
/// Values that lie in rows, by the indices that people use.
#pragma once

#include <cassert>
#include <cstddef>
#include <span>

namespace envmap {

/// Images of width x height one below the other, a face each. Nothing is owned.
/// Indices are checked where assertions are on.
template <class T>
class ImageView {
 public:
  /// @param values faces x height x width of them, rows from the top.
  ImageView(std::span<T> values, int width, int height, int faces = 1)
      : values_(values.data()), width_(width), height_(height), faces_(faces) {
    assert(values.size() == count(width, height, faces));
  }

  /// How many values such an image has.
  [[nodiscard]] static std::size_t count(int width, int height, int faces = 1) {
    return std::size_t(faces) * std::size_t(height) * std::size_t(width);
  }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int faces() const { return faces_; }

  [[nodiscard]] T& operator()(int face, int i, int j) const {
    assert(face >= 0 && face < faces_ && i >= 0 && i < width_ && j >= 0 && j < height_);
    return values_[(std::ptrdiff_t(face) * height_ + j) * width_ + i];
  }
  [[nodiscard]] T& operator()(int i, int j) const { return (*this)(0, i, j); }
  [[nodiscard]] std::span<T> row(int face, int j) const { return {&(*this)(face, 0, j), std::size_t(width_)}; }

 private:
  T* values_;
  int width_, height_, faces_;
};

}  // namespace envmap
