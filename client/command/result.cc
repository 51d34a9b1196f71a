// ballpiston result: prints a job's finished points.
#include "client/command/connection.h"
#include "client/command/print_result.h"

namespace ballpiston::client {

VerbResult Result(const Options& options, Terminal& terminal) {
  return WithServer(options, terminal, [&](const Connection& connection) {
    return PrintResult(connection, options.jobs.front(), options.format, terminal);
  });
}

}  // namespace ballpiston::client
