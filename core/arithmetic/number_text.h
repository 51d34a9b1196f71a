// A number as a message shows it: the shortest decimal text that reads back as the same double.
#ifndef BALLPISTON_CORE_ARITHMETIC_NUMBER_TEXT_H_
#define BALLPISTON_CORE_ARITHMETIC_NUMBER_TEXT_H_

#include <string>

namespace ballpiston {

std::string NumberText(double value);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_ARITHMETIC_NUMBER_TEXT_H_
