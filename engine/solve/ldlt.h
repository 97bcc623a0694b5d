// K - sigma M = L D L^T by a multifrontal method, without pivoting: its signs count eigenvalues. [worker]
//
//   Ldlt factors(plan, system, team);
//   factors.factor(sigma);
//   factors.negative();          // eigenvalues of K phi = lambda M phi below sigma (Sylvester)
//   factors.solve(block);        // x = (K - sigma M)^-1 x
//
// Rows are not exchanged for stability. The factorization is accurate unless sigma is very close to an eigenvalue of a
// leading part of the system. backward_error() then rises, and the caller moves the shift. Each thread factors one part
// of the plan, all parts at the same time; then all threads together factor the supernodes of the crown. Source: Duff &
// Reid, ACM Trans. Math. Softw. 9, 1983; Parlett, The Symmetric Eigenvalue Problem, section 3.3 on inertia.
#pragma once

#include "engine/solve/large_pages.h"
#include "engine/solve/ordered_system.h"
#include "engine/solve/team.h"
#include "engine/solve/tiles.h"

#include <atomic>
#include <functional>

namespace ringdown::solve {

class Ldlt {
 public:
  // All three must live longer.
  Ldlt(const Elimination& plan, const OrderedSystem& system, Team& team);
  ~Ldlt();
  Ldlt(const Ldlt&) = delete;
  Ldlt& operator=(const Ldlt&) = delete;

  // Returns false when a pivot is zero or not finite. Calls `keep_going` between fronts, and throws Cancelled when it
  // returns false.
  bool factor(double sigma, const std::function<bool()>& keep_going = {});

  // Frees the memory that only factoring needs. Without this call, the memory is kept for the next factor().
  void release_workspace();

  [[nodiscard]] int negative() const { return negative_; }
  [[nodiscard]] double sigma() const { return sigma_; }

  // x := (K - sigma M)^-1 x, in the order of elimination. kWidth vectors at once take about twice as long as one
  // vector.
  void solve(Block& x) const { solve(x.data(), kWidth); }
  void solve(Eigen::VectorXd& x) const { solve(x.data(), 1); }

  // |A x - b| / (|A| |x| + |b|) of one solve. A value far above rounding means that the shift should move.
  [[nodiscard]] double backward_error() const;

 private:
  struct Front;
  struct Slot {  // a place on a stack of updates
    int stack = 0;
    std::size_t offset = 0;
  };

  void open_workspace();
  void factor_supernodes(int begin, int end, Front& front, const Member& member,
                         const std::function<bool()>& keep_going);
  void assemble(const Supernode& node, Front& front, const Member& member) const;
  void take_update(int child, const Supernode& node, Front& front, const Member& member);
  void eliminate(const Supernode& node, Front& front, const Member& member);
  void solve(double* x, int vectors) const;
  double* update_of(int supernode);
  void keep_update(int supernode, const Front& front, const Member& member);

  const Elimination& plan_;
  const OrderedSystem& system_;
  Team& team_;
  double sigma_ = 0;
  int negative_ = 0;
  std::atomic<bool> singular_ = false, cancelled_ = false;
  Numbers tiles_;                 // L, supernode by supernode (tiles.h)
  std::vector<double> diagonal_;  // D
  std::vector<Front> fronts_;     // one per part; the first also serves the crown
  std::vector<Numbers> stacks_;   // updates: Schur complements for the parents, lower triangles packed by columns
  std::vector<std::size_t> stack_sizes_;
  std::vector<Slot> slots_;  // the place of each supernode's update
};

}  // namespace ringdown::solve
