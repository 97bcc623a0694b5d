#include "engine/solve/ldlt.h"

#include "engine/fem/blas_threads.h"
#include "engine/solve/methods.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>

namespace ringdown::solve {
namespace {

constexpr int kPanel = 48;     // pivots eliminated between products of matrices
constexpr int kColumns = 128;  // of an update computed at once: what lies above the diagonal is wasted

// L D L^T of the lower triangle of a small matrix, in place.
bool eliminate_small(double* a, int size, int stride, double* diagonal) {
  for (int c = 0; c < size; ++c) {
    double* column = a + static_cast<std::ptrdiff_t>(c) * stride;
    const double pivot = diagonal[c] = column[c];
    if (!(std::abs(pivot) > 0) || !std::isfinite(pivot)) return false;
    for (int j = c + 1; j < size; ++j) {
      const double factor = column[j] / pivot;
      double* target = a + static_cast<std::ptrdiff_t>(j) * stride;
      for (int i = j; i < size; ++i) target[i] -= factor * column[i];
    }
    for (int i = c + 1; i < size; ++i) column[i] /= pivot;
  }
  return true;
}

}  // namespace

// Where one thread works on one supernode after the other.
struct Ldlt::Front {
  std::vector<double> panel;   // height x pivots
  std::vector<double> rest;    // below x below: what is left for the parent
  std::vector<double> scaled;  // L D
  std::vector<int> place;      // row of a node in the front
};

void Ldlt::assemble(const Supernode& node, Front& front) const {
  const int height = node.height();
  for (int c = 0; c < node.columns; ++c) {
    for (std::size_t e = system_.begin(node.first + c); e < system_.end(node.first + c); ++e) {
      for (int j = 0; j < 3; ++j) {
        double* to = front.panel.data() + static_cast<std::ptrdiff_t>(3 * c + j) * height + front.place[system_.row(e)];
        for (int i = 0; i < 3; ++i) to[i] += system_.stiffness(e)[3 * i + j];
        to[j] -= sigma_ * system_.mass(e);
      }
    }
  }
}

void Ldlt::take_update(int child, const Supernode& node, Front& front) {
  const std::vector<int>& rows = plan_.nodes[child].rows;
  const int height = node.height(), pivots = node.pivots(), below = node.below();
  const double* from = updates_[child].data();
  for (std::size_t c = 0; c < rows.size(); ++c) {
    const int column = front.place[rows[c]];
    for (int j = 0; j < 3; ++j) {
      double* to = column < pivots
                       ? front.panel.data() + static_cast<std::ptrdiff_t>(column + j) * height
                       : front.rest.data() + static_cast<std::ptrdiff_t>(column - pivots + j) * below - pivots;
      for (int i = j; i < 3; ++i) to[column + i] += *from++;
      for (std::size_t r = c + 1; r < rows.size(); ++r, from += 3) {
        double* at = to + front.place[rows[r]];
        at[0] += from[0], at[1] += from[1], at[2] += from[2];
      }
    }
  }
  std::vector<double>().swap(updates_[child]);
}

bool Ldlt::eliminate(const Supernode& node, Front& front) {
  const int height = node.height(), pivots = node.pivots(), below = node.below();
  double* const panel = front.panel.data();
  double* const rest = front.rest.data();
  std::vector<double>& scaled = front.scaled;
  double* diagonal = diagonal_.data() + 3 * static_cast<std::ptrdiff_t>(node.first);
  const auto at = [&](int row, int column) { return panel + static_cast<std::ptrdiff_t>(column) * height + row; };
  scaled.resize(std::max(static_cast<std::size_t>(height) * kPanel, static_cast<std::size_t>(kColumns) * pivots));
  for (int j = 0; j < pivots; j += kPanel) {
    const int width = std::min(kPanel, pivots - j), next = j + width, rows = height - next;
    if (!eliminate_small(at(j, j), width, height, diagonal + j)) return false;
    if (rows == 0) continue;
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasUnit, rows, width, 1, at(j, j), height,
                at(next, j), height);
    for (int c = 0; c < width; ++c) {  // keep L D of the pivots to come, leave L
      double* column = at(next, j + c);
      std::copy_n(column, pivots - next, scaled.data() + static_cast<std::ptrdiff_t>(c) * height);
      const double inverse = 1 / diagonal[j + c];
      for (int i = 0; i < rows; ++i) column[i] *= inverse;
    }
    for (int k = next; k < pivots; k += kColumns) {
      const int columns = std::min(kColumns, pivots - k);
      cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, height - k, columns, width, -1, at(k, j), height,
                  scaled.data() + (k - next), height, 1, at(k, k), height);
    }
  }
  for (int k = 0; k < below; k += kColumns) {
    const int columns = std::min(kColumns, below - k);
    for (int p = 0; p < pivots; ++p) {
      for (int c = 0; c < columns; ++c) {
        scaled[static_cast<std::size_t>(p) * columns + c] = *at(pivots + k + c, p) * diagonal[p];
      }
    }
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, below - k, columns, pivots, -1, at(pivots + k, 0), height,
                scaled.data(), columns, 1, rest + static_cast<std::ptrdiff_t>(k) * below + k, below);
  }
  return true;
}

bool Ldlt::factor_supernodes(int begin, int end, Front& front, const std::function<bool()>& keep_going) {
  for (int s = begin; s < end; ++s) {
    if (keep_going && !keep_going()) throw Cancelled{};
    const Supernode& node = plan_.nodes[s];
    const std::size_t below = node.below();
    front.panel.assign(static_cast<std::size_t>(node.height()) * node.pivots(), 0.0);
    front.rest.assign(below * below, 0.0);
    for (int c = 0; c < node.columns; ++c) front.place[node.first + c] = 3 * c;
    for (std::size_t r = 0; r < node.rows.size(); ++r) {
      front.place[node.rows[r]] = node.pivots() + 3 * static_cast<int>(r);
    }
    assemble(node, front);
    for (const int child : node.children) take_update(child, node, front);
    if (!eliminate(node, front)) return false;
    to_tiles(front.panel.data(), node.height(), node.pivots(), node.below(), tiles_.data() + node.offset);
    updates_[s].reserve(below * (below + 1) / 2);
    for (std::size_t c = 0; c < below; ++c) {
      const double* column = front.rest.data() + c * below;
      updates_[s].insert(updates_[s].end(), column + c, column + below);
    }
  }
  return true;
}

bool Ldlt::factor(double sigma, const std::function<bool()>& keep_going) {
  sigma_ = sigma;
  tiles_.resize(plan_.factor_entries);
  diagonal_.assign(3 * static_cast<std::size_t>(plan_.node_count()), 0.0);
  updates_.assign(plan_.nodes.size(), {});
  std::vector<Front> fronts(plan_.parts(), Front{.place = std::vector<int>(plan_.node_count())});
  std::vector<char> good(plan_.parts(), 0);
  team_.run([&](int part) {
    if (part >= plan_.parts()) return;
    good[part] = factor_supernodes(plan_.part_begin(part), plan_.part_end[part], fronts[part],
                                   part == 0 ? keep_going : std::function<bool()>());
  });
  if (std::find(good.begin(), good.end(), 0) != good.end()) return false;
  const fem::BlasThreads all(team_.size());
  const int end = static_cast<int>(plan_.nodes.size());
  if (!factor_supernodes(plan_.crown_begin(), end, fronts[0], keep_going)) return false;
  negative_ = static_cast<int>(std::count_if(diagonal_.begin(), diagonal_.end(), [](double d) { return d < 0; }));
  return true;
}

// Each part works on its own rows and keeps what it has for the crown's rows apart until all are done.
void Ldlt::solve(Block& x) const {
  const int crown = plan_.crown_begin(), end = static_cast<int>(plan_.nodes.size());
  const std::ptrdiff_t crown_row = plan_.first_column(crown),
                       crown_size = std::ptrdiff_t{3 * kWidth} * plan_.crown_columns();
  const auto own = [&](const Supernode& node) { return x.data() + std::ptrdiff_t{3 * kWidth} * node.first; };
  std::vector<std::vector<double>> for_crown(plan_.parts(), std::vector<double>(crown_size, 0.0));
  const auto down = [&](int begin, int stop, double* crown_rows) {
    for (int s = begin; s < stop; ++s) {
      const Supernode& node = plan_.nodes[s];
      const auto split = std::lower_bound(node.rows.begin(), node.rows.end(), crown_row) - node.rows.begin();
      solve_down(tiles_.data() + node.offset, node.pivots(), node.rows, static_cast<int>(split), own(node), x.data(),
                 crown_rows - std::ptrdiff_t{3 * kWidth} * crown_row);
    }
  };
  const auto up = [&](int begin, int stop) {
    for (int s = stop; s-- > begin;) {
      const Supernode& node = plan_.nodes[s];
      double* const rows = own(node);
      for (int u = 0; u < node.pivots(); ++u) {
        for (int v = 0; v < kWidth; ++v)
          rows[u * kWidth + v] /= diagonal_[3 * static_cast<std::size_t>(node.first) + u];
      }
      solve_up(tiles_.data() + node.offset, node.pivots(), node.rows, rows, x.data());
    }
  };
  team_.run([&](int part) {
    if (part < plan_.parts()) down(plan_.part_begin(part), plan_.part_end[part], for_crown[part].data());
  });
  double* const crown_rows = x.data() + std::ptrdiff_t{3 * kWidth} * crown_row;
  for (const auto& share : for_crown) {
    for (std::ptrdiff_t i = 0; i < crown_size; ++i) crown_rows[i] += share[i];
  }
  down(crown, end, crown_rows);
  up(crown, end);
  team_.run([&](int part) {
    if (part < plan_.parts()) up(plan_.part_begin(part), plan_.part_end[part]);
  });
}

double Ldlt::backward_error() const {
  Block right(kWidth, system_.unknowns()), stiff, heavy;
  for (Eigen::Index u = 0; u < right.cols(); ++u) {
    for (int v = 0; v < kWidth; ++v) right(v, u) = std::cos(static_cast<double>((u + 1) * (v + 1)));
  }
  double largest = 0;
  for (int n = 0; n < system_.node_count(); ++n) {
    for (const int i : {0, 4, 8}) largest = std::max(largest, system_.stiffness(system_.begin(n))[i]);
  }
  Block x = right;
  solve(x);
  system_.times_stiffness(x, stiff);
  system_.times_mass(x, heavy);
  return (stiff - sigma_ * heavy - right).norm() / (largest * x.norm() + right.norm());
}

}  // namespace ringdown::solve
