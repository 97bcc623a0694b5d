// What patchbays show of a port beside its name: JACK metadata. A server that keeps none is no error.
#pragma once

#include <string>

struct _jack_client;
struct _jack_port;

namespace ringdown::server {

struct PortDescription {
  std::string pretty_name;
  std::string group;  // ports of one group stand together
  int order = 0;      // among our ports, from 0
};

void jack_metadata_describe(_jack_client* client, _jack_port* port, const PortDescription& description);

// Before a port is unregistered, or the client closed: servers keep metadata of what is gone.
void jack_metadata_forget(_jack_client* client, _jack_port* port);

}  // namespace ringdown::server
