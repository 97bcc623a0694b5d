// Lanes: who handles a request, when, and on which thread. Each request has exactly one.
//
//   visit(Overloaded{[&](const MixerRequest& request) { session.play(request, frame); },
//                    [&](const WorkerRequest& request) { ... }, ...},
//         in_its_lane(std::move(request)));
//
// A lane is a OneOf of its own, and whoever serves it visits that with one overload for each request, without a
// generic one: where a request or a whole lane was forgotten, the compiler says which. [any thread]
#pragma once

#include "protocol/request.h"

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace ringdown::protocol {

// Becomes events, which the mixer plays at the request's own frame.
using MixerRequests = Joined<VerbRequests, Types<StrikeMany, PoseMany, ClearAll>>;
using MixerRequest = OneOf<MixerRequests>;

// Carried out by the worker before the request's own frame, and heard from that frame on.
using TimedWorkerRequests = Types<Hold, BreakObject, SetFill, SetResonator>;
using TimedWorkerRequest = OneOf<TimedWorkerRequests>;

// Carried out by the worker as soon as everything sent before has been: reads banks and scenes, retunes, frees.
using WorkerRequests = Types<SetMaterial, SetGroup, SetMute, SetSolo, SelectModes, Excite, ArmObject, MendObject,
                             SetStrength, FreeObject, LoadObject, SceneLoad, ScenePause, SpawnBox, SpawnSphere,
                             SceneClear, SceneRemove, SceneRestore, ScenePlace, ScenePush, TestTone>;
using WorkerRequest = OneOf<WorkerRequests>;

// Writes a file, or begins to: also the worker's, in order.
using FileRequests = Types<SaveState, SaveScene, RecordStart, RecordStop, CaptureStart, CaptureStop>;
using FileRequest = OneOf<FileRequests>;

// Asks and changes nothing: answered by the worker, in order.
using Questions = Types<DescribeObject, DescribePieces, ReadBank, SceneDescribe, Browse, Sync>;
using Question = OneOf<Questions>;

// Changes what its sender is sent from now on: at once, by the thread that received it.
using SubscriptionRequests = Types<Notify, WatchObject, WatchSound>;
using SubscriptionRequest = OneOf<SubscriptionRequests>;

// About the daemon itself: answered at once, by the thread that received it.
using DaemonRequests = Types<Status, Version, Quit>;
using DaemonRequest = OneOf<DaemonRequests>;

using Lanes =
    Types<MixerRequest, TimedWorkerRequest, WorkerRequest, FileRequest, Question, SubscriptionRequest, DaemonRequest>;
using LaneRequest = OneOf<Lanes>;

// The lanes by name, in the order of Lanes.
enum class Lane : std::uint8_t { mixer, timed_worker, worker, file, question, subscription, daemon };
static_assert(Lanes::kCount == static_cast<std::size_t>(Lane::daemon) + 1);

namespace detail {

template <class Struct, class... Ones>
constexpr Lane lane_of(Types<Ones...>) {
  constexpr bool kHas[] = {Ones::List::template kHas<Struct>...};
  constexpr auto kLanes = std::count(std::begin(kHas), std::end(kHas), true);
  static_assert(kLanes > 0, "this request has no lane: put it into one of the lists of protocol/lanes.h");
  static_assert(kLanes < 2, "this request has more than one lane");
  return static_cast<Lane>(std::find(std::begin(kHas), std::end(kHas), true) - std::begin(kHas));
}

}  // namespace detail

// The lane of a request's struct: kLaneOf<Strike> is Lane::mixer.
template <class Struct>
inline constexpr Lane kLaneOf = detail::lane_of<Struct>(Lanes());

// The request in its lane. Moves it: copies and allocates nothing.
LaneRequest in_its_lane(Request request);

}  // namespace ringdown::protocol

extern template class ringdown::detail::OneOfStorage<ringdown::protocol::MixerRequests>;
extern template class ringdown::detail::OneOfStorage<ringdown::protocol::TimedWorkerRequests>;
extern template class ringdown::detail::OneOfStorage<ringdown::protocol::WorkerRequests>;
extern template class ringdown::detail::OneOfStorage<ringdown::protocol::FileRequests>;
extern template class ringdown::detail::OneOfStorage<ringdown::protocol::Questions>;
extern template class ringdown::detail::OneOfStorage<ringdown::protocol::SubscriptionRequests>;
extern template class ringdown::detail::OneOfStorage<ringdown::protocol::DaemonRequests>;
extern template class ringdown::detail::OneOfStorage<ringdown::protocol::Lanes>;
