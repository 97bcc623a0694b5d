#include "engine/modal/levels/mode_followers.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace ringdown::modal {
namespace {

constexpr double kOfBody = 0.9;  // share of the strain energy above which a mode is the body's
constexpr double kSure = 0.9;
constexpr double kShared = 0.1;  // of the largest likeness, from which on a mode shares the motion

}  // namespace

std::vector<std::size_t> followers(std::vector<double> likeness, const std::vector<double>& body_shares,
                                   std::size_t count) {
  const std::size_t modes = body_shares.size();
  for (std::size_t m = 0; m < modes && count > 0; ++m) {
    const std::span<double> row(&likeness[m * count], count);
    const double largest = std::ranges::max(row);
    if (body_shares[m] < kOfBody && largest < kSure)
      *std::ranges::find_if(row, [=](double own) { return own >= kShared * largest; }) = largest;
  }
  std::vector<std::size_t> pairs(modes * count), found(modes, count);
  std::iota(pairs.begin(), pairs.end(), std::size_t{0});
  std::ranges::stable_sort(pairs, [&](std::size_t a, std::size_t b) { return likeness[a] > likeness[b]; });
  std::vector<bool> taken(count);
  for (const std::size_t pair : pairs) {
    const std::size_t mode = pair / count, other = pair % count;
    if (found[mode] < count || taken[other]) continue;
    found[mode] = other;
    taken[other] = true;
  }
  return found;
}

}  // namespace ringdown::modal
