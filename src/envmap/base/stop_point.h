/// @file
/// A place in a long step of a loop where its operation may end.
#pragma once

namespace envmap {

/// Returns at once while the operation goes on. Loops look for a stop request between their steps by themselves:
/// steps of more than some hundredths of a second call this, too. @throws Cancelled where a stop was requested.
void stop_point();

}  // namespace envmap
