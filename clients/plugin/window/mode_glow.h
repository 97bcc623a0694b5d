// How loud each mode of the shown object is now, for the eye. The plug-in tells its window one level for the whole
// sound. Its division among the modes is computed: a blow gives each mode the share that the strike point and the
// contact time give it, and each mode then falls by its own decay. A level that rises means another blow. [UI]
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace ringdown::plugin {

class ModeGlow {
 public:
  static constexpr double kDark_db = -80;  // re full scale; softer modes are dark

  ModeGlow() = default;
  explicit ModeGlow(std::vector<double> decays_per_s)
      : decays_per_s_(std::move(decays_per_s)), present_(decays_per_s_.size()), struck_(decays_per_s_.size()) {}

  // Sets the shares that the next blow gives to the modes, by amplitude in any unit. One for each mode.
  void set_blow(std::vector<double> amplitudes) { struck_ = std::move(amplitudes); }

  // Follows the level of the whole sound after a time; `loss` is a factor on all decays.
  void follow(double level_db, double elapsed_s, double loss);

  // Returns 0 for a dark mode, 1 for one at full scale.
  [[nodiscard]] float brightness(std::size_t mode) const;
  [[nodiscard]] std::size_t modes() const { return present_.size(); }
  // Returns the mode that was loudest at the last blow.
  [[nodiscard]] std::size_t leading() const { return leading_; }

 private:
  std::vector<double> decays_per_s_, present_, struck_;  // amplitudes: full scale is 1
  double level_db_ = -1000;
  std::size_t leading_ = 0;
};

}  // namespace ringdown::plugin
