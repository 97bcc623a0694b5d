// The multifrontal method, step by step.
//
// Supernodes are factored one after the other, children before parents. Each has a front, the dense matrix of its own
// columns and of the rows below them. assemble() fills the front with the entries of K - sigma M in the supernode's
// columns, take_update() adds the update that each child left, and eliminate() factors the columns by panels of kPanel
// pivots. The block below the pivots then holds the Schur complement, which keep_update() puts on a stack for the
// parent. The columns of L are stored as tiles (tiles.h), in the order in which the triangular solves read them.
#include "engine/solve/ldlt.h"

#include "engine/solve/methods.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>

namespace ringdown::solve {
namespace {

constexpr int kPanel = 48;     // pivots eliminated between two products of matrices
constexpr int kColumns = 128;  // columns of an update computed at once; the products above the diagonal are wasted

// Factors the lower triangle of a small matrix as L D L^T, in place.
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

// The number of columns to compute at a time, out of `all`, such that each of `count` threads gets several pieces.
int piece(int all, int count) {
  return count == 1 ? kColumns : std::clamp((all / (4 * count) + 7) / 8 * 8, 24, kColumns);
}

// The position at which column `c` of a packed lower triangle of `size` rows begins.
std::size_t packed(std::size_t c, std::size_t size) { return c * size - c * (c - 1) / 2; }

}  // namespace

// The front of one supernode at a time; one or several threads work on it.
struct Ldlt::Front {
  Numbers panel;                // height x pivots
  Numbers rest;                 // below x below: the Schur complement for the parent
  Numbers scaled;               // L D of the current pivots
  std::vector<Numbers> copies;  // L D of some rows, one copy per thread
  std::vector<int> row_of;      // each node's row in the front

  Front(int nodes, int threads) : copies(threads), row_of(nodes) {}
  void open(const Supernode& node);

  // Returns true if the member fills this column of the front: columns are dealt in turn, 24 at a time.
  static bool owns(const Member& member, int column) { return member.has(column / 24); }
};

void Ldlt::Front::open(const Supernode& node) {
  const std::size_t below = node.below();
  panel.resize(static_cast<std::size_t>(node.height()) * node.pivots());
  rest.resize(below * below);
  scaled.resize(static_cast<std::size_t>(node.height()) * kPanel);
  for (int c = 0; c < node.columns; ++c) row_of[node.first + c] = 3 * c;
  for (std::size_t r = 0; r < node.rows.size(); ++r) row_of[node.rows[r]] = node.pivots() + 3 * static_cast<int>(r);
}

// Each part has a stack of updates, and the crown has one. A supernode's update replaces those of its children.
Ldlt::Ldlt(const Elimination& plan, const OrderedSystem& system, Team& team)
    : plan_(plan), system_(system), team_(team), slots_(plan.nodes.size()) {
  for (int part = 0; part <= plan.parts(); ++part) {
    const bool crown = part == plan.parts();
    const int begin = crown ? plan.crown_begin() : plan.part_begin(part);
    const int end = crown ? static_cast<int>(plan.nodes.size()) : plan.part_end[part];
    std::size_t top = 0, max = 0;
    for (int s = begin; s < end; ++s) {
      for (const int child : plan.nodes[s].children) {
        if (child >= begin) top = std::min(top, slots_[child].offset);
      }
      const std::size_t below = plan.nodes[s].below();
      slots_[s] = {part, top};
      top += packed(below, below);
      max = std::max(max, top);
    }
    stack_sizes_.push_back(max);
  }
}

Ldlt::~Ldlt() = default;

void Ldlt::release_workspace() {
  stacks_.clear();
  fronts_.clear();
}

void Ldlt::open_workspace() {
  if (!stacks_.empty()) return;
  for (const std::size_t size : stack_sizes_) stacks_.emplace_back(size);
  for (int part = 0; part < plan_.parts(); ++part)
    fronts_.emplace_back(plan_.node_count(), part == 0 ? team_.size() : 1);
}

double* Ldlt::update_of(int supernode) { return stacks_[slots_[supernode].stack].data() + slots_[supernode].offset; }

void Ldlt::assemble(const Supernode& node, Front& front, const Member& member) const {
  const int height = node.height(), below = node.below();
  for (int c = 0; c < node.pivots(); ++c) {
    if (!Front::owns(member, c)) continue;
    double* const column = front.panel.data() + static_cast<std::ptrdiff_t>(c) * height;
    std::fill(column + c, column + height, 0.0);
  }
  for (int c = 0; c < below; ++c) {
    if (!Front::owns(member, node.pivots() + c)) continue;
    double* const column = front.rest.data() + static_cast<std::ptrdiff_t>(c) * below;
    std::fill(column + c, column + below, 0.0);
  }
  for (int c = 0; c < node.columns; ++c) {
    if (!Front::owns(member, 3 * c)) continue;
    for (std::size_t e = system_.begin(node.first + c); e < system_.end(node.first + c); ++e) {
      for (int j = 0; j < 3; ++j) {
        double* to =
            front.panel.data() + static_cast<std::ptrdiff_t>(3 * c + j) * height + front.row_of[system_.row(e)];
        for (int i = 0; i < 3; ++i) to[i] += system_.stiffness(e)[3 * i + j];
        to[j] -= sigma_ * system_.mass(e);
      }
    }
  }
}

void Ldlt::take_update(int child, const Supernode& node, Front& front, const Member& member) {
  const std::vector<int>& rows = plan_.nodes[child].rows;
  const int height = node.height(), pivots = node.pivots(), below = node.below();
  for (std::size_t c = 0; c < rows.size(); ++c) {
    const int column = front.row_of[rows[c]];
    if (!Front::owns(member, column)) continue;
    const double* from = update_of(child) + packed(3 * c, 3 * rows.size());
    for (int j = 0; j < 3; ++j) {
      double* to = column < pivots
                       ? front.panel.data() + static_cast<std::ptrdiff_t>(column + j) * height
                       : front.rest.data() + static_cast<std::ptrdiff_t>(column - pivots + j) * below - pivots;
      for (int i = j; i < 3; ++i) to[column + i] += *from++;
      for (std::size_t r = c + 1; r < rows.size(); ++r, from += 3) {
        double* at = to + front.row_of[rows[r]];
        at[0] += from[0];
        at[1] += from[1];
        at[2] += from[2];
      }
    }
  }
}

void Ldlt::keep_update(int supernode, const Front& front, const Member& member) {
  const int below = plan_.nodes[supernode].below();
  for (int c = 0; c < below; ++c) {
    if (!Front::owns(member, c)) continue;
    const double* column = front.rest.data() + static_cast<std::ptrdiff_t>(c) * below;
    std::copy(column + c, column + below, update_of(supernode) + packed(c, below));
  }
}

void Ldlt::eliminate(const Supernode& node, Front& front, const Member& member) {
  const int height = node.height(), pivots = node.pivots(), below = node.below();
  double* const panel = front.panel.data();
  double* const rest = front.rest.data();
  double* diagonal = diagonal_.data() + 3 * static_cast<std::ptrdiff_t>(node.first);
  const auto at = [&](int row, int column) { return panel + static_cast<std::ptrdiff_t>(column) * height + row; };
  for (int j = 0; j < pivots; j += kPanel) {
    const int width = std::min(kPanel, pivots - j), next = j + width;
    if (member.first() && !eliminate_small(at(j, j), width, height, diagonal + j)) singular_ = true;
    member.meet();
    if (singular_) return;
    const int begin = next + member.begin(height - next), end = next + member.end(height - next);
    if (begin < end) {
      cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasUnit, end - begin, width, 1, at(j, j), height,
                  at(begin, j), height);
    }
    for (int c = 0; c < width; ++c) {  // copies L D of the coming pivots, leaves L in place
      double* column = at(0, j + c);
      if (begin < pivots) {
        std::copy(column + begin, column + std::min(end, pivots),
                  front.scaled.data() + static_cast<std::ptrdiff_t>(c) * height + (begin - next));
      }
      const double inverse = 1 / diagonal[j + c];
      for (int i = begin; i < end; ++i) column[i] *= inverse;
    }
    member.meet();
    const int max = piece(pivots - next, member.count());
    for (int k = next, turn = 0; k < pivots; k += max, ++turn) {
      if (!member.has(turn)) continue;
      cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, height - k, std::min(max, pivots - k), width, -1, at(k, j),
                  height, front.scaled.data() + (k - next), height, 1, at(k, k), height);
    }
    member.meet();
  }
  const int max = piece(below, member.count());
  Numbers& copy = front.copies[member.number()];
  copy.resize(static_cast<std::size_t>(max) * pivots);
  for (int k = 0, turn = 0; k < below; k += max, ++turn) {
    if (!member.has(turn)) continue;
    const int columns = std::min(max, below - k);
    for (int p = 0; p < pivots; ++p) {
      for (int c = 0; c < columns; ++c) {
        copy[static_cast<std::size_t>(p) * columns + c] = *at(pivots + k + c, p) * diagonal[p];
      }
    }
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, below - k, columns, pivots, -1, at(pivots + k, 0), height,
                copy.data(), columns, 1, rest + static_cast<std::ptrdiff_t>(k) * below + k, below);
  }
  member.meet();
}

// All members of a team call this function with one range of supernodes, and meet at every step.
void Ldlt::factor_supernodes(int begin, int end, Front& front, const Member& member,
                             const std::function<bool()>& keep_going) {
  for (int s = begin; s < end; ++s) {
    const Supernode& node = plan_.nodes[s];
    if (member.first()) {
      if (keep_going && !keep_going()) cancelled_ = true;
      front.open(node);
    }
    member.meet();
    if (cancelled_) throw Cancelled{};
    assemble(node, front, member);
    for (const int child : node.children) take_update(child, node, front, member);
    member.meet();
    eliminate(node, front, member);
    if (singular_) return;
    const std::vector<Strip> strips = strips_of(node.pivots(), node.below());
    for (std::size_t i = 0; i < strips.size(); ++i) {
      if (member.has(static_cast<int>(i))) {
        to_tiles(strips[i], front.panel.data(), node.height(), tiles_.data() + node.offset);
      }
    }
    keep_update(s, front, member);
    member.meet();
  }
}

bool Ldlt::factor(double sigma, const std::function<bool()>& keep_going) {
  open_workspace();
  sigma_ = sigma;
  singular_ = cancelled_ = false;
  tiles_.resize(plan_.factor_entries);
  diagonal_.assign(3 * static_cast<std::size_t>(plan_.node_count()), 0.0);
  team_.run([&](int part) {
    if (part >= plan_.parts()) return;
    factor_supernodes(plan_.part_begin(part), plan_.part_end[part], fronts_[part], Member(),
                      part == 0 ? keep_going : std::function<bool()>());
  });
  if (singular_) return false;
  const int end = static_cast<int>(plan_.nodes.size());
  team_.run_together(
      [&](int, const Member& member) { factor_supernodes(plan_.crown_begin(), end, fronts_[0], member, keep_going); });
  negative_ = static_cast<int>(std::count_if(diagonal_.begin(), diagonal_.end(), [](double d) { return d < 0; }));
  return !singular_;
}

// Each part solves its own rows. Its contributions to the crown's rows stay in the part's own array until all parts are
// done.
void Ldlt::solve(double* x, int vectors) const {
  const int crown = plan_.crown_begin(), end = static_cast<int>(plan_.nodes.size());
  const std::ptrdiff_t crown_row = plan_.first_column(crown),
                       crown_size = std::ptrdiff_t{3} * vectors * plan_.crown_columns();
  double* const crown_rows = x + std::ptrdiff_t{3} * vectors * crown_row;
  std::vector<std::vector<double>> for_crown(plan_.parts());
  const auto sides = [&](const Supernode& node, const Strip& strip, double* for_rows_of_crown) {
    const auto split = std::lower_bound(node.rows.begin(), node.rows.end(), crown_row) - node.rows.begin();
    return Sides{.own = x + std::ptrdiff_t{vectors} * (3 * node.first + strip.first),
                 .later = node.pivots() - strip.first - strip.width,
                 .rows = &node.rows,
                 .split = static_cast<int>(split),
                 .first_of_crown = static_cast<int>(crown_row),
                 .x = x,
                 .crown = for_rows_of_crown,
                 .vectors = vectors};
  };
  const auto down = [&](int begin, int stop, double* for_rows_of_crown, const Member& member) {
    for (int s = begin; s < stop; ++s) {
      const Supernode& node = plan_.nodes[s];
      const double* const tiles = tiles_.data() + node.offset;
      for (const Strip& strip : strips_of(node.pivots(), node.below())) {
        const Sides all = sides(node, strip, for_rows_of_crown);
        if (member.first()) solve_down_own(strip, tiles, all);
        member.meet();
        solve_down_below(strip, tiles, all, member.begin(strip.tiles()), member.end(strip.tiles()));
        member.meet();
      }
    }
  };
  const auto up = [&](int begin, int stop, const Member& member) {
    for (int s = stop; s-- > begin;) {
      const Supernode& node = plan_.nodes[s];
      const double* const tiles = tiles_.data() + node.offset;
      const std::vector<Strip> strips = strips_of(node.pivots(), node.below());
      for (auto strip = strips.rbegin(); strip != strips.rend(); ++strip) {
        const Sides all = sides(node, *strip, crown_rows);
        const int first = member.begin(strip->width), last = member.end(strip->width);
        for (int u = first; u < last; ++u) {
          const double pivot = diagonal_[static_cast<std::size_t>(3) * node.first + strip->first + u];
          if (vectors == 1) {
            all.own[u] /= pivot;
          } else {
            *lanes(all.own, u) /= pivot;
          }
        }
        solve_up_below(*strip, tiles, all, first, last);
        member.meet();
        if (member.first()) solve_up_own(*strip, tiles, all);
        member.meet();
      }
    }
  };
  team_.run_together([&](int number, const Member& member) {
    const bool has_part = number < plan_.parts();
    if (has_part) {
      for_crown[number].assign(crown_size, 0.0);
      down(plan_.part_begin(number), plan_.part_end[number], for_crown[number].data(), Member());
    }
    member.meet();
    for (const auto& share : for_crown) {
      for (std::ptrdiff_t i = member.begin(crown_size); i < member.end(crown_size); ++i) crown_rows[i] += share[i];
    }
    member.meet();
    down(crown, end, crown_rows, member);
    up(crown, end, member);
    if (has_part) up(plan_.part_begin(number), plan_.part_end[number], Member());
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
