// Arrays aligned for the kernels' loads, at any vector size.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

namespace ringdown::synth {

inline constexpr std::align_val_t kVectorAlignment{64};

struct AlignedDelete {
  void operator()(void* block) const { ::operator delete[](block, kVectorAlignment); }
};
template <class T>
using AlignedArray = std::unique_ptr<T[], AlignedDelete>;

// Returns `count` zeros.
template <class T>
AlignedArray<T> aligned_zeros(std::size_t count) {
  AlignedArray<T> block(new (kVectorAlignment) T[count]);
  std::fill_n(block.get(), count, T{0});
  return block;
}

}  // namespace ringdown::synth
