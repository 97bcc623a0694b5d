// Lanes: who handles a request, when, and on which thread. Each request has exactly one.
//
//   std::visit(Overloaded{[&](const MixerRequest& request) { session.play(request, frame); },
//                         [&](const WorkerRequest& request) { ... }, ...},
//              in_its_lane(std::move(request)));
//
// A lane is a variant of its own, and whoever serves it visits that with one overload for each request, without a
// generic one: where a request or a whole lane was forgotten, the compiler says which. [any thread]
#pragma once

#include "protocol/request.h"

#include <cstdint>
#include <type_traits>
#include <utility>
#include <variant>

namespace ringdown::protocol {

// Becomes events, which the mixer plays at the request's own frame.
using MixerRequest =
    std::variant<Strike, StrikeVertex, StrikeMany, SetGain, SetPan, RingModes, ClearObject, SetContact, SetBow,
                 HitMallet, SetCoupling, Click, SetPose, PoseMany, SetListener, ListenerOff, SetListenerAir, ClearAll>;

// Carried out by the worker before the request's own frame, and heard from that frame on.
using TimedWorkerRequest = std::variant<SetDamper>;

// Carried out by the worker as soon as everything sent before has been: reads banks and scenes, retunes, frees.
using WorkerRequest = std::variant<SetMaterial, SetGroup, SetMute, SetSolo, SelectModes, Excite, FreeObject, LoadObject,
                                   SceneLoad, ScenePause, SpawnBox, SpawnSphere, SceneClear, ScenePush, TestTone>;

// Writes a file, or begins to: also the worker's, in order.
using FileRequest = std::variant<SaveState, SaveScene, RecordStart, RecordStop, CaptureStart, CaptureStop>;

// Asks and changes nothing: answered by the worker, in order.
using Question = std::variant<DescribeObject, ReadBank, SceneDescribe, Browse, Sync>;

// Changes what its sender is sent from now on: at once, by the thread that received it.
using SubscriptionRequest = std::variant<Notify, WatchObject, WatchSound>;

// About the daemon itself: answered at once, by the thread that received it.
using DaemonRequest = std::variant<Status, Version, Quit>;

using LaneRequest = std::variant<MixerRequest, TimedWorkerRequest, WorkerRequest, FileRequest, Question,
                                 SubscriptionRequest, DaemonRequest>;

// The lanes by name, in the order of LaneRequest's alternatives.
enum class Lane : std::uint8_t { mixer, timed_worker, worker, file, question, subscription, daemon };
static_assert(std::variant_size_v<LaneRequest> == static_cast<std::size_t>(Lane::daemon) + 1);

namespace detail {

template <class Struct, class Variant>
inline constexpr bool kHas = false;
template <class Struct, class... Alternatives>
inline constexpr bool kHas<Struct, std::variant<Alternatives...>> = (std::is_same_v<Struct, Alternatives> || ...);

template <class Struct, class... Lanes>
constexpr Lane lane_of(std::type_identity<std::variant<Lanes...>>) {
  constexpr int kLanes = (0 + ... + static_cast<int>(kHas<Struct, Lanes>));
  static_assert(kLanes > 0, "this request has no lane: put it into one of the variants of protocol/lanes.h");
  static_assert(kLanes < 2, "this request has more than one lane");
  constexpr bool kIs[] = {kHas<Struct, Lanes>...};
  std::size_t lane = 0;
  while (!kIs[lane]) ++lane;
  return static_cast<Lane>(lane);
}

}  // namespace detail

// The lane of a request's struct: kLaneOf<Strike> is Lane::mixer.
template <class Struct>
inline constexpr Lane kLaneOf = detail::lane_of<Struct>(std::type_identity<LaneRequest>());

// The request in its lane. Moves it: copies and allocates nothing.
inline LaneRequest in_its_lane(Request request) {
  return std::visit(
      []<class Struct>(Struct&& one) {
        return LaneRequest(std::in_place_index<static_cast<std::size_t>(kLaneOf<Struct>)>, std::move(one));
      },
      std::move(request));
}

// One visitor of several function objects, usually lambdas.
template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};

}  // namespace ringdown::protocol
