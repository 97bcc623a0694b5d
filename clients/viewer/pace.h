// How finely the scene is drawn where drawing is slow: software rendering of every pixel may take longer than people
// wait for what they do. [UI]
#pragma once

namespace ringdown::viewer {

class Pace {
 public:
  static constexpr double kSlow_s = 0.045, kQuick_s = 0.018;  // frames that are worth a change
  static constexpr double kCoarsest = 0.35;
  static constexpr int kFrames = 8;  // between two changes

  // After a frame that took so long.
  void observe(double frame_s);

  // The share of the picture's width and height to draw: 1 ... kCoarsest.
  [[nodiscard]] double detail() const { return detail_; }

 private:
  double detail_ = 1, sum_s_ = 0;
  int frames_ = 0;
};

}  // namespace ringdown::viewer
