// Answers to what asks how things are and changes nothing: /object/.../describe and bank, /scene/describe, /browse.
// [worker]
#pragma once

#include "engine/base/result.h"
#include "protocol/reply.h"
#include "protocol/request.h"
#include "server/session/recorder.h"
#include "server/session/session.h"

#include <vector>

namespace ringdown::server {

[[nodiscard]] bool is_question(const protocol::Request& request);

// The messages of the answer, in their order. `recorder` knows gains and pans. An error names the argument.
Result<std::vector<protocol::Reply>> answer_to(const protocol::Request& question, const session::Session& session,
                                               const session::Recorder& recorder);

}  // namespace ringdown::server
