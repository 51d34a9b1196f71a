#include "server/store/pilot_table.h"

namespace ballpiston::server {
namespace {

// The epsilon of a pilot in equilibrium. It is not NULL, so that it can be part of a key.
constexpr double kNoEpsilon = -1;

Query& BindPlace(Query& query, const std::string& engine_version, const PilotPlace& place) {
  return query.BindText(engine_version)
      .Bind(place.rho)
      .Bind(place.delta)
      .Bind(place.epsilon.value_or(kNoEpsilon));
}

}  // namespace

absl::Status InsertPilot(Database& database, const std::string& engine_version,
                         const PilotPlace& place, const Pilot& pilot) {
  Query query = database.Prepare(
      "INSERT INTO pilots (engine_version, rho, delta, epsilon, difference, standard_error)"
      " VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING");
  return BindPlace(query, engine_version, place)
      .Bind(pilot.difference)
      .Bind(pilot.standard_error)
      .Run();
}

absl::StatusOr<std::optional<Pilot>> FindPilot(Database& database,
                                               const std::string& engine_version,
                                               const PilotPlace& place) {
  Query query = database.Prepare(
      "SELECT difference, standard_error FROM pilots WHERE engine_version = ? AND rho = ?"
      " AND delta = ? AND epsilon = ?");
  const absl::StatusOr<bool> row = BindPlace(query, engine_version, place).Step();
  if (!row.ok()) return row.status();
  if (!*row) return std::nullopt;
  return Pilot{.difference = query.Real(0), .standard_error = query.Real(1)};
}

}  // namespace ballpiston::server
