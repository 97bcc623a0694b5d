// Bakes the shape of a comparison again and again, by ringdown-bake, and shows how far all of the work is. [one thread]
#pragma once

#include "clients/cli/long_work.h"
#include "engine/base/result.h"
#include "engine/modal/bank.h"

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace ringdown::cli {

// The share of the work that is done, in quick bakes.
class Work {
 public:
  explicit Work(double all);
  // The next stage begins, which is this share of the work.
  void begin(const std::string& stage, double share);

 private:
  double all_, done_ = 0;
  ProgressLine line_;
};

// A figure of the body that differs from what its files say: a constant of the material, as --set-material takes it,
// the scale of its walls, or a parameter of the geometry.
struct Figure {
  std::string name;
  double value = 0;

  [[nodiscard]] bool is_modulus() const { return name.ends_with("_pa"); }
  [[nodiscard]] std::vector<std::string> as_option() const;  // of ringdown-bake
};

struct BakeRequest {
  std::filesystem::path shape, materials;  // materials: "" for the presets'
  std::string material;                    // "" for the object file's
  double top_hz = 0;
  bool shapes = false;  // whether the bank's shapes matter, not only its frequencies and decays
};

class Baker {
 public:
  static constexpr double kFineShare = 4, kWellShare = 8;  // of the work, in quick bakes

  // The banks are written into `folder`. The work outlives the baker.
  Baker(BakeRequest request, std::filesystem::path folder, std::stop_token stop, Work& work);

  // A search needs frequencies alone: elements of order 2, less the errors that the bank states of them, and no heat.
  Result<modal::Bank> bake_quickly(const std::vector<Figure>& figures);
  // The end of a search: as exact as any bank, without heat.
  Result<modal::Bank> bake_finely(const std::vector<Figure>& figures);
  // Bakes as exactly as `ringdown bake` does, losses to heat included.
  Result<modal::Bank> bake_well(const std::vector<Figure>& figures);

 private:
  Result<modal::Bank> bake(const std::vector<Figure>& figures, const std::vector<std::string>& options);

  BakeRequest request_;
  std::filesystem::path folder_;
  std::stop_token stop_;
  Work& work_;
};

}  // namespace ringdown::cli
