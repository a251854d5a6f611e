// Runs a test once for every instruction set that was compiled and that this machine has.
#pragma once

#include <hwy/targets.h>

namespace envmap {

template <class F>
void on_every_target(F&& test) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    test(hwy::TargetName(target));
  }
  hwy::SetSupportedTargetsForTest(0);  // All of them again.
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace envmap
