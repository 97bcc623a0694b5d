// The limits by which contacts are recovered from keyframed motion (recovery.h). SI units. [any thread]
#pragma once

namespace ringdown::scene {

struct FoleyLimits {
  double gap_m = 0.003;      // bodies that push each other may be this far apart; twice that while a contact lasts
  double jitter_m_s = 0.01;  // smaller changes of velocity from one frame to the next are noise
  double strike_m_s = 0.05;  // a pair that meets more slowly does not strike, but begins to touch
  double frames_per_s = 0;   // 0: as often as the file has keys
  double jump_m_s = 60;      // a body that seems to be faster has been put elsewhere, and strikes nothing meanwhile
};

}  // namespace ringdown::scene
