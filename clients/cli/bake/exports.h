// The files that ringdown-bake writes beside a bank for laboratories: modes at all nodes, matrices, and the residual.
// [main]
#pragma once

#include "engine/bake/bake_object.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace ringdown::manual {
class App;
}

namespace ringdown::cli {

inline constexpr std::array<const char*, 3> kExportOptions = {"--export-modes", "--export-matrices",
                                                              "--export-residual"};

struct Exports {
  std::vector<std::filesystem::path> modes;
  std::filesystem::path residual;
  std::string matrices;  // a prefix

  [[nodiscard]] bool none() const { return modes.empty() && residual.empty() && matrices.empty(); }
  void add_to(manual::App& app);
  [[nodiscard]] Result<void> check() const;        // endings, before anything is baked
  void ask_for(bake::BakeOptions& options) const;  // what they need of the bake
  [[nodiscard]] Result<void> write(const bake::Baked& baked, const Progress& progress) const;
};

}  // namespace ringdown::cli
