/// @file
/// Values between key frames.
#pragma once

#include <algorithm>
#include <vector>

#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

template <class T>
T between(const T& a, const T& b, double t) {
  return T(a + (b - a) * t);
}
inline Quaternion between(const Quaternion& a, const Quaternion& b, double t) { return glm::slerp(a, b, t); }

/// The value at a time; `rest` where there are no keys.
template <class T>
T value_at(const std::vector<Animation::Key<T>>& keys, double time, const T& rest) {
  if (keys.empty()) return rest;
  const auto next = std::ranges::upper_bound(keys, time, {}, &Animation::Key<T>::time);
  if (next == keys.begin()) return keys.front().value;
  const auto last = std::prev(next);
  if (next == keys.end()) return last->value;
  return between(last->value, next->value, (time - last->time) / (next->time - last->time));
}

}  // namespace envmap
