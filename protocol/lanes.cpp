#include "protocol/lanes.h"

#include <tuple>
#include <utility>

namespace ringdown::protocol {
namespace {

template <class Struct, class... Ones>
LaneRequest put_into_lane(Struct&& one, Types<Ones...>) {
  constexpr auto kLane = static_cast<std::size_t>(kLaneOf<Struct>);
  return LaneRequest(std::in_place_type<std::tuple_element_t<kLane, std::tuple<Ones...>>>, std::move(one));
}

}  // namespace

LaneRequest in_its_lane(Request request) {
  return visit([]<class Struct>(Struct&& one) { return put_into_lane(std::move(one), Lanes()); }, std::move(request));
}

template class OneOf<MixerRequests>;
template class OneOf<TimedWorkerRequests>;
template class OneOf<WorkerRequests>;
template class OneOf<FileRequests>;
template class OneOf<Questions>;
template class OneOf<SubscriptionRequests>;
template class OneOf<DaemonRequests>;
template class OneOf<Lanes>;

}  // namespace ringdown::protocol
