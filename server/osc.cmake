# OSC by UDP and OSC scores: what the daemon, the `ringdown` program and tests need of it. liblo stays in osc_codec.cpp.
pkg_check_modules(LIBLO REQUIRED IMPORTED_TARGET GLOBAL liblo)
ringdown_library(ringdown_osc SOURCES event_sender.cpp osc_codec.cpp osc_packet.cpp osc_score.cpp osc_slip.cpp osc_socket.cpp
                 LINK ringdown_protocol PRIVATE_LINK PkgConfig::LIBLO)
