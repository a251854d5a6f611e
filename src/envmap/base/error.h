/// @file
/// The four ways an operation fails. The program turns each into its exit status; nothing else is thrown on purpose.
#pragma once

#include <stdexcept>

namespace envmap {

/// What was asked makes no sense (exit status 2).
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An input is unreadable or not what it claims to be (exit status 3).
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An output could not be written; nothing was left behind (exit status 4).
struct OutputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// There is nothing to draw with (exit status 5).
struct RendererError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace envmap
