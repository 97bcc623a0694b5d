// Runs a check of kernels with every instruction set that this machine has.
#pragma once

#include <hwy/targets.h>

#include <cstdint>

namespace ringdown::synth::test {

// Calls check(name of the instruction set).
template <class Check>
void on_every_instruction_set(const Check& check) {
  for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & -rest);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    check(hwy::TargetName(rest & -rest));
    hwy::SetSupportedTargetsForTest(0);
  }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace ringdown::synth::test
