#include "server/zeroconf.h"

#include "server/log.h"

#include <avahi-client/client.h>
#include <avahi-client/publish.h>
#include <avahi-common/alternative.h>
#include <avahi-common/error.h>
#include <avahi-common/malloc.h>
#include <avahi-common/thread-watch.h>
#include <utility>

namespace ringdown::server {

// Everything except construction and destruction happens on Avahi's thread.
struct Zeroconf::Avahi {
  Avahi(std::string shown, std::uint16_t udp, std::optional<std::uint16_t> tcp)
      : name(std::move(shown)), udp_port(udp), tcp_port(tcp) {
    poll = avahi_threaded_poll_new();
    if (!poll) return;
    int error = 0;
    // avahi_client_new() calls the callback before it returns, that is before `client` would be set.
    client = avahi_client_new(
        avahi_threaded_poll_get(poll), AVAHI_CLIENT_NO_FAIL,
        [](AvahiClient* from, AvahiClientState state, void* us) { static_cast<Avahi*>(us)->changed(from, state); },
        this, &error);
    if (client) {
      avahi_threaded_poll_start(poll);
    } else {
      complain(error);
    }
  }

  ~Avahi() {
    if (poll) avahi_threaded_poll_stop(poll);
    if (client) avahi_client_free(client);  // and the group with it
    if (poll) avahi_threaded_poll_free(poll);
  }
  Avahi(const Avahi&) = delete;
  Avahi& operator=(const Avahi&) = delete;

  void complain(int error) {
    if (!std::exchange(complained, true)) {
      log_warning(formatted("not announced by Zeroconf: {}; is avahi-daemon running?", avahi_strerror(error)));
    }
  }

  void changed(AvahiClient* from, AvahiClientState state) {
    if (state == AVAHI_CLIENT_S_RUNNING) {
      publish(from);
    } else if (state == AVAHI_CLIENT_CONNECTING) {
      complain(AVAHI_ERR_NO_DAEMON);
    } else if (state == AVAHI_CLIENT_FAILURE) {
      complain(avahi_client_errno(from));
      group = nullptr;
    } else if (group) {
      avahi_entry_group_reset(group);
    }
  }

  void publish(AvahiClient* from) {
    if (!group) {
      group = avahi_entry_group_new(
          from,
          [](AvahiEntryGroup* of, AvahiEntryGroupState state, void* us) {
            if (state == AVAHI_ENTRY_GROUP_COLLISION) static_cast<Avahi*>(us)->take_another_name(of);
          },
          this);
    }
    if (!group) return complain(avahi_client_errno(from));
    if (!avahi_entry_group_is_empty(group)) return;
    int error = add("_osc._udp", udp_port);
    if (error >= 0 && tcp_port) error = add("_osc._tcp", *tcp_port);
    if (error == AVAHI_ERR_COLLISION) return take_another_name(group);
    if (error >= 0) error = avahi_entry_group_commit(group);
    if (error < 0) return complain(error);
    log_info("announced by Zeroconf as \"" + name + "\"");
  }

  int add(const char* type, std::uint16_t port) {
    return avahi_entry_group_add_service(group, AVAHI_IF_UNSPEC, AVAHI_PROTO_INET, {}, name.c_str(), type, nullptr,
                                         nullptr, port, nullptr);
  }

  void take_another_name(AvahiEntryGroup* of) {
    char* const other = avahi_alternative_service_name(name.c_str());
    name = other;
    avahi_free(other);
    avahi_entry_group_reset(of);
    publish(avahi_entry_group_get_client(of));
  }

  std::string name;
  std::uint16_t udp_port;
  std::optional<std::uint16_t> tcp_port;
  AvahiThreadedPoll* poll = nullptr;
  AvahiClient* client = nullptr;
  AvahiEntryGroup* group = nullptr;
  bool complained = false;
};

Zeroconf::Zeroconf(std::string name, std::uint16_t udp_port, std::optional<std::uint16_t> tcp_port)
    : avahi_(std::make_unique<Avahi>(std::move(name), udp_port, tcp_port)) {}

Zeroconf::~Zeroconf() = default;

}  // namespace ringdown::server
