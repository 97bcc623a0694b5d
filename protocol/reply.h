// Everything the daemon answers, one struct each, in scsynth's manner. schema.h turns them into messages and back.
//
// On the wire replies use the OSC types i, f and s only: Pure Data's parser knows no others. [any thread]
#pragma once

#include "engine/base/vec3.h"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace ringdown::protocol {

struct Done {  // /done
  std::string address;
  std::optional<std::int32_t> number;
};
struct Fail {  // /fail
  std::string address;
  std::string sentence;
};
struct StatusReply {  // /status.reply
  std::int32_t objects = 0;
  std::int32_t sounding_objects = 0;
  std::int32_t sounding_modes = 0;
  std::int32_t bodies = 0;
  double sample_rate_hz = 0;
  std::int32_t block_frames = 0;
  double load_mean = 0;
  double load_peak = 0;
  std::int32_t xruns = 0;
  std::int32_t dropped_events = 0;
  std::int32_t late_events = 0;
  std::int32_t merged_events = 0;
  double load_p99 = 0;
  std::int32_t misses = 0;
  std::int32_t own_xruns = 0;
  std::int32_t hidden_modes = 0;
  std::int32_t shed = 0;
  double slowed_s = 0;
};
struct VersionReply {  // /version.reply
  std::string program;
  std::string version;
  std::int32_t protocol = 0;
};
struct Synced {  // /synced
  std::int32_t id = 0;
};

// To subscribers, in bundles.
struct NotifyObject {  // /notify.object
  std::int32_t number = 0;
  std::string name;
  bool loaded = true;
};
struct NotifyGroup {  // /notify.group
  std::int32_t number = 0;
  std::string name;
  std::optional<std::string> group;
};
struct NotifyContact {  // /notify.contact
  std::string object;
  Vec3 point_m, impulse_ns;  // object frame
  double contact_time_s = 0;
};
struct NotifyPeak {  // /notify.peak
  double peak = 0;
};
struct NotifyObjectPeak {  // /notify.object_peak
  std::string object;
  double peak = 0;
};
struct NotifyLoad {  // /notify.load
  double mean = 0, peak = 0;
  std::int32_t xruns = 0, sounding_objects = 0, sounding_modes = 0;
};
struct NotifyBody {  // /notify.body
  std::int32_t id = 0;
  std::string name, object;  // "-": silent
  Vec3 position_m;
  double x = 0, y = 0, z = 0, w = 1;  // unit quaternion: object frame -> scene frame
};

using Reply = std::variant<Done, Fail, StatusReply, VersionReply, Synced, NotifyObject, NotifyGroup, NotifyContact,
                           NotifyPeak, NotifyObjectPeak, NotifyLoad, NotifyBody>;

}  // namespace ringdown::protocol
