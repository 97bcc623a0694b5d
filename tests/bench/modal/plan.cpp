#include "tests/bench/modal/plan.h"

#include "tests/bench/modal/bodies.h"

#include <algorithm>
#include <array>
#include <utility>

namespace ringdown::bench {
namespace {

constexpr std::array kPeers = {"spectra-cholmod", "slepc-cholmod", "slepc-mumps", "slepc-petsc", "ccx"};

// A mesh, and the frequency up to which its modes are asked for. Peers get the number of modes that our solver found
// (modal_bench.cpp).
struct MeshCase {
  const char* body;
  const char* mesh;
  double top_hz;
};

// Near 60,000 unknowns and 200 modes, and near 3,000 unknowns and 40 modes.
constexpr std::array kPeerCases = {MeshCase{"block", "16x14x10", 91200}, MeshCase{"bell", "11.2", 17960},
                                   MeshCase{"plate", "40x40x1", 40162}, MeshCase{"sphere", "11.5", 48100}};
constexpr std::array kQuickPeerCases = {MeshCase{"block", "5x4x3", 47000}, MeshCase{"bell", "60", 6500},
                                        MeshCase{"plate", "12x12x1", 9000}, MeshCase{"sphere", "35", 25300}};

struct Series {
  const char* body;
  double top_hz;
  std::array<const char*, 4> element_meshes[4];  // by order, coarse to fine; nullptr ends
};

// The first 50 modes, and somewhat more: on coarse meshes they lie higher than they should. Meshes are the coarser the
// higher the order, so that all orders cover about the same times.
const std::array kSeries = {Series{"block",
                                   55800,
                                   {{"8x7x5", "14x11x8", "20x16x12", "28x22x17"},
                                    {"4x3x3", "6x5x4", "10x8x6", "14x11x8"},
                                    {"3x2x2", "4x3x3", "6x5x4", "8x7x5"},
                                    {"2x2x1", "3x2x2", "4x3x3", "5x4x3"}}},
                            Series{"plate",
                                   12000,
                                   {{"24x24x1", "40x40x1", "70x70x1", "100x100x1"},
                                    {"10x10x1", "16x16x1", "28x28x1", "40x40x1"},
                                    {"6x6x1", "10x10x1", "16x16x1", "24x24x1"},
                                    {"4x4x1", "6x6x1", "10x10x1", "14x14x1"}}},
                            Series{"sphere",
                                   28600,
                                   {{"30", "20", "14", "9"},
                                    {"34", "28", "20", "15"},
                                    {"34", "30", "22", nullptr},  // coarser ones there are none: gmsh_reader.h's limit
                                    {"34", "30", nullptr, nullptr}}},
                            Series{"bell",
                                   7300,
                                   {{"14", "10", "7", nullptr},
                                    {"40", "25", "16", "11"},
                                    {"60", "40", "25", "18"},
                                    {"60", "40", nullptr, nullptr}}}};

constexpr std::array kElements = {"tet4", "tet10", "tet20", "tet35"};

void add(std::vector<Spec>& plan, const std::string& part, Spec spec) {
  spec.part = part;
  plan.push_back(std::move(spec));
}

Spec spec_of(const MeshCase& mesh_case) {
  return {
      .body = mesh_case.body, .mesh = mesh_case.mesh, .element = "tet10", .method = "ours", .top_hz = mesh_case.top_hz};
}

void add_defaults(std::vector<Spec>& plan, bool quick) {
  for (const char* name : {"block", "soft-block", "sphere", "plate", "bar"}) {
    if (quick && std::string(name) != "block") continue;
    const double top_hz = 1.1 * find_body(name)->exact_hz.back();
    add(plan, "default", {.body = name, .mesh = "default", .element = "default", .method = "bake", .top_hz = top_hz});
  }
}

void add_peers(std::vector<Spec>& plan, bool quick) {
  const Spec small = spec_of({"block", "6x5x4", 47000});
  for (const char* method : {"ours", "ccx-mass", "ccx"}) add(plan, "agreement", small.by(method));
  for (const MeshCase& mesh_case : quick ? kQuickPeerCases : kPeerCases) {
    const Spec ours = spec_of(mesh_case);
    add(plan, "peers", ours);
    add(plan, "threads", ours.by("ours", 2));
    for (const char* peer : kPeers) add(plan, "peers", ours.by(peer));
  }
}

void add_sizes(std::vector<Spec>& plan, bool quick) {
  const Spec many = spec_of(quick ? MeshCase{"block", "3x2x2", 100000} : MeshCase{"block", "9x6x5", 196300});
  add(plan, "many", many);
  add(plan, "many", many.by("spectra-cholmod"));
  add(plan, "memory", spec_of(quick ? MeshCase{"block", "6x5x4", 60000} : MeshCase{"block", "25x21x15", 91000}));
}

// Small bodies with few modes: what solve_modes() chooses, and the two methods that it chooses between.
void add_choices(std::vector<Spec>& plan, bool quick) {
  const std::vector<double> exact_hz = find_body("block")->exact_hz;
  for (const char* mesh : {"2x2x1", "3x2x2", "4x3x2", "5x4x4", "7x6x5", "9x8x6"}) {
    for (const std::size_t elastic : {std::size_t{4}, std::size_t{14}, std::size_t{34}, exact_hz.size() - 1}) {
      if (quick && elastic > 4) continue;
      const double top_hz = 0.5 * (exact_hz[elastic - 1] + exact_hz[elastic]);
      const Spec ours{.body = "block", .mesh = mesh, .element = "tet20", .method = "ours", .top_hz = top_hz};
      for (const char* method : {"ours", "spectra", "block"}) add(plan, "choice", ours.by(method));
    }
  }
}

void add_series(std::vector<Spec>& plan, bool quick) {
  for (const Series& series : kSeries) {
    if (std::string(series.body) == "bell") add(plan, "series", bell_reference(quick));
    for (std::size_t order = 0; order < kElements.size(); ++order) {
      for (std::size_t m = 0; m < (quick ? 2 : 4); ++m) {
        const char* mesh = series.element_meshes[order][m];
        if (mesh == nullptr || (quick && (order == 0 || order == 3))) break;  // not the least and the most costly
        const Spec ours{
            .body = series.body, .mesh = mesh, .element = kElements[order], .method = "ours", .top_hz = series.top_hz};
        add(plan, "series", ours);
        if (order == 1) add(plan, "series", ours.by("spectra-cholmod"));
      }
    }
  }
}

// 200 modes on ever finer meshes, and ever more modes on the third of them.
void add_growth(std::vector<Spec>& plan, bool quick) {
  const auto with = [](const char* mesh, double top_hz) {
    return Spec{.body = "block", .mesh = mesh, .element = "tet20", .method = "ours", .top_hz = top_hz};
  };
  std::vector<const char*> meshes = {"4x3x3", "6x5x4", "9x8x6", "14x12x9", "21x18x13"};
  std::vector<double> tops_hz = {44000, 56000, 71000, 91200, 116000, 147000};
  if (quick) {
    meshes.resize(3);
    tops_hz.resize(3);
  }
  for (const char* mesh : meshes) add(plan, "growth", with(mesh, quick ? 44000 : 91200));
  for (const double top_hz : tops_hz) add(plan, "growth", with(meshes[2], top_hz));
}

}  // namespace

std::vector<Spec> plan(bool quick) {
  std::vector<Spec> all;
  add_defaults(all, quick);
  add_peers(all, quick);
  add_sizes(all, quick);
  add_choices(all, quick);
  add_series(all, quick);
  add_growth(all, quick);
  return all;
}

Spec bell_reference(bool quick) {
  return {.body = "bell", .mesh = quick ? "60" : "20", .element = "tet35", .method = "ours", .top_hz = 7300};
}

const Measurement* fastest_slepc(const Measurements& all, const Spec& spec) {
  const Measurement* fastest = nullptr;
  for (const char* peer : kPeers) {
    const Measurement* m = std::string(peer).starts_with("slepc") ? find(all, spec.by(peer)) : nullptr;
    if (m == nullptr || m->status == Status::kFailed || m->status == Status::kNotInstalled) continue;
    if (fastest == nullptr || m->seconds < fastest->seconds) fastest = m;
  }
  return fastest;
}

}  // namespace ringdown::bench
