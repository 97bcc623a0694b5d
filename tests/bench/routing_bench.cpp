// What it costs to find out what a message means, by how many objects there are: from the bytes of a datagram to the
// object. Ours against a liblo server that has a method for each object, in turns, in processor time.
//
//   ringdown_routing_bench [--gate] [--quick] [-o FILE]
#include "engine/base/folders.h"
#include "engine/modal/bank_file.h"
#include "protocol/pattern.h"
#include "protocol/lanes.h"
#include "protocol/schema.h"
#include "protocol/wire/codec.h"
#include "server/session/session.h"
#include "tests/bench/promise.h"
#include "tests/support/synthetic_bank.h"

#include <CLI/CLI.hpp>
#include <lo/lo.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <random>
#include <utility>
#include <time.h>

namespace {

using namespace ringdown;
using Bytes = std::vector<std::byte>;

std::string name_of(std::size_t object) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "object-%04zu", object);
  return text.data();
}

// As the daemon does it, up to the events that the mixer would get.
class Ours {
 public:
  explicit Ours(std::size_t objects) {
    const PrivateFolder folder("ringdown-routing");
    const auto bank = folder.path() / "a.glb";
    static_cast<void>(modal::write_bank(test::single_mode_bank(440, 2), bank));
    for (std::size_t i = 0; i < objects; ++i) static_cast<void>(session_.rack().load(name_of(i), bank));
  }

  void take(const Bytes& packet) {
    const auto messages = wire::decode_packet(packet);
    for (const wire::TimedMessage& timed : *messages) {
      if (!protocol::is_pattern(timed.message.address)) {
        handle(timed.message);
        continue;
      }
      const auto addresses = protocol::expand(timed.message.address, *session_.rack().names());
      for (const std::string& address : *addresses) handle({address, timed.message.arguments});
    }
  }

  std::size_t taken = 0;

 private:
  void handle(const wire::Message& message) {
    auto request = protocol::parse(message);
    if (!request) return;
    const protocol::LaneRequest lane = protocol::in_its_lane(std::move(*request));
    const auto* const played = lane.get_if<protocol::MixerRequest>();
    taken += played && session_.check(*played, 0);
  }

  session::Session session_{48000};
};

class Liblo {
 public:
  explicit Liblo(std::size_t objects) : server_(lo_server_new(nullptr, nullptr), lo_server_free) {
    const auto count = [](const char*, const char*, lo_arg**, int, lo_message, void* sum) {
      ++*static_cast<std::size_t*>(sum);
      return 0;
    };
    for (std::size_t i = 0; i < objects; ++i) {
      lo_server_add_method(server_.get(), ("/object/" + name_of(i) + "/gain").c_str(), "f", count, &taken);
    }
  }

  void take(const Bytes& packet) {
    Bytes copy = packet;  // it is turned round in place
    lo_server_dispatch_data(server_.get(), copy.data(), copy.size());
  }

  std::size_t taken = 0;

 private:
  std::unique_ptr<std::remove_pointer_t<lo_server>, void (*)(lo_server)> server_;
};

double processor_ns() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e9 * static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec);
}

// Nanoseconds for each packet; every one must have been taken once.
template <class Who>
double time_ns(Who& who, const std::vector<Bytes>& packets) {
  const std::size_t before = who.taken;
  const double begin_ns = processor_ns();
  for (const Bytes& packet : packets) who.take(packet);
  const double spent_ns = processor_ns() - begin_ns;
  if (who.taken != before + packets.size()) std::fprintf(stderr, "not every message was taken\n"), std::exit(1);
  return spent_ns / static_cast<double>(packets.size());
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

// To objects in no order.
std::vector<Bytes> packets_to(std::size_t objects, std::size_t count, const char* object) {
  std::minstd_rand random(1);
  std::vector<Bytes> packets;
  for (std::size_t i = 0; i < count; ++i) {
    std::array<char, 64> address{};
    std::snprintf(address.data(), address.size(), object, static_cast<unsigned>(random() % objects));
    packets.push_back(wire::encode({address.data(), {0.5f}}));
  }
  return packets;
}

struct Costs {
  double ours_ns, liblo_ns;
};

Costs measure(std::size_t objects, const char* object, std::size_t repeats) {
  Ours ours(objects);
  Liblo liblo(objects);
  const auto packets = packets_to(objects, 1000, object);
  std::vector<double> ours_ns, liblo_ns;
  for (std::size_t r = 0; r < repeats; ++r) {
    ours_ns.push_back(time_ns(ours, packets));
    liblo_ns.push_back(time_ns(liblo, packets));
  }
  return {median(ours_ns), median(liblo_ns)};
}

}  // namespace

int main(int count, char** words) {
  bool gate = false, quick = false;
  std::string path;
  CLI::App app("Routing of messages by the number of objects", "ringdown_routing_bench");
  app.add_flag("--gate", gate, "Exit code 1 when a promise is missed");
  app.add_flag("--quick", quick, "Fewer repeats");
  app.add_option("-o", path, "CSV file");
  CLI11_PARSE(app, count, words);
  std::FILE* const csv = path.empty() ? nullptr : std::fopen(path.c_str(), "w");
  const auto line = [csv](const char* form, auto... values) {
    std::printf(form, values...);
    if (csv) std::fprintf(csv, form, values...);
  };
  line("%s\n", "address,objects,ours_ns,liblo_ns");
  std::array<std::vector<Costs>, 2> found;
  const std::array<std::pair<const char*, const char*>, 2> kinds = {
      {{"exact", "/object/object-%04u/gain"}, {"pattern", "/object/obj*-%04u/g[a]in"}}};
  for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
    for (const std::size_t objects : {1, 10, 100, 1000}) {
      const Costs costs = measure(objects, kinds[kind].second, quick ? 5 : 41);
      found[kind].push_back(costs);
      line("%s,%zu,%.0f,%.0f\n", kinds[kind].first, objects, costs.ours_ns, costs.liblo_ns);
    }
  }
  if (csv) std::fclose(csv);
  const auto& exact = found[0];
  const std::vector<bench::Promise> promises = {
      bench::at_most("exact address, 1,000 objects against 1: ours takes", exact[3].ours_ns / exact[0].ours_ns, 1.5,
                     " times as long"),
      bench::at_least("exact address, 1,000 objects: liblo takes as long as ours, times",
                      exact[3].liblo_ns / exact[3].ours_ns, 1),
      bench::at_least("pattern, 1,000 objects: liblo takes as long as ours, times",
                      found[1][3].liblo_ns / found[1][3].ours_ns, 1)};
  return bench::report(promises) || !gate ? 0 : 1;
}
