// Everything the daemon answers, one struct each, in scsynth's manner. schema.h turns them into messages and back.
//
// On the wire replies use the OSC types i, f and s only: Pure Data's parser knows no others. [any thread]
#pragma once

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
};
struct VersionReply {  // /version.reply
  std::string program;
  std::string version;
  std::int32_t protocol = 0;
};
struct Synced {  // /synced
  std::int32_t id = 0;
};

using Reply = std::variant<Done, Fail, StatusReply, VersionReply, Synced>;

}  // namespace ringdown::protocol
