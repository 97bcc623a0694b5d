// The bows and couplings that this window has laid on objects, and the requests that lay them. The daemon reports none,
// so those of other clients are unknown here. [UI]
#pragma once

#include "engine/base/vec3.h"
#include "protocol/request.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace ringdown::viewer {

// A point of an object's surface, in the frame and the present size of the object.
struct SurfacePoint {
  std::string object;
  Vec3 point_m, normal;  // unit normal, outward
};

// Return the request that throws a mallet against the surface, lays a bow on it, or lets `other` touch the surface.
// The remaining values are those of the verb. The hair moves along `way`, as far as that lies in the surface.
protocol::HitMallet mallet_at(const SurfacePoint& at, double speed_m_s, synth::verb::Mallet mallet);
protocol::SetBow bow_at(const SurfacePoint& at, Vec3 way, synth::verb::Bow bow);
protocol::SetCoupling coupling_of(const SurfacePoint& at, const SurfacePoint& other, synth::verb::Couple coupling);

class Touches {
 public:
  // Numbers of this window's bows and couplings. Bows of MIDI have the numbers of their keys, which are lower.
  static constexpr std::uint32_t kFirstNumber = 200;

  // Follows a request that is sent: SetBow or SetCoupling; others change nothing here.
  void follow(const protocol::Request& request);
  // Returns the request that restores the bow or coupling that `request` changes, or ends it if it is not there yet.
  [[nodiscard]] protocol::Request reverting(const protocol::Request& request) const;
  // Forgets bows and couplings of objects that are gone.
  void keep(const std::function<bool(const std::string& object)>& exists);
  void clear() { *this = {}; }

  [[nodiscard]] const std::vector<protocol::SetBow>& bows() const { return bows_; }
  [[nodiscard]] const std::vector<protocol::SetCoupling>& couplings() const { return couplings_; }
  [[nodiscard]] const protocol::SetBow* bow_of(const std::string& object) const;    // null: none
  [[nodiscard]] const protocol::SetCoupling* coupling(std::uint32_t number) const;  // null: none
  [[nodiscard]] std::uint32_t free_number() const;                                  // for a new coupling

 private:
  std::vector<protocol::SetBow> bows_;  // one for each object
  std::vector<protocol::SetCoupling> couplings_;
};

// Return the requests that lift a bow and separate two objects.
protocol::SetBow lifted(protocol::SetBow bow);
protocol::SetCoupling separated(protocol::SetCoupling coupling);

}  // namespace ringdown::viewer
