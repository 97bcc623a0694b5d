// A contact as it is heard, for reports: a blow, or the state of a lasting contact. [any thread]
#pragma once

#include "engine/base/vec3.h"
#include "engine/scene/pair_map.h"

namespace ringdown::scene {

struct HeardContact {
  enum Kind { blow, lasting, end };  // end: a lasting contact is over, or rests; only time and pair have a meaning
  Kind kind = blow;
  double time_s = 0;  // scene time
  BodyPair pair;
  Vec3 point_m;          // mean, weighted by force
  Vec3 push;             // on the first body: of a blow its impulse [N s], of a lasting contact its mean force [N]
  double speed_m_s = 0;  // of a blow the approach, of a lasting contact the slip
  double roll_m_s = 0;   // of a lasting contact
};

}  // namespace ringdown::scene
