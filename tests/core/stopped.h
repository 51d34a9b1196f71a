// A stop token that is already stopped.
#pragma once

#include <stop_token>

namespace ballpiston {

inline std::stop_token Stopped() {
  std::stop_source source;
  source.request_stop();
  return source.get_token();
}

}  // namespace ballpiston
