// A stop token that is already stopped.
#ifndef BALLPISTON_TESTS_CORE_STOPPED_H_
#define BALLPISTON_TESTS_CORE_STOPPED_H_

#include <stop_token>

namespace ballpiston {

inline std::stop_token Stopped() {
  std::stop_source source;
  source.request_stop();
  return source.get_token();
}

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_CORE_STOPPED_H_
