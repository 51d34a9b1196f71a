// The text of a number in messages: the shortest decimal text that parses to the same double.
#ifndef BALLPISTON_CORE_ARITHMETIC_NUMBER_TEXT_H_
#define BALLPISTON_CORE_ARITHMETIC_NUMBER_TEXT_H_

#include <string>

namespace ballpiston {

std::string NumberText(double value);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_ARITHMETIC_NUMBER_TEXT_H_
