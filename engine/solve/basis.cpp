#include "engine/solve/basis.h"

#include <algorithm>

namespace ringdown::solve {
namespace {

constexpr Eigen::Index kChunk = 384;  // unknowns at a time: their part of x stays in the first cache

// Thread `part` of `parts` gets the chunks of its share of the unknowns.
template <class Do>
void each_chunk(Eigen::Index unknowns, int part, int parts, Do&& act) {
  const Eigen::Index chunks = (unknowns + kChunk - 1) / kChunk;
  for (Eigen::Index c = chunks * part / parts; c < chunks * (part + 1) / parts; ++c) {
    act(c * kChunk, std::min(kChunk, unknowns - c * kChunk));
  }
}

}  // namespace

Eigen::MatrixXd Basis::inner_products(const Block& x) const {
  std::vector<std::vector<Small>> sums(team_.size(), std::vector<Small>(blocks_.size(), Small::Zero()));
  team_.run([&](int part) {
    each_chunk(x.cols(), part, team_.size(), [&](Eigen::Index first, Eigen::Index count) {
      for (std::size_t b = 0; b < blocks_.size(); ++b) {
        add_inner_products(blocks_[b].data() + first * kWidth, x.data() + first * kWidth, count, sums[part][b]);
      }
    });
  });
  Eigen::MatrixXd result(size(), kWidth);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    auto rows = result.middleRows<kWidth>(static_cast<Eigen::Index>(b) * kWidth);
    rows = sums[0][b];
    for (int part = 1; part < team_.size(); ++part) rows += sums[part][b];
  }
  return result;
}

void Basis::subtract_combination(const Eigen::MatrixXd& factors, Block& x) const {
  team_.run([&](int part) {
    each_chunk(x.cols(), part, team_.size(), [&](Eigen::Index first, Eigen::Index count) {
      for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const Small block_factors = factors.middleRows<kWidth>(static_cast<Eigen::Index>(b) * kWidth);
        solve::subtract_combination(blocks_[b].data() + first * kWidth, block_factors, x.data() + first * kWidth,
                                    count);
      }
    });
  });
}

Eigen::MatrixXd Basis::combine(const Eigen::MatrixXd& factors) const {
  const Eigen::Index unknowns = blocks_.empty() ? 0 : blocks_[0].cols();
  Eigen::MatrixXd result(unknowns, factors.cols());
  team_.run([&](int part) {
    Eigen::MatrixXd chunk(kChunk, size());
    each_chunk(unknowns, part, team_.size(), [&](Eigen::Index first, Eigen::Index count) {
      for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const Eigen::Index column = static_cast<Eigen::Index>(b) * kWidth;
        chunk.block(0, column, count, kWidth) = blocks_[b].middleCols(first, count).transpose();
      }
      result.middleRows(first, count).noalias() = chunk.topRows(count) * factors;
    });
  });
  return result;
}

}  // namespace ringdown::solve
