#include "tests/questions/values.h"

#include "core/ensemble/parameter.h"
#include "core/gas/gas_shape.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/temperature.h"

namespace ballpiston::questions {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = std::numeric_limits<double>::denorm_min();

double Above(double x) { return std::nextafter(x, kInfinity); }
double Below(double x) { return std::nextafter(x, -kInfinity); }

// In [lower, upper], often near an end.
double NearAnEnd(Dice& dice, double lower, double upper) {
  const double width = upper - lower, distance = width * std::pow(10, -dice.Between(0, 17));
  switch (dice.Below(8)) {
    case 0:
      return lower;
    case 1:
      return upper;
    case 2:
      return std::min(Above(lower), upper);
    case 3:
      return std::max(Below(upper), lower);
    case 4:
    case 5:
      return lower + distance;
    default:
      return std::max(upper - distance, lower);
  }
}

}  // namespace

double Rho(Dice& dice, bool extreme) {
  if (extreme) return NearAnEnd(dice, Above(kMinRho), Below(kMaxRho));
  return dice.Between(0.505, 0.695);
}

double Delta(Dice& dice, double bound, bool extreme) {
  if (!extreme) return bound * dice.LogBetween(0.05, 1);
  switch (dice.Below(8)) {
    case 0:
      return std::max(bound * std::pow(10, -dice.Between(0, 324)), kTiny);
    case 1:
      return std::min(bound * (1 + kDeltaSlack / 2), Below(0.5));
    case 2:
      return bound;
    case 3:
      return Below(bound);
    case 4:
      return bound * (1 - std::pow(10, -dice.Between(0.5, 16)));
    default:
      return bound * std::pow(10, -dice.Between(0, 17));
  }
}

double Epsilon(Dice& dice, bool extreme) {
  if (!extreme) return dice.Between(0.02, 0.48);
  if (dice.Chance(0.2)) return dice.Pick<double>({0.25, Above(0.25), Below(0.25), 1.0 / 6});
  return NearAnEnd(dice, 0, 0.5);
}

double Exponent(Dice& dice, bool extreme) {
  return extreme ? NearAnEnd(dice, 0, kMaxExponent) : dice.Pick<double>({0, 1, 1, 2, 3.5});
}

std::string Cells(Dice& dice, bool extreme) {
  const auto whole = [&](double upper) {
    return static_cast<int64_t>(dice.LogBetween(1, upper + 0.999));
  };
  if (!extreme && dice.Chance(0.5)) return absl::StrCat(whole(8));
  if (!extreme) return absl::StrCat(whole(4), "x", whole(4));
  if (dice.Chance(0.3)) return dice.Pick<std::string>({"1", "1x1", "1000000", "1000x1000", "2"});
  const int64_t columns = whole(kMaxCells);
  if (dice.Chance(0.4)) return absl::StrCat(columns);
  const int64_t rows = whole(static_cast<double>(kMaxCells / columns));
  return dice.Chance(0.5) ? absl::StrCat(columns, "x", rows) : absl::StrCat(rows, "x", columns);
}

double Temperature(Dice& dice, bool extreme) {
  if (!extreme) return dice.Chance(0.3) ? 1 : dice.LogBetween(0.1, 10);
  if (dice.Chance(0.4)) {
    return dice.Pick<double>(
        {kMinTemperature, kMaxTemperature, Above(kMinTemperature), Below(kMaxTemperature)});
  }
  return dice.LogBetween(2 * kMinTemperature, kMaxTemperature / 2);
}

double Cold(Dice& dice, double hot, bool extreme) {
  if (dice.Chance(0.1)) return hot;
  if (!extreme) return std::max(hot * dice.Between(0.2, 1), kMinTemperature);
  if (dice.Chance(0.1)) return std::max(Below(hot), kMinTemperature);
  const double most = dice.Chance(0.5) ? 12 : 240;  // powers of ten between hot and cold
  return std::max(hot * std::pow(10, -dice.Between(0, most)), kMinTemperature);
}

double RhoOutside(Dice& dice) {
  return dice.Pick<double>({kMinRho, Below(kMinRho), kMaxRho, Above(kMaxRho), 0, -0.53, 1, 1e300,
                            kNotANumber, kInfinity});
}

double DeltaOutside(Dice& dice, double bound) {
  return dice.Pick<double>({0, -kTiny, -0.1, bound * (1 + 3 * kDeltaSlack), bound * (1 + 1e-9),
                            2 * bound, 0.5, kNotANumber, kInfinity});
}

double EpsilonOutside(Dice& dice) {
  return dice.Pick<double>({-kTiny, -0.1, Above(0.5), 1, 1e300, kNotANumber, -kInfinity});
}

double ExponentOutside(Dice& dice) {
  return dice.Pick<double>({-kTiny, -1, Above(kMaxExponent), 1e300, kNotANumber, kInfinity});
}

std::string CellsOutside(Dice& dice) {
  return dice.Pick<std::string>({"0", "0x4", "4x0", "1000001", "1001x1000", "-1", "2.5", "x", "",
                                 "99999999999999999999", "3x3x3", "4294967296x4294967296"});
}

double TemperatureOutside(Dice& dice) {
  return dice.Pick<double>(
      {Below(kMinTemperature), Above(kMaxTemperature), 0, -1, kTiny, kNotANumber, kInfinity});
}

}  // namespace ballpiston::questions
