// Water as a field of columns: springs pull each towards the height of its eight neighbours, those across a corner with
// 1/sqrt(2) of the strength. What one gains its neighbour loses, so the volume stays what it is.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace water {

class HeightField {
 public:
  /// columns x rows of height 0, at rest.
  HeightField(int columns, int rows)
      : columns_(columns),
        rows_(rows),
        heights_(std::size_t(columns) * std::size_t(rows)),
        speeds_(heights_.size()) {}

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] double height(int i, int j) const { return heights_[index(i, j)]; }

  /// Raises all columns of one i: a straight wave.
  void raise(int i, double height) {
    for (int j = 0; j < rows_; ++j) heights_[index(i, j)] += height;
  }

  /// A drop: a dent that is as much lower in the middle as it is higher elsewhere, so that no water comes or goes.
  void drop(double x, double y, double radius, double depth) {
    double sum = 0;
    const auto dent = [&](int i, int j) {
      const double dx = (i - x) / radius, dy = (j - y) / radius;
      return depth * std::exp(-dx * dx - dy * dy);
    };
    for (int j = 0; j < rows_; ++j)
      for (int i = 0; i < columns_; ++i) sum += dent(i, j);
    for (int j = 0; j < rows_; ++j)
      for (int i = 0; i < columns_; ++i)
        heights_[index(i, j)] -= dent(i, j) - sum / double(heights_.size());
  }

  /// Speeds first, then heights with the new speeds (symplectic Euler): energy swings a little but does not drift.
  /// @param stiffness time step squared x spring x 1/mass: stable up to 4 / (4 + 8/sqrt(2)) = 0.41, of waves from column to
  /// column. @param kept part of the speed that one step leaves.
  void step(double stiffness, double kept = 1) {
    for_each_spring([&](std::size_t a, std::size_t b, double strength) {
      const double pull = stiffness * strength * (heights_[b] - heights_[a]);
      speeds_[a] += pull;
      speeds_[b] -= pull;
    });
    for (std::size_t k = 0; k < heights_.size(); ++k) heights_[k] += speeds_[k] *= kept;
  }

  /// Sum of all heights.
  [[nodiscard]] double volume() const {
    double sum = 0;
    for (const double h : heights_) sum += h;
    return sum;
  }

  /// Of movement and of the springs.
  [[nodiscard]] double energy(double stiffness) const {
    double sum = 0;
    for (const double v : speeds_) sum += 0.5 * v * v;
    for_each_spring([&](std::size_t a, std::size_t b, double strength) {
      const double stretch = heights_[b] - heights_[a];
      sum += 0.5 * stiffness * strength * stretch * stretch;
    });
    return sum;
  }

  /// Bilinear between columns; x and y in columns, held to the field.
  [[nodiscard]] double at(double x, double y) const {
    x = std::clamp(x, 0.0, columns_ - 1.001), y = std::clamp(y, 0.0, rows_ - 1.001);
    const int i = int(x), j = int(y);
    const double fx = x - i, fy = y - j;
    return (1 - fy) * ((1 - fx) * height(i, j) + fx * height(i + 1, j)) +
           fy * ((1 - fx) * height(i, j + 1) + fx * height(i + 1, j + 1));
  }

 private:
  [[nodiscard]] std::size_t index(int i, int j) const {
    return std::size_t(j) * std::size_t(columns_) + std::size_t(i);
  }

  // Each once: to the right, down, and both ways across.
  template <class F>
  void for_each_spring(F&& f) const {
    constexpr double across = 1 / std::numbers::sqrt2;
    for (int j = 0; j < rows_; ++j)
      for (int i = 0; i < columns_; ++i) {
        const std::size_t here = index(i, j);
        const bool right = i + 1 < columns_, down = j + 1 < rows_;
        if (right) f(here, index(i + 1, j), 1.0);
        if (down) f(here, index(i, j + 1), 1.0);
        if (right && down) f(here, index(i + 1, j + 1), across);
        if (i > 0 && down) f(here, index(i - 1, j + 1), across);
      }
  }

  int columns_, rows_;
  std::vector<double> heights_, speeds_;
};

}  // namespace water
