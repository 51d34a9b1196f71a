// A call of the gateway: a line with the path, then the body.
#include <string>
#include <vector>

#include "client/web/connect_protocol.h"
#include "client/web/json_call.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

void CheckGatewayRequest(const std::string& bytes) {
  const size_t end = bytes.find('\n');
  const std::string path = bytes.substr(0, end);
  const std::string body = end == std::string::npos ? "" : bytes.substr(end + 1);
  const auto opened = client::OpenEnvelope(body);
  Require(!opened.ok() || client::Envelope(*opened) == body,
          "an opened envelope can be made again");
  const auto* const method = client::FindMethod(path);
  if (method == nullptr) return;
  Require(path.starts_with("ballpiston.v1."), "only this API's methods are found");
  const client::JsonCall once = client::WithRequestId({method, body});
  Require(client::WithRequestId(once).request == once.request, "a request id stays");
}

std::vector<std::string> Watch() {
  return {"ballpiston.v1.EnsembleService/WatchEnsembleJob\n" +
          client::Envelope(R"({"name": "ensembleJobs/1"})")};
}

const Registration kGatewayRequest({.name = "gateway_request",
                                    .check = CheckGatewayRequest,
                                    .made_seeds = Watch});

}  // namespace
}  // namespace ballpiston::fuzz
