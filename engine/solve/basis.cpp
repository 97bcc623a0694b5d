#include "engine/solve/basis.h"

#include <algorithm>
#include <array>

namespace ringdown::solve {
namespace {

constexpr Eigen::Index kChunk = 384;  // unknowns at a time, so that their part of x stays in the first cache

// Calls act(first unknown, number of unknowns) for each chunk of this member's share.
template <class Do>
void each_chunk(Eigen::Index unknowns, const Member& member, Do&& act) {
  const Eigen::Index chunks = (unknowns + kChunk - 1) / kChunk;
  for (Eigen::Index c = member.begin(chunks); c < member.end(chunks); ++c) {
    act(c * kChunk, std::min(kChunk, unknowns - c * kChunk));
  }
}

// y_b x^T for each block y_b, one below the other.
Eigen::MatrixXd all_inner_products(Team& team, const std::vector<const double*>& blocks, const Block& x) {
  std::vector<std::vector<Small>> sums(team.size(), std::vector<Small>(blocks.size(), Small::Zero()));
  team.run_together([&](int number, const Member& member) {
    each_chunk(x.cols(), member, [&](Eigen::Index first, Eigen::Index count) {
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        add_inner_products(blocks[b] + first * kWidth, x.data() + first * kWidth, count, sums[number][b]);
      }
    });
  });
  Eigen::MatrixXd result(kWidth * static_cast<Eigen::Index>(blocks.size()), kWidth);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    auto rows = result.middleRows<kWidth>(static_cast<Eigen::Index>(b) * kWidth);
    rows = sums[0][b];
    for (int part = 1; part < team.size(); ++part) rows += sums[part][b];
  }
  return result;
}

void subtract_all(Team& team, const std::vector<const double*>& blocks, const std::vector<Small>& factors, Block& x) {
  team.run_together([&](int, const Member& member) {
    each_chunk(x.cols(), member, [&](Eigen::Index first, Eigen::Index count) {
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        subtract_combination(blocks[b] + first * kWidth, factors[b], x.data() + first * kWidth, count);
      }
    });
  });
}

void copy_numbers(Team& team, const Block& from, double* to) {
  team.run_together([&](int, const Member& member) {
    const Eigen::Index begin = member.begin(from.size()), end = member.end(from.size());
    std::copy(from.data() + begin, from.data() + end, to + begin);
  });
}

}  // namespace

Small inner_products(Team& team, const Block& y, const Block& x) { return all_inner_products(team, {y.data()}, x); }

void combine_in_place(Team& team, const Small& factors, Block& x) {
  team.run_together([&](int, const Member& member) {
    const Eigen::Index first = member.begin(x.cols());
    combine_in_place(factors, x.data() + first * kWidth, member.end(x.cols()) - first);
  });
}

void copy(Team& team, const Block& from, Block& to) {
  to.resize(kWidth, from.cols());
  copy_numbers(team, from, to.data());
}

void Basis::append(const Block& block) {
  unknowns_ = block.cols();
  copy_numbers(team_, block, blocks_.emplace_back(block.size()).data());
}

std::vector<const double*> Basis::block_data() const {
  std::vector<const double*> data;
  for (const Numbers& block : blocks_) data.push_back(block.data());
  return data;
}

Eigen::MatrixXd Basis::inner_products(const Block& x) const { return all_inner_products(team_, block_data(), x); }

void Basis::subtract_combination(const Eigen::MatrixXd& factors, Block& x) const {
  std::vector<Small> by_block;
  for (int row = 0; row < size(); row += kWidth) by_block.push_back(factors.middleRows<kWidth>(row));
  subtract_all(team_, block_data(), by_block, x);
}

void Basis::subtract_combination(int block, const Small& factors, Block& x) const {
  subtract_all(team_, {blocks_[block].data()}, {factors}, x);
}

Eigen::MatrixXd Basis::combine(const Eigen::MatrixXd& factors) const {
  Eigen::MatrixXd result(unknowns_, factors.cols());
  team_.run_together([&](int, const Member& member) {
    Eigen::MatrixXd chunk(kChunk, size());
    each_chunk(unknowns_, member, [&](Eigen::Index first, Eigen::Index count) {
      for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const Eigen::Map<const Block> block(blocks_[b].data(), kWidth, unknowns_);
        chunk.block(0, static_cast<Eigen::Index>(b) * kWidth, count, kWidth) =
            block.middleCols(first, count).transpose();
      }
      result.middleRows(first, count).noalias() = chunk.topRows(count) * factors;
    });
  });
  return result;
}

}  // namespace ringdown::solve
