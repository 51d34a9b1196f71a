// Random values of the parameters: in the permitted domain, and slightly or far outside of it.
//
// `extreme` values lie log-uniformly close to an end of the domain, or are the end itself or its
// neighbour among the doubles. The others are those of an ordinary question.
#pragma once

#include <string>

#include "tests/questions/dice.h"

namespace ballpiston::questions {

double Rho(Dice& dice, bool extreme);
double Delta(Dice& dice, double bound, bool extreme);
double Epsilon(Dice& dice, bool extreme);
double Exponent(Dice& dice, bool extreme);
std::string Cells(Dice& dice, bool extreme);
double Temperature(Dice& dice, bool extreme);
double Cold(Dice& dice, double hot, bool extreme);

double RhoOutside(Dice& dice);
double DeltaOutside(Dice& dice, double bound);
double EpsilonOutside(Dice& dice);
double ExponentOutside(Dice& dice);
std::string CellsOutside(Dice& dice);
double TemperatureOutside(Dice& dice);

}  // namespace ballpiston::questions
