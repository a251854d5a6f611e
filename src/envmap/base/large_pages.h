/// @file
/// Memory in pages of 2 MiB where the system has them.
#pragma once

#include <cstddef>
#include <memory>

#include "envmap/base/system.h"

namespace envmap {

/// An allocator that asks for them.
template <class T>
struct LargePages : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = LargePages<U>;
  };
  T* allocate(std::size_t count) {
    T* const data = std::allocator<T>::allocate(count);
    ask_for_large_pages(data, count * sizeof(T));
    return data;
  }
};

}  // namespace envmap
