// A measurement of the program `method_comparison`: what a method of computing the pair gives for
// how much work. tools/method_comparison/method_comparison.h says what the numbers mean.
#ifndef BALLPISTON_CLIENT_FIGURE_METHOD_MEASUREMENT_H_
#define BALLPISTON_CLIENT_FIGURE_METHOD_MEASUREMENT_H_

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"

namespace ballpiston::client {

inline constexpr char kMeanFreeTime[] = "mean-free-time";
inline constexpr char kIngoingLaw[] = "ingoing-law";
inline constexpr char kTrajectory[] = "trajectory";
inline constexpr char kRelaxationTime[] = "relaxation-time";

inline constexpr char kBilliard[] = "billiard";
inline constexpr char kMarkov[] = "markov";
inline constexpr char kSpectrum[] = "spectrum";
inline constexpr char kClosedForm[] = "closed-form";

struct MethodMeasurement {
  std::string method;
  double time_step = 0;  // cells per unit speed; 0 for all methods but fixed-step
  std::string quantity;
  double delta = 0;
  uint64_t samples = 0;
  uint64_t wall_hits = 0;
  double work = 0;  // seconds
  double value = 0;
  double statistical_error = 0;
};

// From a line that the program printed, a JSON object. INTERNAL if it is not one, or lacks a field.
absl::StatusOr<MethodMeasurement> ParseMeasurement(const std::string& line);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_FIGURE_METHOD_MEASUREMENT_H_
