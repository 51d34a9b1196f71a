#include "server/store/pilot_table.h"

namespace ballpiston::server {
namespace {

// The epsilon of a pilot in equilibrium. It is not NULL, so that it can be part of a key.
constexpr double kNoEpsilon = -1;

}  // namespace

void InsertPilot(Database& database, const std::string& engine_version, const PilotPlace& place,
                 const Pilot& pilot) {
  database.Run(
      "INSERT INTO pilots (engine_version, rho, delta, epsilon, difference, standard_error)"
      " VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING",
      engine_version, place.rho, place.delta, place.epsilon.value_or(kNoEpsilon), pilot.difference,
      pilot.standard_error);
}

std::optional<Pilot> FindPilot(Database& database, const std::string& engine_version,
                               const PilotPlace& place) {
  Query query = database.Select(
      "SELECT difference, standard_error FROM pilots WHERE engine_version = ? AND rho = ?"
      " AND delta = ? AND epsilon = ?",
      engine_version, place.rho, place.delta, place.epsilon.value_or(kNoEpsilon));
  if (!query.Next()) return std::nullopt;
  Pilot pilot;
  query.ReadInto(pilot.difference, pilot.standard_error);
  return pilot;
}

}  // namespace ballpiston::server
