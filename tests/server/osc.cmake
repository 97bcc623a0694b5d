# OSC without a daemon: packets, the socket, scores, and the senders in clients/.
pkg_check_modules(LIBLO REQUIRED IMPORTED_TARGET GLOBAL liblo)
ringdown_test(osc_test
              SOURCES osc_clients_test.cpp osc_codec_test.cpp osc_packet_test.cpp osc_score_test.cpp osc_socket_test.cpp
              LINK ringdown_osc PkgConfig::LIBLO)
add_dependencies(osc_test ringdown game_engine_strike)
