// The text of a number in messages: the shortest decimal text that parses to the same double.
#pragma once

#include <string>

namespace ballpiston {

std::string NumberText(double value);

}  // namespace ballpiston
