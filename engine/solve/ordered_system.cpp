#include "engine/solve/ordered_system.h"

#include <algorithm>

namespace ringdown::solve {

namespace {

// Returns block `number` of a node's column from the lower triangle, where column 3n + j keeps rows j..2 of the
// diagonal block, then three rows of each other block.
std::array<double, 9> block_of(const fem::SparseMatrix& stiffness, int node, int number, bool transposed) {
  const int* outer = stiffness.outerIndexPtr();
  const double* values = stiffness.valuePtr();
  std::array<double, 9> block{};
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const bool mirrored = number == 0 && i < j;
      const int column = mirrored ? i : j, row = mirrored ? j : i;
      block[transposed ? 3 * j + i : 3 * i + j] = values[outer[3 * node + column] + 3 * number - column + row];
    }
  }
  return block;
}

}  // namespace

OrderedSystem::OrderedSystem(const fem::System& system, const Elimination& plan, Team& team)
    : plan_(plan), team_(team) {
  const int count = plan.node_count();
  const fem::SparseMatrix &stiffness = system.stiffness, &mass = system.node_mass;
  const int *outer = stiffness.outerIndexPtr(), *inner = stiffness.innerIndexPtr();
  std::vector<std::size_t> fill(count + 1, 0);
  const auto each_block = [&](auto&& visit) {  // (column node, row node, number of the block in its column)
    for (int n = 0; n < count; ++n) {
      visit(n, n, 0);
      int k = 1;
      for (int e = outer[3 * n] + 3; e < outer[3 * n + 1]; e += 3) visit(n, inner[e] / 3, k++);
    }
  };
  each_block([&](int column, int row, int) { ++fill[std::min(plan.new_of[column], plan.new_of[row]) + 1]; });
  for (int n = 0; n < count; ++n) fill[n + 1] += fill[n];
  first_ = fill;
  struct Source {  // the place of a block of K
    int row, from_column, number;
    bool transposed;
  };
  std::vector<Source> sources(first_[count]);
  each_block([&](int column, int row, int number) {
    const int new_column = plan.new_of[column], new_row = plan.new_of[row];
    sources[fill[std::min(new_column, new_row)]++] = {std::max(new_column, new_row), column, number,
                                                      new_row < new_column};
  });
  rows_.reserve(sources.size());
  stiffnesses_.reserve(sources.size());
  for (int n = 0; n < count; ++n) {
    const auto begin_of = sources.begin() + static_cast<std::ptrdiff_t>(first_[n]);
    const auto end_of = sources.begin() + static_cast<std::ptrdiff_t>(first_[n + 1]);
    std::sort(begin_of, end_of, [](const Source& a, const Source& b) { return a.row < b.row; });
    for (auto source = begin_of; source != end_of; ++source) {
      rows_.push_back(source->row);
      stiffnesses_.push_back(block_of(stiffness, source->from_column, source->number, source->transposed));
    }
  }
  masses_.resize(sources.size());
  std::vector<double> mass_to(count, 0);
  for (int n = 0; n < count; ++n) {
    const int old = plan.old_of[n];
    for (fem::SparseMatrix::InnerIterator m(mass, old); m; ++m) mass_to[plan.new_of[m.row()]] = m.value();
    for (std::size_t e = begin(n); e < end(n); ++e) masses_[e] = mass_to[rows_[e]];
    for (fem::SparseMatrix::InnerIterator m(mass, old); m; ++m) mass_to[plan.new_of[m.row()]] = 0;
  }
}

// The place to which a part adds its results: y itself for rows before `split`, and the part's own array for rows of
// the crown until all parts are done.
struct OrderedSystem::Target {
  double* rows;
  double* crown;  // rows from `split` on
  int split;

  [[nodiscard]] Lanes* at(int node) const {
    return node < split ? lanes(rows, 3 * std::ptrdiff_t{node}) : lanes(crown, 3 * std::ptrdiff_t{node - split});
  }
};

RINGDOWN_CLONES
void OrderedSystem::mass_columns(int begin_column, int end_column, const double* x, const Target& y) const {
  for (int n = begin_column; n < end_column; ++n) {
    const Lanes* const own = lanes(x, 3 * std::ptrdiff_t{n});
    Lanes sum[3] = {masses_[begin(n)] * own[0], masses_[begin(n)] * own[1], masses_[begin(n)] * own[2]};
    for (std::size_t e = begin(n) + 1; e < end(n); ++e) {
      const Lanes* const from = lanes(x, 3 * std::ptrdiff_t{rows_[e]});
      Lanes* const to = y.at(rows_[e]);
      for (int i = 0; i < 3; ++i) {
        sum[i] += masses_[e] * from[i];
        to[i] += masses_[e] * own[i];
      }
    }
    for (int i = 0; i < 3; ++i) y.at(n)[i] += sum[i];
  }
}

RINGDOWN_CLONES
void OrderedSystem::stiffness_columns(int begin_column, int end_column, const double* x, const Target& y) const {
  for (int n = begin_column; n < end_column; ++n) {
    const Lanes* const own = lanes(x, 3 * std::ptrdiff_t{n});
    Lanes sum[3] = {};
    for (std::size_t e = begin(n); e < end(n); ++e) {
      const double* const k = stiffnesses_[e].data();
      const Lanes* const from = lanes(x, 3 * std::ptrdiff_t{rows_[e]});
      for (int j = 0; j < 3; ++j) sum[j] += k[j] * from[0] + k[3 + j] * from[1] + k[6 + j] * from[2];
      if (rows_[e] == n) continue;
      Lanes* const to = y.at(rows_[e]);
      for (int i = 0; i < 3; ++i) to[i] += k[3 * i] * own[0] + k[3 * i + 1] * own[1] + k[3 * i + 2] * own[2];
    }
    for (int j = 0; j < 3; ++j) y.at(n)[j] += sum[j];
  }
}

void OrderedSystem::multiply(Columns columns, const Block& x, Block& y) const {
  y.resize(kWidth, x.cols());
  const int crown = plan_.first_column(plan_.crown_begin());
  const std::ptrdiff_t offset = std::ptrdiff_t{3 * kWidth} * crown,
                       crown_size = std::ptrdiff_t{3 * kWidth} * plan_.crown_columns();
  std::vector<std::vector<double>> for_crown(plan_.parts());
  team_.run([&](int part) {
    if (part >= plan_.parts()) return;
    const int first = plan_.first_column(plan_.part_begin(part)), last = plan_.first_column(plan_.part_end[part]);
    std::fill(y.data() + std::ptrdiff_t{3 * kWidth} * first, y.data() + std::ptrdiff_t{3 * kWidth} * last, 0.0);
    for_crown[part].assign(crown_size, 0.0);
    (this->*columns)(first, last, x.data(), {y.data(), for_crown[part].data(), crown});
  });
  std::copy_n(for_crown[0].data(), crown_size, y.data() + offset);
  for (int part = 1; part < plan_.parts(); ++part) {
    for (std::ptrdiff_t i = 0; i < crown_size; ++i) y.data()[offset + i] += for_crown[part][i];
  }
  (this->*columns)(crown, node_count(), x.data(), {y.data(), y.data() + offset, crown});
}

void OrderedSystem::times_mass(const Block& x, Block& y) const { multiply(&OrderedSystem::mass_columns, x, y); }

void OrderedSystem::times_stiffness(const Block& x, Block& y) const {
  multiply(&OrderedSystem::stiffness_columns, x, y);
}

Eigen::VectorXd OrderedSystem::residuals(const Eigen::VectorXd& lambda, const Eigen::MatrixXd& shapes) const {
  Eigen::VectorXd result(lambda.size());
  Block x = Block::Zero(kWidth, unknowns()), stiff, heavy;
  for (Eigen::Index first = 0; first < lambda.size(); first += kWidth) {
    const Eigen::Index count = std::min<Eigen::Index>(kWidth, lambda.size() - first);
    team_.run_together([&](int, const Member& member) {
      for (int n = member.begin(node_count()); n < member.end(node_count()); ++n) {
        const Eigen::Index row = Eigen::Index{3} * plan_.old_of[n];
        x.middleCols<3>(Eigen::Index{3} * n).topRows(count) = shapes.block(row, first, 3, count).transpose();
      }
    });
    times_stiffness(x, stiff);
    times_mass(x, heavy);
    heavy.topRows(count).array().colwise() *= lambda.segment(first, count).array();
    result.segment(first, count) = (stiff - heavy).topRows(count).rowwise().norm();
    result.segment(first, count).array() /= heavy.topRows(count).rowwise().norm().array();
  }
  return result;
}

}  // namespace ringdown::solve
