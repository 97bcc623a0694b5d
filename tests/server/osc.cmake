# OSC without a daemon: packets, the socket, scores, and the senders in clients/.
pkg_check_modules(LIBLO REQUIRED IMPORTED_TARGET GLOBAL liblo)
ringdown_test(osc_test
              SOURCES command_line_test.cpp osc_clients_test.cpp osc_codec_test.cpp osc_framing_test.cpp osc_packet_test.cpp osc_score_test.cpp osc_slip_test.cpp
                      osc_socket_test.cpp
              LINK ringdown_osc ringdown_protocol PkgConfig::LIBLO)
add_dependencies(osc_test ringdown)
# The daemon's parts inside the test's own process.
ringdown_test(osc_server_test ALIKE SOURCES capacity_test.cpp describe_test.cpp frame_clock_test.cpp limits_test.cpp log_test.cpp osc_namespace_test.cpp osc_server_test.cpp osc_stream_test.cpp realtime_share_test.cpp state_test.cpp watch_test.cpp LINK ringdown_daemon ringdown_test_support PkgConfig::LIBLO)
