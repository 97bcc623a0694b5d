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

}  // namespace ringdown::protocol

template class ringdown::detail::OneOfStorage<ringdown::protocol::MixerRequests>;
template class ringdown::detail::OneOfStorage<ringdown::protocol::TimedWorkerRequests>;
template class ringdown::detail::OneOfStorage<ringdown::protocol::WorkerRequests>;
template class ringdown::detail::OneOfStorage<ringdown::protocol::FileRequests>;
template class ringdown::detail::OneOfStorage<ringdown::protocol::Questions>;
template class ringdown::detail::OneOfStorage<ringdown::protocol::SubscriptionRequests>;
template class ringdown::detail::OneOfStorage<ringdown::protocol::DaemonRequests>;
template class ringdown::detail::OneOfStorage<ringdown::protocol::Lanes>;
