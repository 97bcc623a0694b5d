#include "engine/scene/fixed_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

// Every contact point has a row for its normal and, with friction, two rows across it. A row is a direction J in the
// space of the body's velocities and spins. The impulses p of all rows change the rows' speeds by A p, with
// A = J M^-1 J^T plus the softness on the diagonal. Each row's impulse lies between two bounds, and the row's speed is
// the wanted one unless its impulse is at a bound: a linear complementarity problem. A is positive definite, so there
// is one solution.
//
// Block principal pivoting finds it (J. Judice, F. Pires, "A block principal pivoting algorithm for large-scale
// strictly monotone linear complementarity problems", 1994). Rows are free, or at one of their bounds. The system of
// the free rows is solved by a Cholesky factorisation; then every row that violates its condition changes sides: a free
// row whose impulse is beyond a bound, and a row at a bound whose speed asks for an impulse within its bounds. When the
// number of such rows has not fallen for kPatience rounds, only the last of them changes sides until it falls, which
// cannot cycle (Murty's rule). Two or three rounds are usual.
namespace ringdown::scene {
namespace {

constexpr int kMaxRows = 3 * static_cast<int>(kMaxFixedContacts);
constexpr int kPatience = 4, kMaxRounds = 400;

// Violations smaller than this share of the largest impulse or speed are rounding errors.
constexpr double kRounding = 1e-11;

enum class At { free, low, high };

struct Row {
  Vec3 way, turn;              // J
  Vec3 way_given, turn_given;  // M^-1 J^T
  double missing_m_s = 0;      // the wanted speed less that without contacts
  double low = 0, high = 0;    // bounds of the impulse
  At at = At::free;
  double impulse = 0;
};

class System {
 public:
  void begin(double softness) {
    softness_ = softness;
    count_ = 0;
  }

  void add(const FreeBody& body, const FixedContact& contact, Vec3 way, double wanted_m_s) {
    Row& row = rows_[count_];
    row.low = row.high = row.impulse = 0;
    row.at = At::free;
    row.way = way;
    row.turn = cross(contact.arm_m, way);
    row.way_given = body.inverse_mass * way;
    row.turn_given = body.inverse_inertia * row.turn;
    row.missing_m_s = wanted_m_s - dot(way, body.velocity_m_s) - dot(row.turn, body.spin_rad_s);
    for (int k = 0; k <= count_; ++k) {
      matrix_[count_][k] = matrix_[k][count_] = dot(row.way, rows_[k].way_given) + dot(row.turn, rows_[k].turn_given);
    }
    matrix_[count_][count_] += softness_;
    ++count_;
  }

  [[nodiscard]] Row& row(int k) { return rows_[k]; }

  // Solves the first `count` rows within their bounds, from the sides on which they are.
  bool solve(int count) {
    double scale_m_s = 0;
    for (int k = 0; k < count; ++k) scale_m_s = std::max(scale_m_s, std::abs(rows_[k].missing_m_s));
    int fewest = count + 1, patience = kPatience;
    for (int round = 0; round < kMaxRounds; ++round) {
      if (!solve_free(count)) return false;
      std::array<int, kMaxRows> wrong;
      const int wrongs = find_wrong(count, scale_m_s, wrong);
      if (wrongs == 0) return true;
      if (wrongs < fewest) {
        fewest = wrongs;
        patience = kPatience;
      }
      if (patience-- > 0) {
        for (int k = 0; k < wrongs; ++k) change(rows_[wrong[k]]);
      } else {
        change(rows_[wrong[wrongs - 1]]);
      }
    }
    return false;
  }

 private:
  static void change(Row& row) {
    if (row.at != At::free) {
      row.at = At::free;
    } else {
      row.at = row.impulse < row.low ? At::low : At::high;
    }
  }

  // Gives the free rows the impulses that bring all of them to their wanted speeds, and the other rows their bounds.
  bool solve_free(int count) {
    std::array<int, kMaxRows> free;
    int n = 0;
    for (int k = 0; k < count; ++k) {
      Row& row = rows_[k];
      if (row.at == At::free) {
        free[n++] = k;
      } else {
        row.impulse = row.at == At::low ? row.low : row.high;
      }
    }
    std::array<double, kMaxRows> x;
    for (int i = 0; i < n; ++i) {
      x[i] = rows_[free[i]].missing_m_s;
      for (int k = 0; k < count; ++k) {
        if (rows_[k].at != At::free) x[i] -= matrix_[free[i]][k] * rows_[k].impulse;
      }
      for (int j = 0; j <= i; ++j) {
        double sum = matrix_[free[i]][free[j]];
        for (int k = 0; k < j; ++k) sum -= factor_[i][k] * factor_[j][k];
        if (j < i) {
          factor_[i][j] = sum * inverse_diagonal_[j];
        } else if (sum > 0) {
          factor_[i][i] = std::sqrt(sum);
          inverse_diagonal_[i] = 1 / factor_[i][i];
        } else {
          return false;
        }
      }
      for (int j = 0; j < i; ++j) x[i] -= factor_[i][j] * x[j];
      x[i] *= inverse_diagonal_[i];
    }
    for (int i = n - 1; i >= 0; --i) {
      for (int j = i + 1; j < n; ++j) x[i] -= factor_[j][i] * x[j];
      x[i] *= inverse_diagonal_[i];
      rows_[free[i]].impulse = x[i];
    }
    return true;
  }

  int find_wrong(int count, double scale_m_s, std::array<int, kMaxRows>& wrong) const {
    double scale_ns = 0;
    for (int k = 0; k < count; ++k) scale_ns = std::max(scale_ns, std::abs(rows_[k].impulse));
    int wrongs = 0;
    for (int i = 0; i < count; ++i) {
      const Row& row = rows_[i];
      if (row.at == At::free) {
        const double slack_ns = kRounding * scale_ns;
        if (row.impulse < row.low - slack_ns || row.impulse > row.high + slack_ns) wrong[wrongs++] = i;
        continue;
      }
      if (row.low == row.high) continue;
      double over_m_s = -row.missing_m_s, largest_m_s = scale_m_s;
      for (int k = 0; k < count; ++k) {
        const double change_m_s = matrix_[i][k] * rows_[k].impulse;
        over_m_s += change_m_s;
        largest_m_s = std::max(largest_m_s, std::abs(change_m_s));
      }
      const double slack_m_s = kRounding * largest_m_s;
      if (row.at == At::low ? over_m_s < -slack_m_s : over_m_s > slack_m_s) wrong[wrongs++] = i;
    }
    return wrongs;
  }

  double softness_ = 0;
  int count_ = 0;
  std::array<Row, kMaxRows> rows_;
  std::array<std::array<double, kMaxRows>, kMaxRows> matrix_{}, factor_{};
  std::array<double, kMaxRows> inverse_diagonal_{};
};

// Bounds the two rows of a contact's friction. A row at a bound stays at that side.
void bound(System& system, int row, double max_ns) {
  for (int k = row; k < row + 2; ++k) {
    Row& across = system.row(k);
    across.low = -max_ns;
    across.high = max_ns;
    if (max_ns == 0 && across.at == At::free) across.at = At::low;
  }
}

}  // namespace

double FrictionBound::meet(double asked) {
  const double lacks = asked - bound_;
  if (!std::exchange(begun_, true) || lacks == 0) {
    bound_ = asked;
    return std::abs(lacks);
  }
  const bool too_low = lacks > 0;
  std::optional<Tried>&same = too_low ? low_ : high_, &opposite = too_low ? high_ : low_;
  double next = asked;
  if (opposite) {
    if (was_too_low_ == too_low) opposite->lacks *= 0.5;
    next = bound_ + lacks * (opposite->bound - bound_) / (lacks - opposite->lacks);
  } else if (same) {
    const double slope = (lacks - same->lacks) / (bound_ - same->bound);
    if (slope < 0) next = bound_ - lacks / slope;
  }
  same = {bound_, lacks};
  was_too_low_ = too_low;
  bound_ = std::max(next, 0.0);
  return std::abs(lacks);
}

Vec3 any_across(Vec3 normal) {
  if (std::abs(normal.z) > M_SQRT1_2) {
    const double scale = 1 / std::hypot(normal.y, normal.z);
    return {0, -scale * normal.z, scale * normal.y};
  }
  const double scale = 1 / std::hypot(normal.x, normal.y);
  return {-scale * normal.y, scale * normal.x, 0};
}

bool solve_fixed_contacts(const FreeBody& body, std::span<const FixedContact> contacts, double softness, bool lands,
                          std::span<Vec3> impulses_ns) {
  const int count = static_cast<int>(contacts.size());
  thread_local System system;  // clearing its room takes longer than most solutions
  system.begin(softness);
  std::array<int, kMaxFixedContacts> friction_row{};  // the first of two rows; 0: none
  for (const FixedContact& contact : contacts) {
    system.add(body, contact, contact.normal, contact.wanted_m_s);
  }
  for (int k = 0; k < count; ++k) system.row(k).high = INFINITY;
  int rows = count;
  if (!system.solve(count)) return false;
  for (int k = 0; k < count; ++k) {
    const FixedContact& contact = contacts[k];
    if (contact.friction == 0) continue;
    friction_row[k] = rows;
    rows += 2;
    system.add(body, contact, contact.along, 0);
    system.add(body, contact, cross(contact.normal, contact.along), 0);
  }
  std::array<FrictionBound, kMaxFixedContacts> bounds;
  const auto bound_all = [&] {  // returns whether the bounds agreed with the impulses
    double largest_ns = 0, change_ns = 0;
    for (int k = 0; k < count; ++k) {
      if (friction_row[k] == 0) continue;
      const double asked_ns = contacts[k].friction * std::max(system.row(k).impulse, 0.0);
      largest_ns = std::max(largest_ns, asked_ns);
      change_ns = std::max(change_ns, bounds[k].meet(asked_ns));
      bound(system, friction_row[k], bounds[k].value());
    }
    return change_ns <= kFrictionAgrees * largest_ns;
  };
  const auto read = [&] {
    for (int k = 0; k < count; ++k) {
      const auto [way, along] = std::pair(contacts[k].normal, contacts[k].along);
      impulses_ns[k] = std::max(system.row(k).impulse, 0.0) * way;
      if (friction_row[k] == 0) continue;
      impulses_ns[k] = impulses_ns[k] + system.row(friction_row[k]).impulse * along +
                       system.row(friction_row[k] + 1).impulse * cross(way, along);
    }
  };
  if (rows > count) {
    bound_all();
    if (!system.solve(rows)) return false;
  }
  read();
  if (!lands || rows == count) return true;
  for (int round = 0; round < kMaxFrictionRounds; ++round) {
    if (bound_all()) {
      read();
      break;
    }
    if (!system.solve(rows)) break;
  }
  return true;
}

}  // namespace ringdown::scene
