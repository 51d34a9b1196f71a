// A call of any method, unary or streaming, by its name.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "grpcpp/channel.h"
#include "grpcpp/support/status.h"

namespace ballpiston::server {

inline constexpr char kListJobs[] = "/ballpiston.v1.EnsembleService/ListEnsembleJobs";
inline constexpr char kGetJob[] = "/ballpiston.v1.EnsembleService/GetEnsembleJob";
inline constexpr char kWatchJob[] = "/ballpiston.v1.EnsembleService/WatchEnsembleJob";
inline constexpr char kCheckHealth[] = "/grpc.health.v1.Health/Check";
inline constexpr char kWatchHealth[] = "/grpc.health.v1.Health/Watch";
inline constexpr char kReflection[] =
    "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";

// A request of a health watch, encoded by hand: an empty field 1 asks for the whole server.
inline const std::string kWholeServer("\x0a\0", 2);

// A request of reflection, encoded by hand: field 7 asks for the list of services.
inline constexpr char kListServices[] = "\x3a\x01*";

// Sends one request with the serialized message `bytes` and with these headers `authorization`, and
// reads to the end. Ends after 15 minutes with DEADLINE_EXCEEDED.
grpc::Status CallByName(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                        const std::string& bytes = "",
                        const std::vector<std::string>& authorization = {});

// One header, or none for an empty token.
std::vector<std::string> Bearer(const std::string& token);

}  // namespace ballpiston::server
