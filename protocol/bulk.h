// Many strikes or poses in one OSC blob: /strikes and /poses, for simulators with thousands of contacts a second. [any
// thread but audio]
//
// A record is kBytesPerStrike bytes, its numbers big-endian as everything in OSC: int32 object, int32 vertex (-1: the
// point counts), float32 x y z, jx jy jz, contact_time, delay.
#pragma once

#include "engine/base/result.h"
#include "engine/base/rotation.h"
#include "engine/base/vec3.h"
#include "protocol/wire/message.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::protocol {

inline constexpr std::size_t kBytesPerStrike = 40;
inline constexpr std::size_t kMaxBulkStrikes = 1600;  // 64,000 bytes: what a datagram carries
inline constexpr double kMaxDelay_s = 60;

struct BulkStrike {
  std::uint32_t object = 0;             // its number
  std::optional<std::uint32_t> vertex;  // or the point
  Vec3 point_m, impulse_ns;
  double contact_time_s = 0;
  double delay_s = 0;  // after the message's time
};

// Many poses: a record is int32 object, float32 x y z, qw qx qy qz, delay.
inline constexpr std::size_t kBytesPerPose = 36;
inline constexpr std::size_t kMaxBulkPoses = 1700;

struct BulkPose {
  std::uint32_t object = 0;  // its number
  Pose pose;
  double delay_s = 0;  // after the message's time
};
Result<std::vector<BulkPose>> decode_poses(const wire::Blob& records);
wire::Blob encode_poses(std::span<const BulkPose> poses);

// Every number is checked against the ranges of /object/{object}/strike and strike_vertex. An error names the record,
// from 1, and the argument.
Result<std::vector<BulkStrike>> decode_strikes(const wire::Blob& records);

wire::Blob encode_strikes(std::span<const BulkStrike> strikes);

}  // namespace ringdown::protocol
