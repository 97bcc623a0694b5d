// The parts of the block Lanczos method, each against plain sparse or dense algebra.
#include "engine/solve/ldlt.h"

#include "engine/dense/decompositions.h"
#include "engine/solve/basis.h"
#include "tests/fem/sample_meshes.h"
#include "tests/support/scarcity.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>
#include <stdexcept>
#include <system_error>

namespace ringdown::ldlt_test {
namespace {

using solve::Block;
using solve::kWidth;

constexpr fem::Elastic kSteel{200e9, 0.3, 7850};
const Eigen::Vector3d kSize(0.1, 0.08, 0.06);

fem::System box_system(test::Cells cells) {
  return fem::assemble(mesh::to_order(test::box_mesh(cells, kSize), 2), kSteel, fem::Element::kTet10).value();
}

fem::SparseMatrix full(const fem::SparseMatrix& lower) { return lower.selfadjointView<Eigen::Lower>(); }

fem::SparseMatrix mass_matrix(const fem::System& system) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int n = 0; n < system.node_mass.outerSize(); ++n) {
    for (fem::SparseMatrix::InnerIterator m(system.node_mass, n); m; ++m) {
      for (int i = 0; i < 3; ++i) entries.emplace_back(3 * m.row() + i, 3 * n + i, m.value());
    }
  }
  fem::SparseMatrix mass(system.unknowns(), system.unknowns());
  mass.setFromTriplets(entries.begin(), entries.end());
  return mass;
}

// A block in the order of elimination from vectors in the mesh's, and back.
Block ordered(const Eigen::MatrixXd& vectors, const solve::Elimination& plan) {
  Block block(kWidth, vectors.rows());
  for (int n = 0; n < plan.node_count(); ++n) {
    block.middleCols<3>(3 * n) = vectors.middleRows<3>(3 * plan.old_of[n]).transpose();
  }
  return block;
}
Eigen::MatrixXd in_mesh_order(const Block& block, const solve::Elimination& plan) {
  Eigen::MatrixXd vectors(block.cols(), kWidth);
  for (int n = 0; n < plan.node_count(); ++n) {
    vectors.middleRows<3>(3 * plan.old_of[n]) = block.middleCols<3>(3 * n).transpose();
  }
  return vectors;
}

class Threads : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(All, Threads, testing::Values(1, 2, 3));

TEST_P(Threads, BlockProductsAreThoseOfTheSparseMatrices) {
  const fem::System system = box_system({4, 3, 3});
  const solve::Elimination plan = solve::plan_elimination(system, GetParam());
  solve::Team team(GetParam());
  const solve::OrderedSystem ordered_system(system, plan, team);
  const Eigen::MatrixXd x = Eigen::MatrixXd::Random(system.unknowns(), kWidth);
  Block y;
  ordered_system.times_stiffness(ordered(x, plan), y);
  const Eigen::MatrixXd stiff = full(system.stiffness) * x;
  EXPECT_LT((in_mesh_order(y, plan) - stiff).norm(), 1e-14 * stiff.norm());
  ordered_system.times_mass(ordered(x, plan), y);
  const Eigen::MatrixXd heavy = mass_matrix(system) * x;
  EXPECT_LT((in_mesh_order(y, plan) - heavy).norm(), 1e-14 * heavy.norm());
}

TEST_P(Threads, FactorsSolveIndefiniteSystems) {
  const fem::System system = box_system({5, 4, 3});
  const solve::Elimination plan = solve::plan_elimination(system, GetParam());
  solve::Team team(GetParam());
  const solve::OrderedSystem ordered_system(system, plan, team);
  solve::Ldlt factors(plan, ordered_system, team);
  const double sigma = std::pow(2 * M_PI * 40e3, 2);
  ASSERT_TRUE(factors.factor(sigma));
  EXPECT_GT(factors.negative(), 6);
  EXPECT_LT(factors.backward_error(), 1e-12);
  const Eigen::MatrixXd right = Eigen::MatrixXd::Random(system.unknowns(), kWidth);
  Block block = ordered(right, plan);
  factors.solve(block);
  const Eigen::MatrixXd shifted = full(system.stiffness) - sigma * mass_matrix(system);
  const Eigen::MatrixXd expected = dense::inverse(shifted) * right;
  EXPECT_LT((in_mesh_order(block, plan) - expected).norm(), 1e-9 * expected.norm());
}

// Another body than a box of equal supernodes: widths of strips and numbers of rows that are no multiples of a tile's.
TEST_P(Threads, OneVectorIsSolvedForLikeOneOfEight) {
  for (const test::Cells cells : {test::Cells{1, 1, 1}, test::Cells{3, 2, 2}, test::Cells{7, 6, 5}}) {
    const fem::System system = box_system(cells);
    const solve::Elimination plan = solve::plan_elimination(system, GetParam());
    solve::Team team(GetParam());
    const solve::OrderedSystem ordered_system(system, plan, team);
    solve::Ldlt factors(plan, ordered_system, team);
    ASSERT_TRUE(factors.factor(std::pow(2 * M_PI * 40e3, 2)));
    Block block = Block::Random(kWidth, system.unknowns());
    Eigen::VectorXd one = block.row(3).transpose();
    factors.solve(block);
    factors.solve(one);
    EXPECT_LT((block.row(3).transpose() - one).norm(), 1e-10 * one.norm()) << system.unknowns();
  }
}

TEST_P(Threads, NegativePivotsCountEigenvalues) {
  const fem::System system = box_system({2, 2, 1});
  const Eigen::MatrixXd mass = mass_matrix(system), stiffness = full(system.stiffness);
  const Eigen::VectorXd exact = dense::generalized_spectrum(stiffness, mass)->values;
  const solve::Elimination plan = solve::plan_elimination(system, GetParam());
  solve::Team team(GetParam());
  const solve::OrderedSystem ordered_system(system, plan, team);
  solve::Ldlt factors(plan, ordered_system, team);
  for (int i = 6; i + 1 < exact.size(); i += 7) {
    for (const double share : {1e-6, 0.5, 1 - 1e-6}) {  // close above one eigenvalue, between, close below the next
      if (exact[i + 1] - exact[i] < 1e-6 * exact[i]) continue;
      ASSERT_TRUE(factors.factor(exact[i] + share * (exact[i + 1] - exact[i])));
      EXPECT_EQ(factors.negative(), i + 1) << "share " << share;
    }
  }
}

TEST_P(Threads, NoEntryOfTheFactorConnectsTwoParts) {
  const fem::System system = box_system({6, 5, 4});
  const solve::Elimination plan = solve::plan_elimination(system, GetParam());
  ASSERT_EQ(plan.parts(), GetParam());
  std::vector<int> seen(plan.node_count(), 0);
  for (const int old : plan.old_of) ++seen[old];
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), plan.node_count()) << "not a permutation";
  const int crown = plan.first_column(plan.crown_begin());
  for (int part = 0; part < plan.parts(); ++part) {
    const int end = plan.first_column(plan.part_end[part]);
    EXPECT_GT(plan.part_end[part], plan.part_begin(part));
    for (int s = plan.part_begin(part); s < plan.part_end[part]; ++s) {
      for (const int row : plan.nodes[s].rows) EXPECT_TRUE(row < end || row >= crown);
    }
  }
  for (const solve::Supernode& node : plan.nodes) {
    for (const int row : node.rows) EXPECT_GE(row, node.first + node.columns);
  }
}

TEST(Elimination, SystemsWithLumpedMassesAreEliminatedToo) {
  const auto box = test::box_mesh({3, 3, 2}, kSize);
  const fem::System system = fem::assemble(box, kSteel, fem::Element::kTet4Lumped).value();
  const solve::Elimination plan = solve::plan_elimination(system, 1);
  solve::Team team(1);
  const solve::OrderedSystem ordered_system(system, plan, team);
  solve::Ldlt factors(plan, ordered_system, team);
  ASSERT_TRUE(factors.factor(std::pow(2 * M_PI * 5e3, 2)));
  EXPECT_EQ(factors.negative(), 6);
}

TEST(Ldlt, FactoringAsksWhetherToGoOn) {
  const fem::System system = box_system({3, 3, 3});
  const solve::Elimination plan = solve::plan_elimination(system, 2);
  solve::Team team(2);
  const solve::OrderedSystem ordered_system(system, plan, team);
  solve::Ldlt factors(plan, ordered_system, team);
  int asked = 0;
  EXPECT_ANY_THROW(factors.factor(1e9, [&asked] { return ++asked < 3; }));
  EXPECT_EQ(asked, 3);
}

TEST(Basis, BasisProductsAreThoseOfMatrices) {
  solve::Team team(2);
  solve::Basis basis(team);
  const int unknowns = 1001;
  Eigen::MatrixXd vectors(unknowns, 0);
  for (int b = 0; b < 3; ++b) {
    const Block block = Block::Random(kWidth, unknowns);
    basis.append(block);
    vectors.conservativeResize(unknowns, vectors.cols() + kWidth);
    vectors.rightCols(kWidth) = block.transpose();
  }
  Block x = Block::Random(kWidth, unknowns);
  const Eigen::MatrixXd products = vectors.transpose() * x.transpose();
  EXPECT_LT((basis.inner_products(x) - products).norm(), 1e-13 * products.norm());
  const Eigen::MatrixXd factors = Eigen::MatrixXd::Random(3 * kWidth, kWidth);
  const Eigen::MatrixXd left = x.transpose() - vectors * factors;
  basis.subtract_combination(factors, x);
  EXPECT_LT((x.transpose() - left).norm(), 1e-13 * left.norm());
  const Eigen::MatrixXd wide = Eigen::MatrixXd::Random(3 * kWidth, 5);
  EXPECT_LT((basis.combine(wide) - vectors * wide).norm(), 1e-12 * vectors.norm());
}

TEST(Team, ATeamDoesEveryPartOnceAndPassesOnWhatIsThrown) {
  solve::Team team(4);
  for (int round = 0; round < 200; ++round) {
    std::vector<int> done(4, 0);
    team.run([&](int part) { ++done[part]; });
    EXPECT_EQ(done, std::vector<int>(4, 1));
  }
  EXPECT_THROW(team.run([](int part) {
    if (part == 2) throw std::runtime_error("part 2");
  }),
               std::runtime_error);
  int after = 0;
  team.run([&](int part) { after += part == 0; });
  EXPECT_EQ(after, 1);
}

TEST(Team, ATeamMeetsAndDoesNotWaitForAMemberThatThrew) {
  solve::Team team(3);
  std::vector<int> seen(3, 0);
  std::atomic<int> before = 0;
  team.run_together([&](int number, const solve::Member& member) {
    for (int round = 1; round <= 100; ++round) {
      ++before;
      member.meet();
      if (before == 3 * round) ++seen[number];
      member.meet();
    }
  });
  EXPECT_EQ(seen, std::vector<int>(3, 100));
  const auto one_throws = [](int number, const solve::Member& member) {
    if (number == 1) throw std::runtime_error("number 1");
    member.meet();
  };
  EXPECT_THROW(team.run_together(one_throws), std::runtime_error);
}

TEST(Team, SharesOfTeamMembersCoverEverythingOnce) {
  std::barrier<> meeting(3);
  for (const int items : {0, 1, 2, 7, 100}) {
    int next = 0;
    for (int number = 0; number < 3; ++number) {
      const solve::Member member(number, 3, meeting);
      EXPECT_EQ(member.begin(items), next);
      next = member.end(items);
    }
    EXPECT_EQ(next, items);
  }
}

TEST(Tiles, EveryColumnLiesInOneStripWithAllBelowIt) {
  for (const int pivots : {3, 117, 120, 123, 480, 501}) {
    const int below = 33;
    int next = 0;
    std::size_t offset = 0;
    for (const solve::Strip& strip : solve::strips_of(pivots, below)) {
      EXPECT_EQ(strip.first, next);
      EXPECT_EQ(strip.offset, offset);
      EXPECT_EQ(strip.first + strip.width + strip.below, pivots + below);
      next += strip.width, offset += strip.size();
    }
    EXPECT_EQ(next, pivots);
    EXPECT_EQ(offset, solve::tiled_size(pivots, below));
  }
}

// One helper is there already when the next cannot be started, and must not be waited for.
TEST(Team, ATeamThatGetsTooFewThreadsEndsThoseItHas) {
#ifdef RINGDOWN_SANITIZE
  GTEST_SKIP() << "sanitizers map more memory than a limit allows";
#endif
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto try_it = [] {
    test::run_out_of_threads(12);
    ::alarm(60);
    try {
      const solve::Team team(8);
    } catch (const std::system_error&) {
      std::_Exit(0);
    }
    std::_Exit(1);
  };
  EXPECT_EXIT(try_it(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace ringdown::ldlt_test
