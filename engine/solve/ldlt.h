// K - sigma M = L D L^T by a multifrontal method, without pivoting: its signs count eigenvalues. [worker]
//
//   Ldlt factors(plan, system, team);
//   factors.factor(sigma);
//   factors.negative();          // eigenvalues of K phi = lambda M phi below sigma (Sylvester)
//   factors.solve(block);        // x = (K - sigma M)^-1 x
//
// Nothing is exchanged for stability. That is safe for K - sigma M with a sigma that is not very close to an eigenvalue
// of a leading part of the system, and the shift can be moved when it is: backward_error() tells. The parts of the plan
// are worked on at the same time, a thread each, and the supernodes of the crown after them by all threads together.
// Source: Duff & Reid, ACM Trans. Math. Softw. 9, 1983; Parlett, The Symmetric Eigenvalue Problem, section 3.3 on
// inertia.
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

  // False when a pivot is zero or not finite. `keep_going` is asked between fronts; when it says no, Cancelled is
  // thrown.
  bool factor(double sigma, const std::function<bool()>& keep_going = {});

  // Gives back the memory that only factoring needs; kept otherwise for the next time.
  void release_workspace();

  [[nodiscard]] int negative() const { return negative_; }
  [[nodiscard]] double sigma() const { return sigma_; }

  // x := (K - sigma M)^-1 x, in the order of elimination. kWidth vectors at once take about twice as long as one.
  void solve(Block& x) const { solve(x.data(), kWidth); }
  void solve(Eigen::VectorXd& x) const { solve(x.data(), 1); }

  // |A x - b| / (|A| |x| + |b|) of one solve: far above rounding when the shift should move.
  [[nodiscard]] double backward_error() const;

 private:
  struct Front;
  struct Place {
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
  std::vector<Front> fronts_;     // of the parts; the crown's is the first
  std::vector<Numbers> stacks_;   // updates: what supernodes leave for their parents, lower triangles packed by columns
  std::vector<std::size_t> stack_sizes_;
  std::vector<Place> places_;  // of each supernode's update
};

}  // namespace ringdown::solve
