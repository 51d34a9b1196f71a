// The lifetime of an orbit whose hit times assume |v| = 1 while its reflections do not.
#pragma once

#include <string>

namespace ballpiston::stability {

// The numbers of wall hits before the escape, for 40 orbits at the paper's radius, as a sentence.
std::string UnitSpeedSentence();

}  // namespace ballpiston::stability
