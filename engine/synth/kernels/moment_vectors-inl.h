// Vectors of moments, for the kernels: included once per instruction set, after Highway (its -inl.h convention).
#if defined(RINGDOWN_MOMENT_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RINGDOWN_MOMENT_VECTORS_INL_H
#undef RINGDOWN_MOMENT_VECTORS_INL_H
#else
#define RINGDOWN_MOMENT_VECTORS_INL_H
#endif

#include "engine/synth/kernels/frequency_grid.h"
#include "engine/synth/kernels/moments.h"

#include "engine/synth/kernels/mode_vectors-inl.h"

#include <span>

HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Source index of each element if two halves of kMoments are each rotated by some places.
struct MovedRound {
  alignas(64) std::int32_t of[kMoments][2 * kMoments] = {};
  constexpr MovedRound() {
    constexpr auto kHalf = static_cast<std::int32_t>(kMoments);
    for (std::int32_t by = 0; by < kHalf; ++by) {
      for (std::int32_t i = 0; i < 2 * kHalf; ++i) of[by][i] = i / kHalf * kHalf + (i + kHalf - by) % kHalf;
    }
  }
};
inline constexpr MovedRound kMovedRound;

// kCount numbers, in as few vectors as the instruction set allows.
template <std::size_t kCount>
struct Numbers {
  using Tag = hn::CappedTag<float, kCount>;
  static constexpr std::size_t kLanes = hn::MaxLanes(Tag()), kVectors = kCount / kLanes;
  hn::Vec<Tag> part[kVectors];

  HWY_INLINE Numbers() {}
  template <class Do>
  HWY_INLINE static Numbers make(Do&& act) {
    Numbers result;
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) result.part[v] = act(v);
    return result;
  }
  HWY_INLINE static Numbers load(const float* from) {
    return make([from](std::size_t v) HWY_ATTR { return hn::Load(Tag(), from + v * kLanes); });
  }
  HWY_INLINE static Numbers all(float value) {
    return make([value](std::size_t) HWY_ATTR { return hn::Set(Tag(), value); });
  }
  HWY_INLINE void store(float* to) const {
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) hn::Store(part[v], Tag(), to + v * kLanes);
  }
  [[nodiscard]] HWY_INLINE float sum() const {
    auto total = part[0];
    RINGDOWN_UNROLL
    for (std::size_t v = 1; v < kVectors; ++v) total = hn::Add(total, part[v]);
    return hn::GetLane(hn::SumOfLanes(Tag(), total));
  }
  // Returns the numbers with their halves swapped.
  [[nodiscard]] HWY_INLINE Numbers turned() const {
#if HWY_TARGET != HWY_SCALAR  // which has no vectors to swap
    if constexpr (kVectors == 1) {
      return make([this](std::size_t) HWY_ATTR { return hn::ConcatLowerUpper(Tag(), part[0], part[0]); });
    }
#endif
    return make([this](std::size_t v) HWY_ATTR { return part[(v + kVectors / 2) % kVectors]; });
  }
  // Returns the numbers with each half rotated up by `by` < kMoments elements.
  [[nodiscard]] HWY_INLINE Numbers moved_round(std::size_t by) const {
    static_assert(kMoments == 8 && kCount == 2 * kMoments);
#if HWY_TARGET != HWY_SCALAR
    if constexpr (kLanes >= kMoments) {
      const auto from = hn::SetTableIndices(Tag(), kMovedRound.of[by]);
      return make([&](std::size_t v) HWY_ATTR { return hn::TableLookupLanes(part[v], from); });
    }
#endif
    alignas(64) float from[kCount], to[kCount];
    store(from);
    for (std::size_t i = 0; i < kCount; ++i) to[i] = from[kMovedRound.of[by][i]];
    return load(to);
  }
  // Returns the moments of t times the function that these moments represent: multiplies element i of each half of
  // kMoments by i and moves up from i - 1. As exp(delta t) is a sum of x^p q_p(t), t exp(delta t) is a sum of p x^(p-1)
  // q_p(t).
  [[nodiscard]] HWY_INLINE Numbers times_t() const {
    alignas(64) static constexpr float kPower[16] = {0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7};
    static_assert(kMoments == 8 && kCount == 2 * kMoments);
#if HWY_TARGET != HWY_SCALAR
    if constexpr (kLanes >= kMoments) {
      alignas(64) static constexpr std::int32_t kBefore[16] = {0, 0, 1, 2, 3, 4, 5, 6, 0, 8, 9, 10, 11, 12, 13, 14};
      const auto before = hn::SetTableIndices(Tag(), kBefore);
      return make([&](std::size_t v) HWY_ATTR {
        return hn::Mul(hn::Load(Tag(), kPower + v * kLanes), hn::TableLookupLanes(part[v], before));
      });
    }
#endif
    alignas(64) float from[kCount], to[kCount];
    store(from);
    for (std::size_t i = 0; i < kCount; ++i) to[i] = i % kMoments == 0 ? 0.0f : kPower[i] * from[i - 1];
    return load(to);
  }
  friend HWY_INLINE Numbers operator+(Numbers a, Numbers b) {
    return make([&](std::size_t v) HWY_ATTR { return hn::Add(a.part[v], b.part[v]); });
  }
  friend HWY_INLINE Numbers operator-(Numbers a, Numbers b) {
    return make([&](std::size_t v) HWY_ATTR { return hn::Sub(a.part[v], b.part[v]); });
  }
  friend HWY_INLINE Numbers operator*(Numbers a, Numbers b) {
    return make([&](std::size_t v) HWY_ATTR { return hn::Mul(a.part[v], b.part[v]); });
  }
  friend HWY_INLINE Numbers multiply_add(Numbers a, Numbers b, Numbers c) {  // a b + c
    return make([&](std::size_t v) HWY_ATTR { return hn::MulAdd(a.part[v], b.part[v], c.part[v]); });
  }
  friend HWY_INLINE Numbers subtract_product(Numbers a, Numbers b, Numbers c) {  // c - a b
    return make([&](std::size_t v) HWY_ATTR { return hn::NegMulAdd(a.part[v], b.part[v], c.part[v]); });
  }
};
using Eight = Numbers<kMoments>;
using Pair = Numbers<2 * kMoments>;  // real parts, then imaginary ones

// For a band that begins at a given place: 1 at the places of lines that lie in the next block.
struct InNextBlock {
  alignas(64) float of[kGridReach][2 * kGridReach] = {};
  constexpr InNextBlock() {
    for (std::size_t begin = 0; begin < kGridReach; ++begin) {
      for (std::size_t place = 0; place < begin; ++place) of[begin][place] = of[begin][kGridReach + place] = 1;
    }
  }
};
inline constexpr InNextBlock kInNextBlock;

// Adds the lines of bands to a grid. Bands come mostly in ascending order, so the two blocks of kGridReach lines on
// which a band lies stay in registers.
class GridBlocks {
 public:
  HWY_INLINE explicit GridBlocks(const MomentGrid* grid) : grid_(grid), first_(Pair::all(0)), second_(Pair::all(0)) {}
  // `lines` has line i at index i modulo kGridReach.
  HWY_INLINE void add(std::size_t band, Pair lines) {
    if (band / kGridReach != block_) go_to(band / kGridReach);
    const Pair next = Pair::load(kInNextBlock.of[band % kGridReach]);
    first_ = first_ + subtract_product(next, lines, lines);
    second_ = multiply_add(next, lines, second_);
  }
  // Converts a band's moments to lines and adds these.
  HWY_INLINE void add_moments(std::size_t band, Pair moments) {
    alignas(64) float numbers[2 * kMoments];
    moments.store(numbers);
    Pair sum[4] = {Pair::all(0), Pair::all(0), Pair::all(0), Pair::all(0)};  // so that no sum waits for another
    RINGDOWN_UNROLL
    for (std::size_t p = 0; p < kMoments; ++p) {
      const float* const spread = grid_->spread + p * 4 * kGridReach;
      Pair *const by_re = sum + 2 * (p % 2), *const by_im = by_re + 1;
      *by_re = multiply_add(Pair::all(numbers[p]), Pair::load(spread), *by_re);
      *by_im = multiply_add(Pair::all(numbers[kMoments + p]), Pair::load(spread + 2 * kGridReach), *by_im);
    }
    add(band, ((sum[0] + sum[1]) + (sum[2] + sum[3])).moved_round(band % kGridReach));
  }
  HWY_INLINE void finish() const {
    give(block_, first_);
    if (block_ + 1 < kGridLines / kGridReach) give(block_ + 1, second_);
  }

 private:
  HWY_INLINE void go_to(std::size_t block) {
    give(block_, first_);
    if (block == block_ + 1) {
      first_ = second_;
    } else {
      if (block_ + 1 < kGridLines / kGridReach) give(block_ + 1, second_);
      first_ = Pair::all(0);
    }
    second_ = Pair::all(0);
    block_ = block;
  }
  HWY_INLINE void give(std::size_t block, Pair lines) const {
    float* const to = grid_->lines + block * 2 * kGridReach;
    (Pair::load(to) + lines).store(to);
  }
  const MomentGrid* grid_;
  std::size_t block_ = 0;
  Pair first_, second_;
};

// Destination of the bands' moments: sums of targets; those of one target whose gain stands still; a grid; or a grid,
// already in lines.
enum class Into { sums, one_sum, grid, grid_as_lines };
inline Into where_to(std::span<const MomentTarget> targets, bool lines_known) {
  if (targets.empty() || targets[0].grid == nullptr) return Into::sums;
  return lines_known ? Into::grid_as_lines : Into::grid;
}

template <Into kInto>
class Outlet {
 public:
  static constexpr bool kToGrid = kInto == Into::grid || kInto == Into::grid_as_lines;

  HWY_INLINE explicit Outlet(std::span<const MomentTarget> targets)
      : targets_(targets), grid_(kToGrid ? targets[0].grid : nullptr) {
    if constexpr (kInto == Into::one_sum) sums_ = targets[0].sums->of.data(), gain_ = targets[0].gain;
  }
  HWY_INLINE void give(Pair moments, std::size_t band, bool slopes) {
    if constexpr (kInto == Into::grid) return grid_.add_moments(band, moments);
    if constexpr (kInto == Into::grid_as_lines) return grid_.add(band, moments);
    if constexpr (kInto == Into::one_sum) {
      float* const sums = sums_ + band * 2 * kMoments;
      return multiply_add(Pair::all(gain_), moments, Pair::load(sums)).store(sums);
    }
    if (!slopes) {
      for (const MomentTarget& target : targets_) {
        float* const sums = target.sums->of.data() + band * 2 * kMoments;
        multiply_add(Pair::all(target.gain), moments, Pair::load(sums)).store(sums);
      }
      return;
    }
    const Pair sloping = moments.times_t();
    for (const MomentTarget& target : targets_) {
      float* const sums = target.sums->of.data() + band * 2 * kMoments;
      const Pair sum = multiply_add(Pair::all(target.gain), moments, Pair::load(sums));
      multiply_add(Pair::all(target.slope), sloping, sum).store(sums);
    }
  }
  HWY_INLINE void finish() const {
    if constexpr (kToGrid) grid_.finish();
  }

 private:
  std::span<const MomentTarget> targets_;
  float* sums_ = nullptr;  // of the one target, and its gain
  float gain_ = 0;
  GridBlocks grid_;
};

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // the toggle
