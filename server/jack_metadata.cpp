#include "server/jack_metadata.h"

#include <jack/jack.h>
#include <jack/metadata.h>
#include <jack/uuid.h>

namespace ringdown::server {

void jack_metadata_describe(jack_client_t* client, jack_port_t* port, const PortDescription& description) {
  constexpr const char* kText = "text/plain";
  constexpr const char* kInteger = "http://www.w3.org/2001/XMLSchema#integer";
  const jack_uuid_t id = jack_port_uuid(port);
  if (jack_uuid_empty(id)) return;
  jack_set_property(client, id, JACK_METADATA_PRETTY_NAME, description.pretty_name.c_str(), kText);
  jack_set_property(client, id, JACK_METADATA_PORT_GROUP, description.group.c_str(), kText);
  jack_set_property(client, id, JACK_METADATA_ORDER, std::to_string(description.order).c_str(), kInteger);
}

void jack_metadata_forget(jack_client_t* client, jack_port_t* port) {
  const jack_uuid_t id = jack_port_uuid(port);
  if (!jack_uuid_empty(id)) jack_remove_properties(client, id);
}

}  // namespace ringdown::server
